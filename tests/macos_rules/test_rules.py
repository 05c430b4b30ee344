"""Programs under the rules of macOS: that these are forced, and what each of them would break."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from link.transport.local_addresses import LocalAddresses
from tests.macos_rules.forced import FOLDER
from tests.waits import wait_until


def under_rules(code: str, folder: Path) -> str:
    """Run code under the rules of macOS; return what it prints."""
    environment = {**os.environ, "PYTHONPATH": str(FOLDER), "XDG_RUNTIME_DIR": str(folder)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


REFUSED = """
import os, socket
def tell(work):
    try:
        print("done", work())
    except (OSError, AttributeError, ValueError) as error:
        print(type(error).__name__)
tell(lambda: open("/proc/self/status"))
tell(lambda: os.listdir("/sys"))
tell(lambda: os.stat("/proc/self"))
tell(lambda: socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET))
tell(lambda: socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET))
tell(lambda: socket.SO_PEERCRED)
tell(lambda: socket.socket(socket.AF_UNIX).bind("/tmp/" + 99 * "x"))
tell(lambda: socket.socket(socket.AF_UNIX).bind("\\0abstract"))
"""


def test_what_macos_does_not_have_is_refused(tmp_path: Path) -> None:
    errors = [*["FileNotFoundError"] * 3, *["OSError"] * 2, "AttributeError", "OSError", "FileNotFoundError"]
    assert under_rules(REFUSED, tmp_path).split() == errors


FULL = """
import os
from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import make_folder, socket_path
from groundstation.station_socket.hello import SCREEN, Hello
from link.runtime.local_socket import open_socket
gone = os.fork() or os._exit(0)
os.waitpid(gone, 0)
kept = []
for pid in (os.getpid(), gone):
    path = socket_path(make_folder(), pid)
    listening = open_socket()
    listening.bind(str(path))
    listening.listen(0)
    kept.append(listening)
    try:
        while True:
            kept.append(open_socket())
            kept[-1].setblocking(False)
            kept[-1].connect(str(path))
    except ConnectionRefusedError:
        pass
print(running_stations() == [os.getpid()], path.exists())
try:
    connect(os.getpid(), Hello(SCREEN, 1), 0.01)
except NoStationError as error:
    print(error)
"""


def test_a_station_that_hangs_is_not_taken_for_one_that_ended(tmp_path: Path) -> None:
    """A full queue refuses on macOS, as does a socket that nobody has open: the process tells them apart."""
    first, second = under_rules(FULL, tmp_path).splitlines()
    assert first == "True False"
    assert second.endswith("takes no more programs: it may hang")


def test_addresses_of_this_machine_are_found(tmp_path: Path) -> None:
    code = "from link.transport.local_addresses import LocalAddresses; print(*LocalAddresses().find(0.0))"

    def found() -> bool:  # a test beside this one may make or delete an interface in between
        return under_rules(code, tmp_path).split() == list(LocalAddresses().find(0.0))

    wait_until(found, "both ways find the same addresses")


FILE = """
import os, sys
from link.tlog.raw_file import RawFile
RawFile(os.open("file", os.O_RDWR | os.O_CREAT)).sync()
print("written")
"""
TCP = """
import socket
from link.transport.tcp import _prepare
one = socket.create_server(("127.0.0.1", 0))
sock = socket.create_connection(one.getsockname())
_prepare(sock)
print(sock.getsockopt(socket.IPPROTO_TCP, 18), sock.getsockopt(socket.IPPROTO_TCP, 4))
"""
LOCK = """
from vehicle.runtime.lock import InUseError, MotorLock
mine = {"driver": "roboclaw", "port": "/dev/cu.test-of-rules"}
first = MotorLock(mine)
try:
    MotorLock(mine)
except InUseError:
    print("in use")
"""
NOTIFIER = """
import os, socket
from vehicle.runtime.systemd import Notifier
with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as told:
    told.bind(os.environ["XDG_RUNTIME_DIR"][:80] + "/n" if len(os.environ["XDG_RUNTIME_DIR"]) < 80 else "n")
    Notifier({"NOTIFY_SOCKET": told.getsockname()}).ready("up")
    print(told.recv(100))
"""
TRUST = """
from link.endpoint import parse_endpoint
from link.transport.reach import find_trust, missing_interfaces
print(find_trust(parse_endpoint("udpin:0.0.0.0:14550"), ["lo"]), missing_interfaces(["lo", "nosuch0"]))
"""
PORTS = "from link.transport.serial_ports import find_serial_ports; print(find_serial_ports())"


@pytest.mark.parametrize(
    ("code", "printed"),
    [(FILE, "written"), (TCP, "10000 5"), (LOCK, "in use"), (NOTIFIER, "b'READY=1\\nSTATUS=up'"),
     (TRUST, "None ['nosuch0']"), (PORTS, "[]")],
    ids=["file", "tcp", "lock", "notifier", "trust", "ports"],
)  # fmt: skip
def test_what_linux_does_in_its_own_way_works(
    code: str, printed: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    monkeypatch.chdir(Path(__file__).parents[2])
    assert under_rules(f"import os\nos.chdir({str(tmp_path)!r})\n{code}", tmp_path) == printed


def test_output_that_nobody_reads_any_more_is_no_error(tmp_path: Path) -> None:
    """poll() of macOS reports no hangup of a descriptor of which nothing else is wanted."""
    environment = {**os.environ, "PYTHONPATH": str(FOLDER)}
    words = [sys.executable, "-m", "groundstation", "--help"]
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(words, stdout=write, stderr=subprocess.PIPE, env=environment, check=False)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, b"")
