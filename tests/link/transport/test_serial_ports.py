"""Which program has a serial port open, by what the kernel says of real processes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from link.transport.serial_ports import find_holders, find_serial_ports


def test_the_program_that_has_a_port_open_is_named() -> None:
    device, port = os.openpty()
    path = os.ttyname(port)
    assert find_holders([path]) == {}  # we hold it ourselves
    reader = subprocess.Popen(
        [sys.executable, "-c", "import sys; sys.stdout.write('!'); sys.stdout.flush(); sys.stdin.read()"],
        stdin=port,
        stdout=subprocess.PIPE,
    )
    assert reader.stdout is not None
    assert reader.stdout.read(1) == b"!"
    name = Path(f"/proc/{reader.pid}/comm").read_text().strip()
    found = find_holders([path, "/dev/null-port"])
    reader.kill()
    reader.wait()
    reader.stdout.close()
    assert found == {path: f"{name} (pid {reader.pid})"}
    assert find_holders([path]) == {}
    os.close(device)
    os.close(port)


def test_a_login_on_a_port_is_named_though_it_hides_its_files(tmp_path: Path) -> None:
    login = tmp_path / "412"
    login.mkdir()
    (login / "comm").write_text("agetty\n")
    (login / "cmdline").write_bytes(b"/sbin/agetty\x00-o\x00115200\x00ttyAMA0\x00vt220\x00")
    assert find_holders(["/dev/ttyAMA0", "/dev/ttyAMA1"], tmp_path) == {"/dev/ttyAMA0": "agetty (pid 412)"}


def test_the_ports_of_this_machine_can_be_listed() -> None:
    for port in find_serial_ports():
        assert port.path.startswith("/dev/")
