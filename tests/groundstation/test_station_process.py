"""The station process for real: UDP, the pipe, kill -9, signals, and a screen that freezes."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation import client as client_module
from groundstation.client import StationClient, StationError
from groundstation.intents import Arm, DriveKeyDown, DriveKeyUp, RenewLease, SetKeyGate, StartSimulator
from groundstation.ipc import IntentBatch, encode
from groundstation.snapshot import Snapshot
from tests.groundstation.screen import FORWARD, PATIENCE, Screen, children, running, until
from tests.groundstation.udp_vehicle import UdpVehicle
from tests.ports import free_port
from tests.waits import Waits

pytestmark = pytest.mark.e2e

ROOT = Path(__file__).resolve().parents[2]


def moving(vehicle: UdpVehicle, since: float) -> list[float]:
    return [at for at, x in vehicle.demands(since) if x]


def neutral(vehicle: UdpVehicle, since: float) -> list[float]:
    return [at for at, x in vehicle.demands(since) if not x]


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A station may take its time to end."""
    monkeypatch.setattr(client_module, "CLOSE_TIMEOUT", PATIENCE)


def assert_said_neutral(vehicle: UdpVehicle, since: float) -> None:
    """A station that has ended said neutral five times as the last it said."""
    until(lambda: len(neutral(vehicle, since)) >= 5)
    assert len(neutral(vehicle, since)) == 5
    assert not moving(vehicle, neutral(vehicle, since)[0])


def test_a_held_key_drives_and_its_release_is_neutral_at_once() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        waits, released = Waits(screen.client.pid), time.monotonic()
        screen.client.send(DriveKeyUp(key="i"))
        until(lambda: len(neutral(vehicle, released)) > 5)
        assert neutral(vehicle, released)[0] - released < 0.3 + waits.total()
        assert not moving(vehicle, neutral(vehicle, released)[0])


@pytest.mark.usefixtures("patient")
def test_quit_sends_neutral_several_times_and_ends() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        at = time.monotonic()
        assert screen.client.close() == 0
        assert_said_neutral(vehicle, at)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_signals_mean_neutral_and_end(number: signal.Signals) -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        at = time.monotonic()
        os.kill(screen.client.pid, number)
        until(lambda: not running(screen.client.pid))
        assert_said_neutral(vehicle, at)
        until(lambda: screen.client.receive() is None and not screen.client.alive)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTSTP])
def test_the_terminals_keys_do_not_reach_the_station(number: signal.Signals) -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        os.kill(screen.client.pid, number)
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 3)
        assert screen.snapshot.operator.throttle > 0


def test_killed_screen_is_neutral_and_the_station_ends() -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "tests.groundstation.parent", endpoint]
    parent = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT)
    try:
        with UdpVehicle(endpoint) as vehicle:
            assert parent.stdout is not None
            station = int(parent.stdout.readline())
            until(lambda: bool(moving(vehicle, 0.0)))
            waits, killed = Waits(station), time.monotonic()
            parent.kill()
            until(lambda: bool(neutral(vehicle, killed)))
            assert neutral(vehicle, killed)[0] - killed < 0.4 + waits.total()
            until(lambda: not running(station))
            assert_said_neutral(vehicle, killed)
    finally:
        parent.kill()
        parent.wait()
        assert parent.stdout is not None
        parent.stdout.close()


def test_frozen_screen_is_neutral_within_half_a_second_and_control_is_given_up() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        waits = Waits(screen.client.pid)
        screen.freeze()
        frozen = time.monotonic()
        until(lambda: len(neutral(vehicle, frozen)) >= 5)
        assert max(moving(vehicle, 0.0)) - frozen < 0.5 + waits.total()
        quiet = time.monotonic()
        until(lambda: time.monotonic() > quiet + 1.5)
        still = quiet + 0.1 + waits.total()  # what was on its way
        until(lambda: time.monotonic() > still + 0.5)
        assert vehicle.demands(still) == []
        assert [at for at, _ in vehicle.core.all(m.Heartbeat) if at > still] == []


def test_no_key_is_lost_at_5_ms() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        until(lambda: bool(vehicle.core.all(m.RoverOperatorPresence)))
        before = counted(vehicle) + late(screen.snapshot)
        started = time.monotonic()
        for number in range(1000):
            key, direction = ("j", -1) if number % 2 else ("l", 1)
            screen.client.send(DriveKeyDown(key=key, throttle=0, steering=direction))
            pause = started + 0.005 * (number + 1) - time.monotonic()
            screen._stop.wait(max(0.0, pause))
        screen.see(lambda snapshot: counted(vehicle) + late(snapshot) >= before + 1000)
        assert counted(vehicle) + late(screen.snapshot) == before + 1000


