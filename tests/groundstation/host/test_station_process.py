"""The station process for real: UDP, the pipe, kill -9, signals, and a screen that freezes."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.host.options import LOG_SIZE
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import Quit, SetKeyGate
from groundstation.intents.vehicle import Arm
from groundstation.intents.watch import Watch
from groundstation.ipc import IntentBatch, encode
from groundstation.snapshot import LogLine, Snapshot
from groundstation.views.log import LogPage, LogRequest
from tests.fakes.lines import on_line
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.killed_screen import assert_said_neutral, killed_screen, moving, neutral
from tests.groundstation.screen import FORWARD, Screen, running
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.e2e


def test_a_held_key_drives_and_its_release_is_neutral_at_once() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        waits, released = Waits(screen.client.pid), time.monotonic()
        screen.client.send(DriveKeyUp(key="i"))
        wait_until(lambda: len(neutral(vehicle, released)) > 5)
        assert neutral(vehicle, released)[0] - released < 0.3 + waits.total()
        assert not moving(vehicle, neutral(vehicle, released)[0])


def test_log_is_sent_while_watched_and_lasting_alerts_filed_once(tmp_path: Path) -> None:
    file = tmp_path / "station.log"
    with Screen(log_file=file) as screen, on_line(FakeArduPilot(), endpoint=screen.endpoint):
        warned = screen.see(lambda seen: seen.vehicle is not None and len(seen.vehicle.warnings) > 0)
        screen.see(lambda seen: seen.number > warned.number + 10)
        assert screen.client.pop_views() == []
        screen.client.send(Watch((LogRequest(),)))
        lines: list[LogLine] = []
        for _ in range(100):
            screen.see(lambda seen: True)
            lines += [line for view in screen.client.pop_views() if isinstance(view, LogPage) for line in view.lines]
            if lines:
                break
        assert "ArduPilot rover 1 found" in [line.text for line in lines]
    assert file.read_text().count("RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost") == 1


@pytest.mark.usefixtures("patient")
def test_quit_sends_neutral_several_times_and_ends() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        at = time.monotonic()
        assert screen.client.close() == 0
        assert_said_neutral(vehicle, at)


@pytest.mark.usefixtures("patient")
def test_quit_names_what_it_leaves_armed() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        assert screen.client.close() == 0
        assert screen.client.left_armed == ("Rover 1 is left ARMED in MANUAL",)
        assert vehicle.armed


@pytest.mark.usefixtures("patient")
def test_quit_disarms_on_request_and_ends() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        at = time.monotonic()
        screen.client.send(Quit(disarm=True))
        wait_until(lambda: not running(screen.client.pid))
        assert_said_neutral(vehicle, at)
        assert not vehicle.armed
        assert screen.client.close() == 0
        assert screen.client.left_armed == ()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_signals_mean_neutral_and_end(number: signal.Signals) -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        at = time.monotonic()
        os.kill(screen.client.pid, number)
        wait_until(lambda: not running(screen.client.pid))
        assert_said_neutral(vehicle, at)
        wait_until(lambda: screen.client.receive() is None and not screen.client.alive)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTSTP])
def test_the_terminals_keys_do_not_reach_the_station(number: signal.Signals) -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        os.kill(screen.client.pid, number)
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 3)
        assert screen.snapshot.operator.throttle > 0


def test_killed_screen_is_neutral_and_the_station_ends() -> None:
    with killed_screen(0.4) as (vehicle, station, killed):
        wait_until(lambda: not running(station))
        assert_said_neutral(vehicle, killed)


def test_a_frozen_screen_is_neutral_and_control_is_given_up() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        waits = Waits(screen.client.pid)
        screen.freeze()
        frozen = time.monotonic()
        wait_until(lambda: len(neutral(vehicle, frozen)) >= 5)
        assert max(moving(vehicle, 0.0)) - frozen < 0.5 + waits.total()
        quiet = time.monotonic()
        wait_until(lambda: time.monotonic() > quiet + 1.5)
        still = quiet + 0.1 + waits.total()  # what was on its way
        wait_until(lambda: time.monotonic() > still + 0.5)
        assert vehicle.demands(still) == []
        assert [at for at, _ in vehicle.all(m.Heartbeat) if at > still] == []


def test_no_key_is_lost_at_5_ms() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        wait_until(lambda: bool(vehicle.all(m.RoverOperatorPresence)))
        before = counted(vehicle) + late(screen.snapshot)
        started = time.monotonic()
        for number in range(1000):
            key, direction = ("j", -1) if number % 2 else ("l", 1)
            screen.client.send(DriveKeyDown(key=key, throttle=0, steering=direction))
            pause = started + 0.005 * (number + 1) - time.monotonic()
            screen._stop.wait(max(0.0, pause))
        screen.see(lambda snapshot: counted(vehicle) + late(snapshot) >= before + 1000)
        assert counted(vehicle) + late(screen.snapshot) == before + 1000


def counted(vehicle: FakeVehicle) -> int:
    """Return the number of inputs that the station reported last."""
    return vehicle.all(m.RoverOperatorPresence)[-1][1].input_count


def late(snapshot: Snapshot) -> int:
    """Return how many keys the station dropped and logged because a busy machine delayed them by 0.3 s."""
    return sum(line.count for line in snapshot.texts if "DriveKeyDown arrived" in line.text)


def test_intents_in_the_pipe_of_a_frozen_station_are_dropped() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.see(lambda snapshot: snapshot.vehicle is not None)
        old = IntentBatch(
            time.monotonic() - 2.0, (Arm(held=1.0), FORWARD, SetKeyGate(open=False, reason="late but true"))
        )
        screen.client._pipe.send(encode(old))
        screen.see(lambda snapshot: snapshot.operator.gate_reason == "late but true")
        screen.see(lambda snapshot: any("late and was dropped" in line.text for line in snapshot.texts))
        assert vehicle.all(m.CommandLong) == [] or not vehicle.armed


def test_noise_in_the_pipe_is_ignored() -> None:
    with Screen() as screen:
        screen.client._pipe.send(b"\x00noise")
        screen.client._pipe.send(encode(["Push", 1]))
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 2)


def test_nothing_is_printed_and_the_log_is_written(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    log_file = tmp_path / "station.log"
    with Screen(log_file=log_file) as screen:
        screen.client._pipe.send(b"noise")
        screen.see(lambda snapshot: snapshot.number > 3)
    assert "invalid packet from the screen" in log_file.read_text()
    assert capfd.readouterr() == ("", "")


def test_the_log_file_has_a_bound(tmp_path: Path) -> None:
    """A full file is kept once, and a new one begun."""
    log_file = tmp_path / "station.log"
    log_file.write_bytes(b"earlier\n".ljust(LOG_SIZE, b"."))
    with Screen(log_file=log_file) as screen:
        screen.client._pipe.send(b"noise")
        screen.see(lambda snapshot: snapshot.number > 3)
    assert log_file.with_name("station.log.1").stat().st_size == LOG_SIZE
    assert "invalid packet from the screen" in log_file.read_text()
    assert log_file.stat().st_size < LOG_SIZE / 10
