"""The ground station in control: arming, requests, takeover, release and timeout."""

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


def test_control_is_free_at_boot_and_taken_by_arming() -> None:
    bench = Bench()
    assert owner(bench) == 0
    bench.arm()
    assert owner(bench) == DRIVER


def test_control_is_free_at_boot_and_taken_by_a_request() -> None:
    bench = Bench()
    assert ask(bench, OTHER) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.newest(m.ControlStatus).gcs_main == OTHER
    assert bench.arm() is Result.FAILED
    assert said(bench, f"PreArm: GCS {OTHER} is in control")


def test_control_request_is_rejected_and_forwarded_to_the_owner() -> None:
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
    assert len(bench.all(m.CommandLong)) == 1  # a repeated request is not forwarded
    assert bench.turning


def test_an_allowed_takeover_requires_neutral_first() -> None:
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


def test_the_owner_may_request_control_again_while_driving() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, DRIVER) is Result.ACCEPTED
    bench.wait(0.2, AHEAD)
    assert bench.throttles == (1.0, 1.0)


def test_a_peer_without_a_heartbeat_cannot_request_control() -> None:
    bench = Bench()
    request = Command.REQUEST_OPERATOR_CONTROL
    assert bench.command(request, 1, 0, 10, 0, introduced=False) is Result.FAILED
    bench.wait(1.1)
    assert bench.newest(m.ControlStatus).gcs_main == 0


def test_control_can_be_taken_from_an_owner_that_timed_out() -> None:
    bench = Bench()
    bench.drive()
    bench.wait(4.9)
    assert ask(bench, OTHER) is Result.FAILED
    bench.wait(1.0)
    assert ask(bench, OTHER) is Result.ACCEPTED


def test_releasing_control_causes_hold() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, DRIVER, action=0) is Result.ACCEPTED
    bench.wait(0.6)
    assert not bench.turning
    assert bench.mode is Mode.HOLD
    assert bench.newest(m.ControlStatus).gcs_main == 0


def test_only_the_owner_can_release_control() -> None:
    bench = Bench()
    bench.drive()
    assert ask(bench, OTHER, action=0) is Result.FAILED
    assert bench.turning


@pytest.mark.parametrize(
    "params", [(2, 0, 10, 0), (0.5, 0, 10, 0), (1, 2, 10, 0), (1, 0, 10, 77), (float("nan"), 0, 0, 0)]
)
def test_invalid_control_requests_are_denied(params: tuple[float, ...]) -> None:
    bench = Bench()
    assert bench.command(Command.REQUEST_OPERATOR_CONTROL, *params) is Result.DENIED


def test_only_the_configured_ground_station_may_take_control() -> None:
    bench = Bench(MAV_GCS_SYSID=OTHER)
    assert bench.arm() is Result.FAILED
    assert ask(bench, DRIVER) is Result.FAILED
    assert bench.arm(OTHER) is Result.ACCEPTED


def test_an_owner_that_times_out_while_disarmed_loses_control() -> None:
    bench = Bench()
    ask(bench, DRIVER)
    bench.wait(5.5)
    assert bench.newest(m.ControlStatus).gcs_main == 0
    assert said(bench, "No GCS is in control")
