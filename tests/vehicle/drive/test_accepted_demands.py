"""Demands that Control accepts, without a rover: their axes, their age, and when neutral comes first."""

from __future__ import annotations

import pytest

from dialects.axes import Axes, build_manual_control
from dialects.enums import Severity
from dialects.messages import INVALID_AXIS, UINT16_MAX, ManualControl, RcChannelsOverride, RoverOperatorPresence
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, BEAT, DRIVER, NEUTRAL, OTHER
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import BOOT, START, Rig


def raw(rig: Rig, **axes: int) -> bool:
    """A MANUAL_CONTROL with raw axes."""
    message = ManualControl(target=1, **({"x": 0, "y": 0, "z": 0, "r": 0, "buttons": 0} | axes))
    return rig.control.handle_manual_control(rig.received(message), message, rig.now)


def override(rig: Rig, target: int = 1, **channels: int) -> bool:
    values = {f"chan{number}_raw": UINT16_MAX for number in range(1, 19)}
    values |= {f"{name}_raw": value for name, value in channels.items()}
    message = RcChannelsOverride(target_system=target, target_component=1, **values)
    return rig.control.handle_rc_override(rig.received(message), message, rig.now)


def test_at_start_no_station_has_control_and_no_neutral_was_seen() -> None:
    control = Rig().control
    assert (control.ownership.owner, control.demand, control.not_in_control_count) == (0, None, 0)
    assert not control.ownership.takeover_allowed
    assert not control.neutral_seen
    assert not control.presence.known
    assert control.override.channels == {}
    assert control.ownership.silence_duration(BOOT + 2.0) == 2.0  # since the boot
    assert control.demand_age(START) is None
    assert not control.is_demand_stale(START)
    assert not control.requests_motion()


class TestManualControl:
    def test_it_becomes_the_demand(self) -> None:
        rig = Rig().controlled()
        assert rig.stick(Axes(0.5, -0.25))
        demand = rig.control.demand
        assert demand is not None
        assert (demand.throttle, demand.steering, demand.time, demand.system) == (0.5, -0.25, START, DRIVER)

    @pytest.mark.parametrize("target", [0, 2, 255])
    def test_for_another_vehicle_it_is_not_even_counted(self, target: int) -> None:
        rig = Rig().controlled()
        message = build_manual_control(AHEAD, target)
        assert not rig.control.handle_manual_control(rig.received(message), message, START)
        assert not rig.control.handle_manual_control(rig.received(message, OTHER), message, START)
        assert rig.control.not_in_control_count == 0
        assert not rig.control.requests_motion()

    def test_before_a_heartbeat_it_is_not_even_counted(self) -> None:
        rig = Rig().controlled()
        message = build_manual_control(AHEAD, 1)
        for system in (DRIVER, OTHER):
            received = rig.received(message, system, introduced=False)
            assert not rig.control.handle_manual_control(received, message, START)
        assert rig.control.not_in_control_count == 0

    def test_without_control_the_text_says_how_to_take_it(self) -> None:
        rig = Rig()
        assert not rig.stick(AHEAD)
        assert rig.said("arm to take it")
        rig = Rig().controlled()
        assert not rig.stick(AHEAD, OTHER)
        assert rig.said(f"GCS {DRIVER} is in control")

    def test_a_packet_a_second_time_is_none(self) -> None:
        rig = Rig().controlled()
        message = build_manual_control(AHEAD, 1)
        received = rig.received(message)
        assert rig.control.handle_manual_control(received, message, START)
        assert not rig.control.handle_manual_control(received, message, START + 1.0)
        assert rig.control.demand_age(START + 1.0) == 1.0

    @pytest.mark.parametrize("axes", [{"x": 1001}, {"x": -1001}, {"r": 1001}, {"r": -1001}])
    def test_an_axis_out_of_range_is_reported_once(self, axes: dict[str, int]) -> None:
        rig = Rig().controlled()
        for _ in range(3):
            assert raw(rig, **axes)
            rig.now += 60.0
        assert sum("outside -1000..1000" in text for _, text in rig.texts) == 1
        assert rig.severity("outside -1000..1000") is Severity.WARNING

    @pytest.mark.parametrize("axes", [{"x": 1000, "r": -1000}, {"x": INVALID_AXIS}, {"r": INVALID_AXIS}])
    def test_an_axis_in_range_or_off_is_not(self, axes: dict[str, int]) -> None:
        rig = Rig().controlled()
        assert raw(rig, **axes)
        assert not rig.said("outside")

    def test_without_an_axis_it_is_no_demand(self) -> None:
        rig = Rig().controlled()
        assert raw(rig, x=500)
        before = rig.control.demand
        assert not raw(rig, x=INVALID_AXIS, r=INVALID_AXIS)
        assert rig.control.demand is before

    @pytest.mark.parametrize(("kind", "side"), [(1, None), (4, 0.5)])
    def test_sideways_where_the_vehicle_can(self, kind: float, side: float | None) -> None:
        rig = Rig(DRIVE_TYPE=kind).controlled()
        assert raw(rig, y=500)
        assert rig.control.demand is not None
        assert rig.control.demand.sideways == side


