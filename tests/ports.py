"""Ports of loopback for tests: free now, and nobody else's before the program that they are meant for has opened them.

A port that the kernel chose (bind to 0) and that is closed again may go to any other socket of the machine, and several
workers run tests. These lie below what the kernel gives away (ip_local_port_range), in a block of each process's own.
"""

from __future__ import annotations

import atexit
import itertools
import socket
from collections.abc import Iterator

FIRST, END, BLOCK = 16000, 32000, 200
"""Ports that are given out, and how many of them a process has."""


def free_port() -> int:
    """A port that no UDP and no TCP socket of this machine has; not given out again for as long as possible."""
    return next(port for port in itertools.islice(_ours, BLOCK) if _is_free(port))


def _block() -> Iterator[int]:
    """The ports of this process, round and round. The block is held by a name that the kernel forgets with us."""
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


def _is_free(port: int) -> bool:
    for kind in (socket.SOCK_DGRAM, socket.SOCK_STREAM):
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                return False
    return True


_ours = _block()
