"""Who is in control, and how it changes."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, said


def owner(bench: Bench) -> int:
    bench.wait(1.5, NEUTRAL)
    return bench.newest(m.ControlStatus).gcs_main


def ask(bench: Bench, system: int, action: float = 1, takeover: float = 0) -> Result | None:
    return bench.command(Command.REQUEST_OPERATOR_CONTROL, action, takeover, 10, system, system=system)


def test_nobody_at_boot_then_who_arms() -> None:
    bench = Bench()
    assert owner(bench) == 0
    bench.arm()
    assert owner(bench) == DRIVER


def test_nobody_at_boot_then_who_asks() -> None:
    bench = Bench()
    assert ask(bench, OTHER) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.newest(m.ControlStatus).gcs_main == OTHER
    assert bench.arm() is Result.FAILED
    assert said(bench, f"PreArm: GCS {OTHER} is in control")


def test_a_request_is_refused_and_passed_on_to_the_owner() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, OTHER) is Result.FAILED
    passed = bench.newest(m.CommandLong)
    assert (passed.target_system, passed.command, passed.param4) == (
        DRIVER,
        Command.REQUEST_OPERATOR_CONTROL,
        OTHER,
    )
    ask(bench, OTHER)
    assert len(bench.all(m.CommandLong)) == 1  # a repeat does not nag
    assert bench.turning


def test_takeover_that_the_owner_allowed_needs_neutral_first() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, DRIVER, takeover=1) is Result.ACCEPTED
    assert ask(bench, OTHER) is Result.ACCEPTED
    bench.wait(0.6, AHEAD, system=OTHER)
    assert not bench.turning
    bench.wait(0.1, NEUTRAL, system=OTHER)
    bench.wait(0.1, AHEAD, system=OTHER)
    assert bench.turning
    assert said(bench, f"GCS {OTHER} is in control")


def test_the_owner_may_ask_again_while_it_drives() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, DRIVER) is Result.ACCEPTED
    bench.wait(0.2, AHEAD)
    assert bench.throttles == (1.0, 1.0)


def test_who_has_shown_no_heartbeat_cannot_ask() -> None:
    bench = Bench()
    request = Command.REQUEST_OPERATOR_CONTROL
    assert bench.command(request, 1, 0, 10, 0, introduced=False) is Result.FAILED
    bench.wait(1.1)
    assert bench.newest(m.ControlStatus).gcs_main == 0


def test_a_silent_owner_can_be_relieved() -> None:
    bench = Bench()
    bench.drive()
    bench.wait(4.9)
    assert ask(bench, OTHER) is Result.FAILED
    bench.wait(1.0)
    assert ask(bench, OTHER) is Result.ACCEPTED


def test_the_owner_gives_up_and_the_rover_holds() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, DRIVER, action=0) is Result.ACCEPTED
    bench.wait(0.6)
    assert not bench.turning
    assert bench.mode is Mode.HOLD
    assert bench.newest(m.ControlStatus).gcs_main == 0


def test_nobody_else_can_give_it_up() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, OTHER, action=0) is Result.FAILED
    assert bench.turning


@pytest.mark.parametrize(
    "params", [(2, 0, 10, 0), (0.5, 0, 10, 0), (1, 2, 10, 0), (1, 0, 10, 77), (float("nan"), 0, 0, 0)]
)
def test_nonsense_is_denied(params: tuple[float, ...]) -> None:
    bench = Bench()
    assert bench.command(Command.REQUEST_OPERATOR_CONTROL, *params) is Result.DENIED


def test_a_fixed_ground_station_is_the_only_one() -> None:
    bench = Bench(MAV_GCS_SYSID=OTHER)
    assert bench.arm() is Result.FAILED
    assert ask(bench, DRIVER) is Result.FAILED
    assert bench.arm(OTHER) is Result.ACCEPTED


def test_an_owner_that_is_silent_while_disarmed_is_free_again() -> None:
    bench = Bench()
    ask(bench, DRIVER)
    bench.wait(5.5)
    assert bench.newest(m.ControlStatus).gcs_main == 0
    assert said(bench, "No GCS is in control")
