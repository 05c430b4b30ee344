"""Ports of loopback for tests: free now, and not taken before the program under test opens them.

A port that the kernel chose (bind to 0) and that is closed again may go to any other socket of the machine, and several
workers run tests. These ports are below the kernel's range (ip_local_port_range), in a block for each process.
"""

from __future__ import annotations

import atexit
import itertools
import socket
from collections.abc import Iterator

FIRST, END, BLOCK = 16000, 32000, 200
"""The range of ports, and how many a process has."""


def free_port() -> int:
    """Return a port that no UDP and no TCP socket of this machine has; not returned again for as long as possible."""
    return next(port for port in itertools.islice(_ours, BLOCK) if is_free(port))


def _block() -> Iterator[int]:
    """Yield the ports of this process in turn. The kernel releases the name of the block when the process ends."""
    for first in range(FIRST, END, BLOCK):
        holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            holder.bind(f"\0mavhelm test ports {first}")
        except OSError:
            holder.close()
            continue
        atexit.register(holder.close)
        yield from itertools.cycle(range(first, first + BLOCK))
    raise AssertionError("too many processes run tests")


def is_free(port: int) -> bool:
    for kind in (socket.SOCK_DGRAM, socket.SOCK_STREAM):
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                return False
    return True


_ours = _block()
