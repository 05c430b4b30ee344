"""Which program has a UDP or TCP port of this machine."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from link.transport.processes import PROC, describe_process, open_files, other_processes

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
