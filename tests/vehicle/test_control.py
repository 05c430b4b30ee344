"""Whose demand counts: bad inputs 31 to 42 of the design, and the neutral-first interlock."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.axes import Axes, manual_control
from dialects.enums import Command, Limit, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, OTHER, Bench, said


def override(**channels: int) -> m.RcChannelsOverride:
    """RC_CHANNELS_OVERRIDE as `chan3=1600`; every other channel says "ignore"."""
    raw = {f"chan{number}_raw": m.UINT16_MAX for number in range(1, 19)}
    raw |= {f"{name}_raw": value for name, value in channels.items()}
    return m.RcChannelsOverride(target_system=1, target_component=1, **raw)


def axes(**raw: int) -> m.ManualControl:
    """MANUAL_CONTROL with raw axis values."""
    return m.ManualControl(target=1, **({"x": 0, "y": 0, "z": 0, "r": 0, "buttons": 0} | raw))


def test_a_demand_acts_before_the_next_cycle() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(0.1, NEUTRAL)
    bench.now += 0.005  # between two cycles
    bench.stick(AHEAD)
    assert bench.turning


@pytest.mark.parametrize("target", [0, 2, 255])
def test_31_for_another_system_is_ignored(target: int) -> None:
    bench = Bench()
    bench.drive()
    bench.wait(1.2)
    assert not bench.turning
    bench.stick(NEUTRAL, target=target)
    for _ in range(5):
        bench.stick(AHEAD, target=target)
        bench.wait(CYCLE)
        assert not bench.turning


def test_32_of_another_ground_station_is_ignored_counted_and_said_once() -> None:
    bench = Bench()
    bench.drive()
    bench.texts.clear()
    for _ in range(5):
        bench.wait(0.1, AHEAD)
        bench.stick(Axes(throttle=-1.0), system=OTHER)
    assert bench.throttles == (1.0, 1.0)
    assert bench.texts == [f"Demand of GCS {OTHER} ignored: GCS {DRIVER} is in control"]


def test_a_peer_that_has_shown_no_heartbeat_is_ignored() -> None:
    bench = Bench()
    bench.arm()
    bench.say(manual_control(NEUTRAL, 1), introduced=False)
    bench.say(manual_control(AHEAD, 1), introduced=False)
    bench.wait(CYCLE)
    assert not bench.turning


def test_33_an_axis_that_is_off_is_neutral() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.say(axes(x=m.INVALID_AXIS, r=500))
        bench.wait(0.04)
    assert bench.throttles == pytest.approx((0.4845, -0.4845), abs=1e-3)


@pytest.mark.parametrize("wild", [5000, -32768, 1001, -1001])
def test_34_an_axis_out_of_range_is_neutral_and_not_clamped(wild: int) -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.say(axes(x=wild, r=0))
        bench.wait(0.04)
    assert not bench.turning


def test_a_frame_without_any_valid_axis_is_no_demand() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(30):
        bench.say(axes(x=m.INVALID_AXIS, r=m.INVALID_AXIS))
        bench.wait(0.04)
    assert not bench.turning  # stale
    assert said(bench, "manual control lost")


def test_an_invalid_axis_is_no_stick_at_rest() -> None:
    bench = Bench()
    bench.arm()
    bench.say(axes(x=m.INVALID_AXIS, r=0))
    bench.wait(0.2, AHEAD)
    assert not bench.turning


def test_35_full_throttle_from_the_first_frame_waits_for_neutral() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(1.0, AHEAD)
    assert not bench.turning
    assert bench.newest(m.RoverDriveStatus).limits & Limit.NEUTRAL_FIRST
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.1, AHEAD)
    assert bench.turning


def test_36_a_replayed_frame_does_not_keep_the_rover_going() -> None:
    bench = Bench()
    bench.drive()
    bench.say(manual_control(AHEAD, 1), sequence=77)
    for _ in range(50):
        bench.wait(0.04)
        bench.say(manual_control(AHEAD, 1), sequence=77)
    assert not bench.turning


def test_37_of_two_ground_stations_only_the_owner_drives() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.wait(0.04)
        bench.stick(AHEAD)
        bench.stick(Axes(throttle=-1), system=OTHER)
        assert min(bench.throttles) > 0.5


def test_38_one_frame_a_second_never_runs_on() -> None:
    bench = Bench()
    bench.drive()
    moving = 0
    for _ in range(5):
        bench.wait(0.94)
        assert not bench.turning
        bench.stick(AHEAD)
        moving += bench.turning
    assert moving == 0  # what went stale while driving begins with neutral


def test_39_accessory_axes_and_buttons_do_nothing() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(0.1, NEUTRAL)
    bench.say(axes(y=1000, z=1000, buttons=0xFFFF, buttons2=0xFFFF, s=1000, t=1000, aux1=1000))
    bench.wait(0.1)
    assert not bench.turning
    assert bench.armed


def test_40_a_demand_while_disarmed_or_stopped_gives_nothing() -> None:
    bench = Bench()
    bench.heartbeat()
    bench.wait(0.2, NEUTRAL)
    bench.wait(0.5, AHEAD)
    assert not bench.turning
    bench.drive()
    bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
    assert not bench.turning
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.5, AHEAD)
    assert not bench.turning


def test_41_full_ahead_to_full_reverse_goes_through_zero_in_time() -> None:
    bench = Bench(MOT_REV_DELAY=0.2)
    bench.drive()
    seen = []
    for _ in range(60):
        bench.wait(CYCLE, Axes(throttle=-1.0))
        seen.append(bench.throttles[0])
    assert seen[0] >= 0.9
    assert seen.count(0.0) >= 9  # 0.2 s at zero
    assert seen[-1] == -1.0
    assert max(abs(new - old) for new, old in zip(seen[1:], seen, strict=False)) <= 0.0501
    assert any(message.limits & Limit.REVERSE_DELAY for message in bench.all(m.RoverDriveStatus))


def test_a_small_demand_is_neutral() -> None:
    bench = Bench()
    bench.arm()
    bench.say(axes(x=20, r=-20))  # within MAN_DEADBAND: a stick at rest
    bench.wait(0.2, AHEAD)
    assert bench.turning


class TestOverride:
    """42: RC_CHANNELS_OVERRIDE, channel by channel."""

    def armed(self) -> Bench:
        bench = Bench()
        bench.arm()
        return bench

    def repeat(self, bench: Bench, seconds: float = 1.0, **channels: int) -> None:
        for _ in range(round(seconds / 0.1)):
            bench.say(override(**channels))
            bench.wait(0.1)

    def test_it_drives_as_mavproxy_types_it(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan3=1500)
        self.repeat(bench, chan3=1900)
        assert bench.throttles == (1.0, 1.0)
        channels = bench.newest(m.RcChannels)
        assert (channels.chan3_raw, channels.chan2_raw) == (1900, m.UINT16_MAX)

    def test_steering_is_channel_1(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan1=1500, chan3=1500)
        self.repeat(bench, chan1=1715, chan3=1500)
        assert bench.throttles == pytest.approx((0.4845, -0.4845), abs=1e-3)

    def test_neutral_comes_first_here_too(self) -> None:
        bench = self.armed()
        self.repeat(bench, chan1=1500, chan3=1900)
        assert not bench.turning

    def test_dead_zone(self) -> None:
        bench = self.armed()
        self.repeat(bench, chan1=1470, chan3=1530)
        assert not bench.turning

    def test_giving_back_is_neutral_but_no_stick_at_rest(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan3=1500)
        self.repeat(bench, chan3=1700)
        assert bench.turning
        self.repeat(bench, chan1=0, chan3=0)
        assert not bench.turning

    def test_ignored_channels_refresh_nothing(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan3=1500)
        self.repeat(bench, chan3=1700)
        assert bench.turning
        self.repeat(bench)  # all 65535
        assert not bench.turning

    def test_a_channel_that_moves_does_not_live_on_the_other_ones_repeats(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan1=1500, chan3=1500)
        self.repeat(bench, chan3=1700)
        before = bench.throttles[0]
        assert before > 0.4
        self.repeat(bench, 0.5, chan1=1500)  # 0.6 s after the last throttle
        assert bench.throttles[0] < before
        self.repeat(bench, 0.5, chan1=1500)
        assert not bench.turning

    @pytest.mark.parametrize("pulse", [700, 799, 2201, 65534, 1])
    def test_what_is_no_pulse_is_ignored(self, pulse: int) -> None:
        bench = self.armed()
        self.repeat(bench, 0.2, chan3=1500)
        self.repeat(bench, chan3=pulse)
        assert not bench.turning

    def test_channels_9_to_18_ignore_zero_and_give_back_65534(self) -> None:
        bench = self.armed()
        self.repeat(bench, 0.6, chan3=1500, chan9=1600)
        self.repeat(bench, 0.6, chan3=1500, chan9=0)
        assert bench.newest(m.RcChannels).chan9_raw == 1600
        self.repeat(bench, 0.6, chan3=1500, chan9=65534)
        assert bench.newest(m.RcChannels).chan9_raw == m.UINT16_MAX

    def test_of_another_ground_station_it_is_ignored(self) -> None:
        bench = self.armed()
        bench.say(override(chan3=1500), OTHER)
        bench.say(override(chan3=1900), OTHER)
        bench.wait(CYCLE)
        assert not bench.turning


class TestPresence:
    """ROVER_OPERATOR_PRESENCE: is there a person, and is the demand new?"""

    def say(self, bench: Bench, echo: int, age: int = 0, session: int = 1, flags: int = 1) -> None:
        bench.say(m.RoverOperatorPresence(1, 1, 0, echo, session, 1, age, flags))

    def drive(self, bench: Bench, seconds: float, axes: Axes, delay: float = 0.1, age: int = 0) -> None:
        """20 Hz of a driver who has seen the vehicle's words of `delay` s ago."""
        for _ in range(round(seconds / 0.05)):
            self.say(bench, int((bench.now - 100.0 - delay) * 1000), age=age)
            bench.stick(axes)
            bench.wait(0.05)

    def going(self) -> Bench:
        bench = Bench()
        bench.wait(2.0)
        bench.arm()
        self.drive(bench, 0.2, NEUTRAL)
        self.drive(bench, 1.0, AHEAD)
        assert bench.turning
        return bench

    def test_demands_that_are_old_when_they_arrive_are_refused(self) -> None:
        bench = self.going()
        self.drive(bench, 1.2, AHEAD, delay=0.6)
        assert not bench.turning
        assert said(bench, "they are old when they arrive")

    def test_an_echo_of_a_former_boot_is_refused(self) -> None:
        bench = self.going()
        for _ in range(30):
            self.say(bench, 0x7FFFFFFF)
            bench.stick(AHEAD)
            bench.wait(0.05)
        assert not bench.turning

    def test_no_echo_yet_is_no_reason(self) -> None:
        bench = self.going()
        for _ in range(20):
            self.say(bench, 0)
            bench.stick(AHEAD)
            bench.wait(0.05)
        assert bench.turning

    def test_a_key_that_nobody_touches_stops_after_the_timeout(self) -> None:
        bench = self.going()
        self.drive(bench, 0.5, AHEAD, age=9_000)
        assert bench.turning
        self.drive(bench, 0.5, AHEAD, age=10_200)
        assert not bench.turning
        assert said(bench, "no sign of the operator: stopping")
        self.drive(bench, 2.0, AHEAD, age=12_000)
        assert bench.mode is Mode.HOLD

    def test_a_new_key_press_is_the_operator_again_and_neutral_comes_first(self) -> None:
        bench = self.going()
        self.drive(bench, 0.5, AHEAD, age=10_200)
        assert not bench.turning
        self.drive(bench, 0.5, AHEAD)
        assert not bench.turning
        self.drive(bench, 0.1, NEUTRAL)
        self.drive(bench, 0.1, AHEAD)
        assert bench.turning

    def test_a_lost_input_device_stops_at_once(self) -> None:
        bench = self.going()
        for _ in range(10):
            self.say(bench, 0, flags=4)
            bench.stick(AHEAD)
            bench.wait(0.05)
        assert not bench.turning

    def test_a_new_session_begins_with_neutral(self) -> None:
        bench = self.going()
        for _ in range(10):
            self.say(bench, 0, session=2)
            bench.stick(AHEAD)
            bench.wait(0.05)
        assert not bench.turning

    def test_of_others_it_says_nothing(self) -> None:
        bench = self.going()
        bench.say(m.RoverOperatorPresence(1, 1, 0, 1, 9, 1, 65535, 4), OTHER)
        self.drive(bench, 0.2, AHEAD)
        assert bench.turning


