"""The ground station in control: arming, requests, takeover, release and timeout."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.axes import build_manual_control
from dialects.enums import Command, Result, Severity
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, said
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import START, Rig


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


class TestOwner:
    def test_a_new_one_starts_again(self) -> None:
        rig = Rig().controlled()
        rig.presence()
        rig.control.ownership.takeover_allowed = True
        rig.now += 3.0
        rig.control.take(conversation(OTHER), rig.now)
        assert rig.control.ownership.owner == OTHER
        assert rig.control.ownership.silence_duration(rig.now) == 0.0
        assert not rig.control.ownership.takeover_allowed
        assert not rig.control.presence.known
        assert not rig.control.neutral_seen
        assert rig.control.demand is None
        assert rig.severity(f"GCS {OTHER} is in control") is Severity.NOTICE

    def test_the_same_again_keeps_everything(self) -> None:
        rig = Rig().controlled()
        rig.presence()
        rig.control.ownership.takeover_allowed = True
        texts = len(rig.texts)
        rig.now += 3.0
        rig.control.take(conversation(DRIVER), rig.now)
        assert rig.control.ownership.silence_duration(rig.now) == 0.0
        assert rig.control.ownership.takeover_allowed
        assert rig.control.presence.known
        assert rig.control.neutral_seen
        assert len(rig.texts) == texts

    def test_after_its_release_no_station_is_in_control(self) -> None:
        rig = Rig().controlled()
        rig.control.release("gave it up", rig.now)
        assert rig.control.ownership.owner == 0
        assert rig.control.demand is None
        assert not rig.control.neutral_seen
        assert rig.severity(f"GCS {DRIVER} gave it up") is Severity.NOTICE

    @pytest.mark.parametrize("change", ["release", "owner"])
    def test_after_a_change_others_are_told_again_of_their_refusal(self, change: str) -> None:
        rig = Rig().controlled()
        assert not rig.stick(AHEAD, OTHER)
        first = sum(f"GCS {OTHER} ignored" in text for _, text in rig.texts)
        assert not rig.stick(AHEAD, OTHER)
        rig.now += 60.0
        rig.control.release("gave it up", rig.now) if change == "release" else rig.control.take(
            conversation(9), rig.now
        )
        assert not rig.stick(AHEAD, OTHER)
        assert not rig.stick(AHEAD, OTHER)
        assert sum(f"GCS {OTHER} ignored" in text for _, text in rig.texts) == first + 1 == 2
        assert rig.control.not_in_control_count == 4
        assert rig.severity("ignored") is Severity.WARNING

    def test_who_may_command(self) -> None:
        rig = Rig()
        assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None
        rig.control.take(conversation(DRIVER), START)
        assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None
        assert str(DRIVER) in (rig.control.ownership.denial_reason(conversation(OTHER), START) or "")

    def test_who_may_take_over(self) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5).controlled()
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 5.0) is not None
        assert rig.control.ownership.takeover_denial_reason(conversation(DRIVER), START) is None
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 5.1) is None
        rig.control.ownership.takeover_allowed = True
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START) is None

    def test_a_fixed_one_is_the_only_one(self) -> None:
        rig = Rig(MAV_GCS_SYSID=DRIVER)
        for allowed in (False, True):
            rig.control.ownership.takeover_allowed = allowed
            assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 60.0) is not None
            assert rig.control.ownership.denial_reason(conversation(OTHER), START) is not None
            assert rig.control.ownership.takeover_denial_reason(conversation(DRIVER), START) is None
            assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None

    def test_it_is_lost_after_its_time(self) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5)
        rig.control.take(conversation(DRIVER), 128.0)
        assert not rig.control.ownership.is_lost(133.0)
        assert rig.control.ownership.is_lost(133.1)

    @pytest.mark.parametrize(
        ("system", "introduced", "life"), [(DRIVER, True, True), (OTHER, True, False), (DRIVER, False, False)]
    )
    def test_what_is_a_sign_of_life(self, system: int, introduced: bool, life: bool) -> None:
        rig = Rig().controlled()
        received = rig.received(build_manual_control(NEUTRAL, 1), system, introduced=introduced)
        rig.control.hear(received, START + 3.0)
        assert rig.control.ownership.silence_duration(START + 3.0) == (0.0 if life else 3.0)
