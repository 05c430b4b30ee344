"""UDP sockets as the transport opens them; delivery over them is tested in tests/link/test_runner.py."""

from __future__ import annotations

import contextlib
import socket
import subprocess
import sys
from pathlib import Path

from link.endpoint import parse_endpoint
from link.transport.udp import RECEIVE_BUFFER, open_udp
from tests.ports import free_port


def test_a_udp_socket_asks_for_a_larger_buffer_than_the_default() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as usual:
        default = usual.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    most = 2 * int(Path("/proc/sys/net/core/rmem_max").read_text())
    with contextlib.closing(open_udp(parse_endpoint(f"udpin:127.0.0.1:{free_port()}"))) as transport:
        granted = transport._socket.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    assert granted == min(2 * RECEIVE_BUFFER, most) >= default


def test_datagrams_that_are_kept_lie_close_together() -> None:
    """Tables of the router and charts keep some: far apart, they keep megabytes of the heap from being used again.

    In a process of its own, whose heap has no holes yet.
    """
    counted = subprocess.run(
        [sys.executable, "-m", "tests.link.transport.kept_datagrams"], capture_output=True, text=True, check=True
    )
    kept, pages = map(int, counted.stdout.split())
    assert kept > 1500
    assert pages < 350, "their bytes need 80"
