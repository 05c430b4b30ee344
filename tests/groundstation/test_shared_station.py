"""One station, several screens, for real: sockets, other users, versions, kill -9 while wheels turn, and attach."""

from __future__ import annotations

import asyncio
import contextlib
import os
import pty
import signal
import socket
import stat
import subprocess
import sys
import time
import tty
from pathlib import Path

import msgspec
import pytest

from dialects import messages as m
from groundstation.cli.main import main
from groundstation.client import StationClient, StationError
from groundstation.host.listener import ProgramListener
from groundstation.intents.driving import STOP_KEY, Stop
from groundstation.intents.session import GiveUpKeys, Quit
from groundstation.intents.vehicle import Arm, GiveControl, RequestControl
from groundstation.ipc import protocol_version
from groundstation.station_socket.about import describe_stations
from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import (
    FolderError,
    folder_path,
    list_sockets,
    make_folder,
    socket_path,
)
from groundstation.station_socket.hello import SCREEN, Hello
from link.runtime import local_socket
from link.runtime.local_socket import LONGEST_ADDRESS, open_socket
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.killed_screen import ROOT, assert_said_neutral, killed_screen, moving, neutral
from tests.groundstation.screen import FORWARD, Screen, running
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

pytestmark = pytest.mark.e2e

NOBODY = 65534
"""User id of `nobody`."""


def test_the_socket_is_for_this_user_and_goes_with_its_station() -> None:
    with Screen() as screen:
        path = socket_path(folder_path(), screen.client.pid)
        wait_until(path.exists)
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
        assert running_stations() == [screen.client.pid]
        with pytest.raises(StationError, match="has another version: end it and start it again"):
            _attach_with(screen.client.pid, Hello(SCREEN, 1, "an old screen"))
        assert screen.client.alive
    wait_until(lambda: not path.exists())
    with pytest.raises(NoStationError, match="no station with process id"):
        connect(screen.client.pid, Hello(SCREEN, 1))


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_another_user_is_refused_even_where_the_folder_allows_it() -> None:
    with Screen() as screen:
        path = socket_path(folder_path(), screen.client.pid)
        wait_until(path.exists)
        for each, mode in ((path, 0o777), (path.parent, 0o755), (path.parent.parent, 0o755)):
            each.chmod(mode)
        try:
            kind = socket.SOCK_SEQPACKET if local_socket.KEEPS_PACKETS else socket.SOCK_STREAM
            command = [sys.executable, "-c", FOREIGN, str(path), str(NOBODY), str(int(kind))]
            said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        finally:
            for each, mode in ((path.parent.parent, 0o700), (path.parent, 0o700)):
                each.chmod(mode)
        assert f"this station belongs to another user (uid {os.getuid()})" in said
        assert screen.client.alive


FOREIGN = """
import os, socket, sys
os.setuid(int(sys.argv[2]))
sock = socket.socket(socket.AF_UNIX, int(sys.argv[3]))
sock.settimeout(20)
sock.connect(sys.argv[1])
print(sock.recv(4096))
"""


def test_second_screen_watches_stops_and_drives_when_given_keys() -> None:
    with Screen() as first, on_line(FakeVehicle(), endpoint=first.endpoint) as vehicle:
        first.drive(vehicle)
        wait_until(lambda: first.client.pid in running_stations())
        with Screen.attach(first.client.pid) as second:
            assert second.client.first_request == 1_000_001
            second.see(lambda seen: seen.lease.driver == "first screen")
            second.client.send(FORWARD)
            second.client.send(Arm(held=1.0))
            second.see(lambda seen: any("Arm of the second screen refused" in line.text for line in seen.texts))
            first.see(lambda seen: seen.operator.throttle > 0)

            stopped = time.monotonic()
            second.client.send(Stop(STOP_KEY))
            wait_until(lambda: bool(neutral(vehicle, stopped)))
            first.see(lambda seen: seen.operator.throttle == 0 and not seen.lease.driver)
            assert not moving(vehicle, neutral(vehicle, stopped)[0])

            second.client.send(RequestControl())
            first.see(lambda seen: seen.lease.asks == "second screen")
            first.client.send(GiveControl())
            second.see(lambda seen: not seen.lease.driver)
            first.see(lambda seen: seen.lease.driver == "second screen")
            second.drive(vehicle)
            first.client.send(FORWARD)
        wait_until(lambda: not moving(vehicle, time.monotonic() - 0.2))
        first.see(lambda seen: seen.lease.driver == "no screen")


@pytest.mark.parametrize("gives_up", [False, True], ids=["drives", "gives_up_the_keys"])
def test_kept_station_is_neutral_after_a_kill_and_takes_the_next(gives_up: bool) -> None:
    with killed_screen(0.3, "--keep") as (vehicle, station, killed):
        assert_said_neutral(vehicle, killed)
        assert running(station)
        with Screen.attach(station) as screen:
            screen.see(lambda seen: seen.vehicle is not None and seen.vehicle.armed and not seen.lease.driver)
            screen.drive(vehicle)
            if gives_up:
                given_up = time.monotonic()
                screen.client.send(GiveUpKeys())
                screen.see(lambda seen: seen.lease.driver == "no screen")
                assert_said_neutral(vehicle, given_up)
            screen.client.send(Quit(disarm=True))
            wait_until(lambda: not running(station))
            assert not vehicle.armed


