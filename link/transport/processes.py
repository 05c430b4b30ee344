"""The processes of this machine: names, what each has open, and which has a UDP or TCP port.

Linux shows them in /proc. Elsewhere lsof is asked, which macOS comes with.
"""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import msgspec

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


SocketKind = Literal["udp", "tcp"]
LISTEN = "0A"
"""State of a TCP socket that listens (include/net/tcp_states.h)."""
LOCAL, STATE, INODE = 1, 3, 9
"""Columns of /proc/net/udp and /proc/net/tcp (https://docs.kernel.org/networking/proc_net_tcp.html)."""
HIDDEN = "a program of another user"
"""The kernel shows that a port is taken, and not by whom: only root sees the files of others."""


def find_socket_holders(kind: SocketKind, port: int, proc: Path = PROC) -> list[str]:
    """Return the programs that have this port of any local address, e.g. ["vehicle (pid 412)"]; empty if it is free."""
    if not proc.is_dir():
        return _ask_for_holders(kind, port)
    wanted = {f"socket:[{inode}]" for inode in _inodes(kind, port, proc)}
    if not wanted:
        return []
    found = (each for each in other_processes(proc) if any(one in wanted for one in open_files(each, "socket:")))
    return [describe_process(each) for each in found] or [HIDDEN]


def _inodes(kind: SocketKind, port: int, proc: Path) -> Iterator[str]:
    """Yield the sockets bound to this port; of TCP those that listen."""
    for name in (kind, f"{kind}6"):
        with contextlib.suppress(OSError):
            for line in (proc / "net" / name).read_text().splitlines()[1:]:
                words = line.split()
                bound = int(words[LOCAL].rpartition(":")[2], 16)
                if bound == port and (kind == "udp" or words[STATE] == LISTEN):
                    yield words[INODE]


# ---- without /proc ----

LSOF = ("lsof", "-nP", "-w", "-F", "pcn")
"""Lists open files: a line `p` with the process id, `c` with the program, then `n` with the name of each file."""
LSOF_WITHIN = 5.0
"""s; it takes some 0.1 s."""


class OpenFile(msgspec.Struct, frozen=True):
    """A file or socket that a process has open."""

    holder: str
    """e.g. "screen (pid 412)"."""
    name: str
    """A path, or the addresses of a socket, e.g. "*:14550" or "127.0.0.1:14550->127.0.0.1:50123"."""


def ask_lsof(*selection: str) -> list[OpenFile]:
    """Return the files of other processes that fit words of lsof; those of other users hide theirs."""
    try:
        listed = subprocess.run([*LSOF, *selection], stdin=subprocess.DEVNULL, capture_output=True, timeout=LSOF_WITHIN)
    except (OSError, subprocess.SubprocessError):
        return []
    found: list[OpenFile] = []
    pid, program = "", ""
    for line in listed.stdout.decode("utf-8", "replace").splitlines():
        field, value = line[:1], line[1:]
        if field == "p":
            pid = value
        elif field == "c":
            program = "".join(filter(str.isprintable, value))
        elif field == "n" and pid != str(os.getpid()):
            found.append(OpenFile(f"{program} (pid {pid})", value))
    return found


def _ask_for_holders(kind: SocketKind, port: int) -> list[str]:
    """Return the programs that have a port, by lsof; HIDDEN if it is taken and lsof names none."""
    state = ("-sTCP:LISTEN",) if kind == "tcp" else ()
    files = ask_lsof(f"-i{kind.upper()}:{port}", *state)
    found = [each.holder for each in files if each.name.partition("->")[0].endswith(f":{port}")]
    return list(dict.fromkeys(found)) or ([HIDDEN] if _is_taken(kind, port) else [])


def _is_taken(kind: SocketKind, port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM if kind == "udp" else socket.SOCK_STREAM) as probe:
        if kind == "tcp":
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a connection that has ended is none
        try:
            probe.bind(("", port))
        except OSError as error:
            return error.errno == errno.EADDRINUSE
    return False
