"""Control handed over in one step: the mode stays, neutral comes first, and no failsafe fires."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, Result, Severity
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, said
from vehicle.commands.arming import ANSWER_WITHIN, RELEASE_REPEATED_WITHIN

THIRD = 253


def ask(bench: Bench, system: int, *, within: float = ANSWER_WITHIN) -> Result | None:
    return bench.command(Command.REQUEST_OPERATOR_CONTROL, 1, 0, within, system, system=system)


def release(bench: Bench, *, station: float = 0, system: int = DRIVER) -> Result | None:
    return bench.command(Command.REQUEST_OPERATOR_CONTROL, 0, 0, 0, station, system=system)


def driver(bench: Bench) -> int:
    bench.wait(1.2, NEUTRAL, system=OTHER)
    return bench.newest(m.ControlStatus).gcs_main


def alarms(bench: Bench) -> list[str]:
    return [each.text for each in bench.all(m.StatusText) if each.severity <= Severity.CRITICAL]


def driven() -> Bench:
    bench = Bench()
    bench.drive()
    assert bench.turning
    assert ask(bench, OTHER) is Result.FAILED
    return bench


@pytest.mark.parametrize("station", [0, OTHER, math.nan], ids=["newest", "named", "not given"])
def test_the_one_that_asks_gets_control_in_the_same_mode(station: float) -> None:
    bench = driven()
    assert release(bench, station=station) is Result.ACCEPTED
    bench.wait(0.6, AHEAD, system=OTHER)
    assert not bench.turning, "a held stick of the new driver moves nothing"
    assert driver(bench) == OTHER
    assert (bench.mode, bench.armed) == (Mode.MANUAL, True)
    bench.wait(0.2, AHEAD, system=OTHER)
    assert bench.turning
    assert alarms(bench) == []
    assert not said(bench, "Failsafe")


def test_the_old_driver_moves_nothing_after_it() -> None:
    bench = driven()
    release(bench)
    bench.wait(0.6, AHEAD)
    assert not bench.turning
    assert said(bench, f"Demand from GCS {DRIVER} ignored: GCS {OTHER} is in control")


def test_a_mission_goes_on_under_the_new_driver() -> None:
    bench = Bench()
    bench.drive()
    assert bench.set_mode(Mode.GUIDED) is Result.ACCEPTED
    ask(bench, OTHER)
    release(bench)
    assert driver(bench) == OTHER
    assert bench.mode is Mode.GUIDED


def test_without_a_request_it_holds() -> None:
    bench = Bench()
    bench.drive()
    release(bench)
    bench.wait(0.6)
    assert not bench.turning
    assert bench.mode is Mode.HOLD
    assert alarms(bench) == [], "a driver that leaves is not lost"
    bench.wait(5.0)
    assert said(bench, "Failsafe: ground station lost"), "but an armed rover without one is, 5 s later"


@pytest.mark.parametrize(
    ("within", "after", "given"),
    [
        (10.0, 9.0, True),
        (10.0, 11.0, False),
        (4.0, 5.0, False),
        (60.0, 50.0, True),
        (1.0, 9.0, True),
        (900.0, 11.0, False),
    ],
)
def test_a_request_that_was_not_answered_in_time_is_over(within: float, after: float, given: bool) -> None:
    bench = Bench()
    bench.drive()
    ask(bench, OTHER, within=within)
    bench.wait(after, AHEAD)
    release(bench)
    assert bench.mode is (Mode.MANUAL if given else Mode.HOLD)


def test_control_goes_to_the_named_station_and_nobody_else() -> None:
    bench = driven()
    ask(bench, THIRD)
    assert release(bench, station=OTHER) is Result.ACCEPTED
    assert driver(bench) == OTHER


def test_one_that_is_named_and_has_not_asked_gets_nothing() -> None:
    bench = driven()
    assert release(bench, station=THIRD) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.mode is Mode.HOLD
    assert bench.newest(m.ControlStatus).gcs_main == 0


def test_a_release_repeated_after_a_lost_ack_is_accepted() -> None:
    bench = driven()
    assert release(bench) is Result.ACCEPTED
    bench.wait(0.5, NEUTRAL, system=OTHER)
    assert release(bench) is Result.ACCEPTED
    assert driver(bench) == OTHER, "the repetition takes nothing from the new driver"
    assert (bench.mode, bench.armed) == (Mode.MANUAL, True)


def test_a_release_is_accepted_again_after_another_has_taken() -> None:
    bench = Bench()
    bench.drive()
    release(bench)
    assert ask(bench, OTHER) is Result.ACCEPTED
    assert release(bench) is Result.ACCEPTED
    assert driver(bench) == OTHER


def test_a_late_or_foreign_release_is_no_repetition() -> None:
    bench = driven()
    release(bench)
    assert release(bench, system=THIRD) is Result.FAILED
    bench.wait(RELEASE_REPEATED_WITHIN + 0.1, NEUTRAL, system=OTHER)
    assert release(bench) is Result.FAILED
    assert driver(bench) == OTHER


def test_only_the_driver_gives() -> None:
    bench = driven()
    assert release(bench, system=OTHER) is Result.FAILED
    assert release(bench, system=THIRD, station=OTHER) is Result.FAILED
    assert bench.turning


@pytest.mark.parametrize("station", [math.inf, -1, 254.5, 256, 1e30])
def test_what_is_no_system_id_is_denied(station: float) -> None:
    bench = driven()
    assert release(bench, station=station) is Result.DENIED
    assert bench.turning


def test_one_that_may_not_drive_is_given_nothing() -> None:
    bench = Bench(MAV_GCS_SYSID=DRIVER)
    bench.drive()
    ask(bench, OTHER)
    release(bench)
    bench.wait(0.1)
    assert bench.mode is Mode.HOLD