def test_a_station_without_screens_is_silent_and_outlives_them() -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", endpoint]
    station = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT)
    try:
        assert station.stderr is not None
        assert station.stderr.readline() == (f"station {station.pid} on {endpoint}; `mavhelm attach` opens a screen\n")
        wait_until(lambda: running_stations() == [station.pid])
        with on_line(FakeVehicle(), endpoint=endpoint) as vehicle:
            with Screen.attach(station.pid) as screen:
                screen.drive(vehicle)
                left = time.monotonic()
            wait_until(lambda: bool(neutral(vehicle, left)))
            assert_said_neutral(vehicle, left)
            quiet = time.monotonic() + 0.2
            wait_until(lambda: time.monotonic() > quiet + 2.0)
            assert [at for at, _ in vehicle.all(m.Heartbeat) if at > quiet] == [], "the failsafe must act"
            assert running_stations() == [station.pid]
        station.send_signal(signal.SIGINT)
        assert station.wait(PATIENCE) == 0
    finally:
        station.kill()
        station.wait()
        assert station.stderr is not None
        station.stderr.close()


def test_version_is_of_the_packets_not_of_other_loaded_modules() -> None:
    code = "import groundstation.ipc; print(groundstation.ipc.protocol_version())"
    alone = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert msgspec.inspect.type_info(int)  # loads structs of msgspec
    assert protocol_version() == int(alone)


def test_a_socket_that_a_killed_station_has_left_is_removed() -> None:
    path = socket_path(make_folder(), 4_000_000)
    with open_socket() as sock:
        sock.bind(str(path))
        sock.listen()
    assert (4_000_000, path) in list_sockets()
    assert 4_000_000 not in running_stations()
    assert not path.exists()


@pytest.mark.parametrize("folders", ["/proc/self/fd", "/nowhere"])
def test_a_runtime_folder_may_be_deeper_than_a_socket_address(
    folders: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("groundstation.station_socket.folder.OPEN_FOLDERS", folders)
    deep = tmp_path / ("d" * LONGEST_ADDRESS)
    deep.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(deep))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(deep))

    async def listen() -> None:
        listener = ProgramListener(lambda caller: "no")
        assert listener.start() is None
        assert running_stations() == [os.getpid()]
        with connect(os.getpid(), Hello(SCREEN, 0)):
            listener.close()
        assert running_stations() == []

    asyncio.run(listen())


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda path: path.chmod(0o755), "is open to other users: chmod 700"),
        (lambda path: path.rename(path.with_name("elsewhere")) and path.symlink_to("elsewhere"), "is not a folder"),
        (lambda path: os.chown(path, NOBODY, NOBODY), "belongs to another user"),
    ],
)
def test_a_folder_that_others_can_change_is_not_used(
    spoil: object, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    path = make_folder()
    if "chown" in repr(spoil) and os.getuid():
        pytest.skip("only root can give a folder away")
    assert callable(spoil)
    spoil(path)
    with pytest.raises(FolderError, match=said):
        make_folder()
    with pytest.raises(FolderError, match=said):
        running_stations()


def test_several_stations_say_what_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    with Screen() as first, Screen() as second, on_line(FakeVehicle(system=7), endpoint=first.endpoint):
        pids = sorted((first.client.pid, second.client.pid))
        wait_until(lambda: running_stations() == pids)
        first.see(lambda seen: seen.vehicle is not None)
        texts = {
            first.client.pid: f"{first.client.pid} ({_vehicle_name(first)}, {first.endpoint}, first screen)",
            second.client.pid: f"{second.client.pid} (no vehicle, {second.endpoint}, first screen)",
        }
        which = ", ".join(texts[pid] for pid in pids)
        wait_until(lambda: describe_stations(pids) == which, "both answer in time")

        def said() -> str:
            assert main(["arm"]) == 2
            return capsys.readouterr().err

        wait_until(lambda: said() == f"mavhelm: stations {which} run here: name one with --station PID\n")
        os.kill(second.client.pid, signal.SIGSTOP)
        try:
            texts[second.client.pid] = str(second.client.pid)  # it does not answer
            assert describe_stations(pids) == ", ".join(texts[pid] for pid in pids)
        finally:
            os.kill(second.client.pid, signal.SIGCONT)


def _vehicle_name(screen: Screen) -> str:
    vehicle = screen.snapshot.vehicle
    assert vehicle is not None
    return vehicle.name


def test_a_port_of_another_station_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    with Screen() as screen:
        pid, port = screen.client.pid, screen.endpoint.rpartition(":")[2]
        wait_until(lambda: running_stations() == [pid])
        for endpoint in (screen.endpoint, f"udpin:0.0.0.0:{port}"):
            with pytest.raises(StationError) as caught:
                StationClient.start([endpoint])
            held = f"{endpoint}: port {port} is in use; a station of yours ({pid}) has it: "
            assert str(caught.value) == f"{held}mavhelm attach"
            assert main(["status", "-e", endpoint, "--station", "never"]) == 2
            assert capsys.readouterr().err == f"mavhelm: {held}--station {pid} goes through it\n"


def test_a_serial_port_of_another_station_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """/dev/serial0 and /dev/serial/by-id/... are links to the device."""
    ours, theirs = pty.openpty()
    tty.setraw(ours)
    device, link = os.ttyname(theirs), tmp_path / "serial0"
    link.symlink_to(device)
    with contextlib.closing(StationClient.start([f"serial:{device}:57600"])) as client:
        wait_until(lambda: running_stations() == [client.pid])
        for name in (device, str(link)):
            assert main(["status", "-e", f"serial:{name}:115200", "--station", "never"]) == 2
            held = f"another program uses {name}; a station of yours ({client.pid}) has it: --station {client.pid}"
            assert held in capsys.readouterr().err
    os.close(ours)
    os.close(theirs)


def _attach_with(station: int, hello: Hello) -> StationClient:
    from groundstation import client as module

    pipe = connect(station, hello)
    with pipe:
        module._read_ready(pipe, 20.0)
    raise AssertionError("it was taken")
