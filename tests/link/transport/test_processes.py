"""Which program has a network port, by what the kernel says of real sockets."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from link.transport.processes import HIDDEN, find_socket_holders
from link.transport.serial_ports import find_holders
from tests.ports import free_port


def test_a_free_port_has_no_holder_and_a_taken_one_has() -> None:
    port = free_port()
    assert (find_socket_holders("udp", port), find_socket_holders("tcp", port)) == ([], [])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.create_server(("127.0.0.1", port)):
        udp.bind(("127.0.0.1", port))
        # Only other processes are named: a port of this one looks like that of a program that hides its files.
        assert (find_socket_holders("udp", port), find_socket_holders("tcp", port)) == ([HIDDEN], [HIDDEN])
    assert find_socket_holders("udp", port) == []


NO_PROC = Path("/nowhere")
LSOF = pytest.mark.skipif(
    shutil.which("lsof") is None and "MAVHELM_CI" not in os.environ, reason="lsof is not installed"
)
HOLDS = """
import os, socket, sys
port = int(sys.argv[1])
udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
udp.bind(("127.0.0.1", port))
tcp = socket.create_server(("127.0.0.1", port))
file = open(sys.argv[2])
print(flush=True)
input()
"""


@LSOF
@pytest.mark.e2e
def test_without_procfs_lsof_names_the_holders(tmp_path: Path) -> None:
    port, file = free_port(), tmp_path / "cu.usbserial"
    file.touch()
    words = [sys.executable, "-c", HOLDS, str(port), str(file)]
    assert find_holders([str(file)], NO_PROC) == {}
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        holder.stdout.readline()
        for kind in ("udp", "tcp"):
            (found,) = find_socket_holders(kind, port, NO_PROC)
            assert found.endswith(f" (pid {holder.pid})")
        assert find_holders([str(file)], NO_PROC) == {str(file): found}
        holder.kill()
    assert find_socket_holders("udp", port, NO_PROC) == find_socket_holders("tcp", port, NO_PROC) == []


def test_without_procfs_and_lsof_a_taken_port_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    port = free_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("127.0.0.1", port))
        assert find_socket_holders("udp", port, NO_PROC) == [HIDDEN]
        assert find_socket_holders("tcp", port, NO_PROC) == []
