"""A bug in the station process: neutral several times, one line, exit code 1."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from groundstation import client
from groundstation.intents.driving import DriveKeyDown, SetStyle
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.vehicle import Arm
from groundstation.station.process.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from link.core import Peer, Received
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.host.crashing_station import ORDER
from tests.groundstation.screen import Screen, running
from tests.waits import wait_until

PEER = Peer(0, "vehicle")


def beat(autopilot: int, system: int = 1) -> Received:
    return Received(m.Heartbeat(10, autopilot, 128 | 64 | 1, 0, 4, 3), system, 1, 0, PEER, True)


def said(farewell: CrashNeutral, start: float, seconds: float = 1.0) -> list[tuple[float, m.ManualControl]]:
    """Every demand of the next second, and when."""
    demands: list[tuple[float, m.ManualControl]] = []
    for step in range(round(seconds / 0.025)):
        now = start + step * 0.025
        farewell.tick(now)
        for each in farewell.messages_to_send():
            assert isinstance(each.message, m.ManualControl)
            demands.append((now, each.message))
    return demands


def driven(autopilot: int = Autopilot.ARDUPILOT, *, systems: tuple[int, ...] = (1,)) -> CrashNeutral:
    """A station that has just sent each of these a demand."""
    farewell = CrashNeutral(Station(["memory"]))
    for system in systems:
        farewell.receive(beat(autopilot, system), 100.0)
        farewell.handle_sent(m.ManualControl(system, 0, 0, 600, 0, 0), 5, 100.0)
    return farewell


@pytest.mark.parametrize(
    ("autopilot", "axis", "neutral"),
    [(Autopilot.GENERIC, "x", 0), (Autopilot.ARDUPILOT, "z", 0), (Autopilot.PX4, "z", 500)],
)
def test_neutral_five_times_in_the_vehicles_own_axes(autopilot: int, axis: str, neutral: int) -> None:
    farewell = driven(autopilot)
    farewell.activate(100.1)
    demands = said(farewell, 100.1)
    assert [getattr(message, axis) for _, message in demands] == [neutral] * 5
    assert demands[0][0] == 100.1
    assert all(message.target == 1 for _, message in demands)
    assert farewell.finished


def test_every_vehicle_that_may_still_hold_a_demand_gets_neutral() -> None:
    farewell = driven(systems=(1, 2))
    farewell.handle_sent(m.ManualControl(2, 0, 0, 600, 0, 0), 6, 102.0)
    farewell.activate(103.5)
    assert {message.target for _, message in said(farewell, 103.5)} == {2}, "1 got its last one 3.5 s ago"


def test_the_station_is_not_called_any_more() -> None:
    farewell = driven()
    farewell.activate(100.1)
    said(farewell, 100.1)
    farewell.receive(beat(Autopilot.ARDUPILOT), 101.5)
    farewell.observe((), 101.5)
    assert said(farewell, 101.5) == []


def test_a_vehicle_that_was_not_driven_gets_nothing() -> None:
    farewell = CrashNeutral(Station(["memory"]))
    farewell.receive(beat(Autopilot.ARDUPILOT), 100.0)
    farewell.activate(100.1)
    assert farewell.finished
    assert said(farewell, 100.1) == []


# ---- the process ----


@pytest.fixture
def _a_bug_in_the_station(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client, "STATION", "tests.groundstation.host.crashing_station")


@pytest.mark.e2e
@pytest.mark.usefixtures("_a_bug_in_the_station")
@pytest.mark.parametrize(
    "place", ["intend", "receive", "tick", "observe", "messages_to_send", "handle_sent", "snapshot"]
)
def test_an_exception_anywhere_ends_with_neutral(place: str, tmp_path: Path) -> None:
    log_file = tmp_path / "station.log"
    with Screen(log_file=log_file) as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        broke = time.monotonic()
        screen.insist(
            lambda: screen.client.send(SetStyle(style=ORDER + place)),
            lambda snapshot: bool(snapshot.texts) and "station crashed" in snapshot.texts[-1].text,
        )
        wait_until(lambda: not running(screen.client.pid))
        seen = screen.snapshot
        assert seen.texts[-1].text.startswith("station crashed (ZeroDivisionError: a bug")
        assert "\n" not in seen.texts[-1].text
        assert (seen.operator.throttle, seen.operator.gate_open, seen.operator.gate_reason) == (
            0.0,
            False,
            "station crashed",
        )
        assert screen.client.close() == 1
        wait_until(lambda: sum(not x for _, x in vehicle.demands(broke)) >= 5)
        moving = [at for at, x in vehicle.demands(broke) if x]
        neutral = [at for at, x in vehicle.demands(broke) if not x]
        assert not moving or max(moving) < neutral[-5]
        (line,) = [line for line in log_file.read_text().splitlines() if "CRITICAL" in line]
        assert "station crashed (ZeroDivisionError: a bug" in line
        assert "sending neutral, then exiting" in line


@pytest.mark.e2e
@pytest.mark.usefixtures("_a_bug_in_the_station")
def test_without_a_vehicle_it_just_ends() -> None:
    with Screen() as screen:
        screen.client.send(
            RenewLease(),
            SetKeyGate(open=True),
            Arm(held=1.0),
            ReportKeyReleases(),
            DriveKeyDown(key="i", throttle=1, steering=0),
        )

        def ended() -> bool:
            screen.client.send(SetStyle(style=ORDER + "tick"))  # again: one that comes late is dropped
            return not running(screen.client.pid)

        wait_until(ended)
        assert screen.client.close() == 1