class TestNeutralFirst:
    def test_a_neutral_demand_is_seen_up_to_the_dead_band(self) -> None:
        rig = Rig(MAN_DEADBAND=10)
        rig.control.take(conversation(DRIVER), START)
        assert rig.control.deadband == 0.1
        assert raw(rig, x=101)
        assert not rig.control.neutral_seen
        assert raw(rig, x=100, r=-100)
        assert rig.control.neutral_seen
        assert raw(rig, x=500)
        assert rig.control.neutral_seen

    def test_a_reset_forgets_everything(self) -> None:
        rig = Rig().controlled()
        assert override(rig, chan3=1700)
        assert rig.control.override.channels
        rig.control.reset()
        assert rig.control.demand is None
        assert rig.control.override.channels == {}
        assert not rig.control.neutral_seen

    @pytest.mark.parametrize(("axes", "seen"), [(AHEAD, False), (NEUTRAL, True)])
    def test_stale_motion_needs_neutral_again_and_stale_neutral_not(self, axes: Axes, seen: bool) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).controlled()
        rig.stick(axes)
        rig.control.expire_stale_demand(START + 0.5)
        assert rig.control.neutral_seen
        assert not rig.control.is_demand_stale(START + 0.5)
        assert rig.control.is_demand_stale(START + 0.51)
        rig.control.expire_stale_demand(START + 0.51)
        assert rig.control.neutral_seen is seen

    def test_a_demand_after_a_stale_one_needs_neutral_between_cycles(self) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).controlled()
        rig.stick(AHEAD)
        rig.now += 0.6
        rig.stick(AHEAD)
        assert not rig.control.neutral_seen


