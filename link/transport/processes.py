"""The processes of this machine, as /proc shows them: names, what each has open, and which has a UDP or TCP port."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

PROC = Path("/proc")


def other_processes(proc: Path = PROC) -> Iterator[Path]:
    """Yield the folder of each process but ours."""
    with contextlib.suppress(OSError):
        for entry in sorted(os.listdir(proc)):
            if entry.isdigit() and int(entry) != os.getpid():
                yield proc / entry


def open_files(process: Path, prefix: str) -> Iterator[str]:
    """Yield what a process has open, e.g. "/dev/ttyS0" or "socket:[4711]", as far as it starts with `prefix`.

    Processes of other users hide it.
    """
    with contextlib.suppress(OSError):
        for descriptor in os.listdir(process / "fd"):
            with contextlib.suppress(OSError):
                target = os.readlink(process / "fd" / descriptor)
                if target.startswith(prefix):
                    yield target


def program_name(process: Path) -> str:
    """Return the name of the program; "?" if the process has ended."""
    with contextlib.suppress(OSError):
        return "".join(filter(str.isprintable, (process / "comm").read_text("utf-8", "replace").strip()))
    return "?"


def describe_process(process: Path) -> str:
    """Return the program with its process id, e.g. "screen (pid 412)"."""
    return f"{program_name(process)} (pid {process.name})"


Kind = Literal["udp", "tcp"]
LISTEN = "0A"
"""State of a TCP socket that listens (include/net/tcp_states.h)."""
LOCAL, STATE, INODE = 1, 3, 9
"""Columns of /proc/net/udp and /proc/net/tcp (https://docs.kernel.org/networking/proc_net_tcp.html)."""
HIDDEN = "a program of another user"
"""The kernel shows that a port is taken, and not by whom: only root sees the files of others."""


def find_socket_holders(kind: Kind, port: int, proc: Path = PROC) -> list[str]:
    """Return the programs that have this port of any local address, e.g. ["vehicle (pid 412)"]; empty if it is free."""
    wanted = {f"socket:[{inode}]" for inode in _inodes(kind, port, proc)}
    if not wanted:
        return []
    found = (each for each in other_processes(proc) if any(one in wanted for one in open_files(each, "socket:")))
    return [describe_process(each) for each in found] or [HIDDEN]


def _inodes(kind: Kind, port: int, proc: Path) -> Iterator[str]:
    """Yield the sockets bound to this port; of TCP those that listen."""
    for name in (kind, f"{kind}6"):
        with contextlib.suppress(OSError):
            for line in (proc / "net" / name).read_text().splitlines()[1:]:
                words = line.split()
                bound = int(words[LOCAL].rpartition(":")[2], 16)
                if bound == port and (kind == "udp" or words[STATE] == LISTEN):
                    yield words[INODE]