class TestOwner:
    """Who is in control."""

    def owner(self, bench: Bench) -> int:
        bench.wait(1.5, NEUTRAL)
        return bench.newest(m.ControlStatus).gcs_main

    def ask(self, bench: Bench, system: int, action: float = 1, takeover: float = 0) -> Result | None:
        return bench.command(Command.REQUEST_OPERATOR_CONTROL, action, takeover, 10, system, system=system)

    def test_nobody_at_boot_then_who_arms(self) -> None:
        bench = Bench()
        assert self.owner(bench) == 0
        bench.arm()
        assert self.owner(bench) == DRIVER

    def test_nobody_at_boot_then_who_asks(self) -> None:
        bench = Bench()
        assert self.ask(bench, OTHER) is Result.ACCEPTED
        bench.wait(0.1)
        assert bench.newest(m.ControlStatus).gcs_main == OTHER
        assert bench.arm() is Result.FAILED
        assert said(bench, f"PreArm: GCS {OTHER} is in control")

    def test_a_request_is_refused_and_passed_on_to_the_owner(self) -> None:
        bench = Bench()
        bench.drive()
        assert self.ask(bench, OTHER) is Result.FAILED
        passed = bench.newest(m.CommandLong)
        assert (passed.target_system, passed.command, passed.param4) == (
            DRIVER,
            Command.REQUEST_OPERATOR_CONTROL,
            OTHER,
        )
        self.ask(bench, OTHER)
        assert len(bench.all(m.CommandLong)) == 1  # a repeat does not nag
        assert bench.turning

    def test_takeover_that_the_owner_allowed_needs_neutral_first(self) -> None:
        bench = Bench()
        bench.drive()
        assert self.ask(bench, DRIVER, takeover=1) is Result.ACCEPTED
        assert self.ask(bench, OTHER) is Result.ACCEPTED
        bench.wait(0.6, AHEAD, system=OTHER)
        assert not bench.turning
        bench.wait(0.1, NEUTRAL, system=OTHER)
        bench.wait(0.1, AHEAD, system=OTHER)
        assert bench.turning
        assert said(bench, f"GCS {OTHER} is in control")

    def test_the_owner_may_ask_again_while_it_drives(self) -> None:
        bench = Bench()
        bench.drive()
        assert self.ask(bench, DRIVER) is Result.ACCEPTED
        bench.wait(0.2, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_who_has_shown_no_heartbeat_cannot_ask(self) -> None:
        bench = Bench()
        request = Command.REQUEST_OPERATOR_CONTROL
        assert bench.command(request, 1, 0, 10, 0, introduced=False) is Result.FAILED
        bench.wait(1.1)
        assert bench.newest(m.ControlStatus).gcs_main == 0

    def test_a_silent_owner_can_be_relieved(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(4.9)
        assert self.ask(bench, OTHER) is Result.FAILED
        bench.wait(1.0)
        assert self.ask(bench, OTHER) is Result.ACCEPTED

    def test_the_owner_gives_up_and_the_rover_holds(self) -> None:
        bench = Bench()
        bench.drive()
        assert self.ask(bench, DRIVER, action=0) is Result.ACCEPTED
        bench.wait(0.6)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert bench.newest(m.ControlStatus).gcs_main == 0

    def test_nobody_else_can_give_it_up(self) -> None:
        bench = Bench()
        bench.drive()
        assert self.ask(bench, OTHER, action=0) is Result.FAILED
        assert bench.turning

    @pytest.mark.parametrize(
        "params", [(2, 0, 10, 0), (0.5, 0, 10, 0), (1, 2, 10, 0), (1, 0, 10, 77), (float("nan"), 0, 0, 0)]
    )
    def test_nonsense_is_denied(self, params: tuple[float, ...]) -> None:
        bench = Bench()
        assert bench.command(Command.REQUEST_OPERATOR_CONTROL, *params) is Result.DENIED

    def test_a_fixed_ground_station_is_the_only_one(self) -> None:
        bench = Bench(MAV_GCS_SYSID=OTHER)
        assert bench.arm() is Result.FAILED
        assert self.ask(bench, DRIVER) is Result.FAILED
        assert bench.arm(OTHER) is Result.ACCEPTED

    def test_an_owner_that_is_silent_while_disarmed_is_free_again(self) -> None:
        bench = Bench()
        self.ask(bench, DRIVER)
        bench.wait(5.5)
        assert bench.newest(m.ControlStatus).gcs_main == 0
        assert said(bench, "Nobody is in control")