class TestOperator:
    def old(self, rig: Rig, age: float) -> None:
        """The driver has seen nothing newer than of `age` s ago."""
        rig.presence(echo=round((rig.now - BOOT - age) * 1000))

    def test_old_demands_are_refused_and_reported_once(self) -> None:
        rig = Rig(OPR_ECHO_MAX=0.5).controlled()
        self.old(rig, 0.5)
        assert rig.stick(AHEAD)
        self.old(rig, 0.501)
        assert not rig.stick(AHEAD)
        rig.now += 60.0
        self.old(rig, 1.0)
        assert not rig.stick(AHEAD)
        assert sum("OPR_ECHO_MAX" in text for _, text in rig.texts) == 1
        assert rig.severity("OPR_ECHO_MAX") is Severity.WARNING
        assert rig.control.demand_age(START + 60.0) == 60.0

    def test_an_old_neutral_is_a_demand_but_no_stick_at_rest(self) -> None:
        rig = Rig(OPR_ECHO_MAX=0.5).controlled()
        rig.stick(AHEAD)
        rig.control.require_neutral()
        self.old(rig, 1.0)
        assert rig.stick(NEUTRAL)
        assert not rig.control.requests_motion()
        assert not rig.control.neutral_seen
        self.old(rig, 0.0)
        assert rig.stick(NEUTRAL)
        assert rig.control.neutral_seen

    def test_a_new_session_needs_neutral(self) -> None:
        rig = Rig().controlled()
        rig.presence(session=1)
        assert rig.control.neutral_seen
        rig.presence(session=1)
        assert rig.control.neutral_seen
        rig.presence(session=2)
        assert not rig.control.neutral_seen

    @pytest.mark.parametrize("wrong", [{"target": 2}, {"system": OTHER}, {"introduced": False}])
    def test_of_others_and_for_others_it_is_ignored(self, wrong: dict[str, int]) -> None:
        rig = Rig().controlled()
        rig.presence(**wrong)  # type: ignore[arg-type]
        assert not rig.control.presence.known
        assert rig.texts == Rig().controlled().texts  # nor is it reported


class TestOverride:
    def test_it_becomes_the_demand(self) -> None:
        rig = Rig().controlled()
        assert override(rig, chan1=1500, chan3=1900)
        demand = rig.control.demand
        assert demand is not None
        assert (demand.throttle, demand.steering, demand.time, demand.system) == (1.0, 0.0, START, DRIVER)

    def test_for_another_vehicle_it_is_none(self) -> None:
        rig = Rig().controlled()
        assert not override(rig, target=2, chan3=1900)
        assert not rig.control.requests_motion()

    def test_of_other_channels_it_is_none(self) -> None:
        rig = Rig().controlled()
        before = rig.control.demand
        assert not override(rig, chan5=1900)
        assert rig.control.demand is before
        assert not rig.said("800..2200")

    def test_what_is_no_pulse_is_reported_once_and_the_rest_counts(self) -> None:
        rig = Rig().controlled()
        assert override(rig, chan3=1900, chan5=700)
        assert override(rig, chan3=1900, chan5=700)
        assert rig.control.requests_motion()
        assert sum("800..2200" in text for _, text in rig.texts) == 1

    def test_a_channel_counts_for_as_long_as_a_demand(self) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).controlled()
        assert override(rig, chan1=1700, chan3=1900)
        rig.now += 0.5
        assert override(rig, chan1=1700)
        assert rig.control.demand is not None
        assert rig.control.demand.throttle == 1.0
        rig.now += 0.1
        assert override(rig, chan1=1700)
        assert rig.control.demand is not None
        assert rig.control.demand.throttle is None


def test_a_clash_forgets_the_demand_and_the_stick_at_rest() -> None:
    rig = Rig().controlled()
    assert rig.control.neutral_seen
    rig.control.hear(rig.received(build_manual_control(AHEAD, 1))._replace(clash=True), rig.now)
    assert not rig.control.neutral_seen
    assert rig.control.demand is None
    assert not rig.stick(NEUTRAL)
    rig.now += 0.8
    assert rig.stick(NEUTRAL)


def test_the_presence_of_another_program_is_not_the_drivers() -> None:
    rig = Rig().controlled()
    rig.control.hear(rig.received(BEAT)._replace(numbering=2), rig.now)
    message = RoverOperatorPresence(1, 1, 0, 0, 9, 1, 0, 1)
    rig.control.handle_operator_presence(rig.received(message)._replace(numbering=2), message, rig.now)
    assert not rig.control.presence.known


def test_the_mode_is_not_its_business() -> None:
    """Whose demand counts is the same in each mode; what it may do is not."""
    rig = Rig().armed()
    rig.safety.choose_mode(Mode.HOLD, rig.now)
    assert rig.stick(AHEAD)
    assert rig.control.requests_motion()