def counted(vehicle: UdpVehicle) -> int:
    """Keys, as the station has told last."""
    return vehicle.core.all(m.RoverOperatorPresence)[-1][1].input_count


def late(snapshot: Snapshot) -> int:
    """Keys that a station which the machine held up has dropped, because they came 0.3 s late, and has told."""
    return sum(line.count for line in snapshot.texts if "DriveKeyDown arrived" in line.text)


def test_intents_that_lay_in_the_pipe_of_a_frozen_station_do_not_act() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.see(lambda snapshot: snapshot.vehicle is not None)
        old = IntentBatch(time.monotonic() - 2.0, (Arm(), FORWARD, SetKeyGate(open=False, reason="late but true")))
        screen.client._pipe.send(encode(old))
        screen.see(lambda snapshot: snapshot.operator.gate_reason == "late but true")
        screen.see(lambda snapshot: any("late and was dropped" in line.text for line in snapshot.texts))
        assert vehicle.core.all(m.CommandLong) == [] or not vehicle.core.armed


def test_noise_in_the_pipe_is_ignored() -> None:
    with Screen() as screen:
        screen.client._pipe.send(b"\x00noise")
        screen.client._pipe.send(encode(["Push", 1]))
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 2)


def test_a_screen_that_does_not_read_blocks_nothing() -> None:
    with Screen() as screen, UdpVehicle(screen.endpoint) as vehicle:
        screen.drive(vehicle)
        start = time.monotonic()
        until(lambda: len(moving(vehicle, start)) > 30)
        newest = screen.client.receive()
        assert newest is not None
        assert newest.number > screen.snapshot.number + 5, "the newest one, not the oldest"


@pytest.mark.parametrize(
    ("endpoint", "words"),
    [
        ("carrier:pigeon", "udpin:HOST:PORT"),
        ("udpin:127.0.0.1:99999", "port '99999' is not a number from 1 to 65535"),
        ("udpin:no-such-host.invalid:14550", "is not known"),
    ],
)
def test_what_is_wrong_is_told_in_one_line_before_anything_opens(endpoint: str, words: str) -> None:
    with pytest.raises(StationError) as caught:
        StationClient.start([endpoint])
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_port_in_use() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(StationError, match="is in use"):
            StationClient.start([f"udpin:127.0.0.1:{taken.getsockname()[1]}"])


def test_nothing_is_printed_and_the_log_is_written(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    log_file = tmp_path / "station.log"
    with Screen(log_file=log_file) as screen:
        screen.client._pipe.send(b"noise")
        screen.see(lambda snapshot: snapshot.number > 3)
    assert "invalid packet from the screen" in log_file.read_text()
    assert capfd.readouterr() == ("", "")


# ---- the simulator ----


def sees_rover(screen: Screen) -> None:
    screen.see(lambda snapshot: snapshot.vehicle is not None and snapshot.vehicle.alive)


@pytest.mark.usefixtures("patient")
def test_sitl_starts_a_rover_on_a_free_port_and_ends_it_with_us() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        assert screen.snapshot.simulator == "running"
        (simulator,) = children(screen.client.pid)
        assert screen.client.close() == 0
        until(lambda: not running(simulator))


def test_the_simulator_can_be_started_later() -> None:
    with Screen() as screen:
        screen.see(lambda snapshot: snapshot.waiting is not None)
        assert screen.snapshot.simulator is None
        screen.client.send(RenewLease(), StartSimulator())
        sees_rover(screen)
        screen.client.send(StartSimulator())
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 3)
        assert len(children(screen.client.pid)) == 1


def test_the_simulator_dies_with_a_station_that_is_killed() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        (simulator,) = children(screen.client.pid)
        os.kill(screen.client.pid, signal.SIGKILL)
        until(lambda: not running(simulator))


def test_the_end_of_the_simulator_is_told() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        os.kill(children(screen.client.pid)[0], signal.SIGKILL)
        screen.see(lambda snapshot: str(snapshot.simulator).startswith("ended by SIGKILL"))
        assert any("simulator ended by SIGKILL" in line.text for line in screen.snapshot.texts)
