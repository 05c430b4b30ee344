"""Demands: RC_CHANNELS_OVERRIDE channel by channel (bad input 42), MANUAL_CONTROL, and when they are neutral."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from dialects.messages import INVALID_AXIS, UINT16_MAX, ManualControl, RcChannelsOverride
from tests.rows import each_row
from tests.vehicle.bench import CYCLE, DRIVER, OTHER, Bench, said
from vehicle.drive.demand import Demand, RcOverride, deflection, from_manual_control, pulse


def override(**channels: int) -> m.RcChannelsOverride:
    """Return RC_CHANNELS_OVERRIDE with channels as `chan3=1600`; all others are ignored."""
    raw = {f"chan{number}_raw": m.UINT16_MAX for number in range(1, 19)}
    raw |= {f"{name}_raw": value for name, value in channels.items()}
    return m.RcChannelsOverride(target_system=1, target_component=1, **raw)


def armed() -> Bench:
    bench = Bench()
    bench.arm()
    return bench


def repeat(bench: Bench, seconds: float = 1.0, **channels: int) -> None:
    for _ in range(round(seconds / 0.1)):
        bench.say(override(**channels))
        bench.wait(0.1)


def test_mavproxys_rc_command_drives() -> None:
    bench = armed()
    repeat(bench, 0.2, chan3=1500)
    repeat(bench, chan3=1900)
    assert bench.throttles == (1.0, 1.0)
    channels = bench.newest(m.RcChannels)
    assert (channels.chan3_raw, channels.chan2_raw) == (1900, m.UINT16_MAX)
    assert channels.chancount == 3


def test_steering_is_channel_1() -> None:
    bench = armed()
    repeat(bench, 0.2, chan1=1500, chan3=1500)
    repeat(bench, chan1=1715, chan3=1500)
    assert bench.throttles == pytest.approx((0.4845, -0.4845), abs=1e-3)


def test_an_override_requires_neutral_first() -> None:
    bench = armed()
    repeat(bench, chan1=1500, chan3=1900)
    assert not bench.turning


def test_dead_zone() -> None:
    bench = armed()
    repeat(bench, chan1=1470, chan3=1530)
    assert not bench.turning


def test_42_a_released_channel_is_neutral_but_no_stick_at_rest() -> None:
    bench = armed()
    repeat(bench, 0.2, chan3=1500)
    repeat(bench, chan3=1700)
    assert bench.turning
    repeat(bench, chan1=0, chan3=0)
    assert not bench.turning


def test_ignored_channels_refresh_nothing() -> None:
    bench = armed()
    repeat(bench, 0.2, chan3=1500)
    repeat(bench, chan3=1700)
    assert bench.turning
    repeat(bench)  # all 65535
    assert not bench.turning


def test_a_throttle_override_expires_while_steering_is_repeated() -> None:
    bench = armed()
    repeat(bench, 0.2, chan1=1500, chan3=1500)
    repeat(bench, chan1=1600, chan3=1700)
    before = bench.throttles[0]
    assert before > 0.4
    repeat(bench, 0.5, chan1=1600)  # 0.6 s after the last throttle
    assert bench.throttles[0] < before
    repeat(bench, 0.5, chan1=1600)
    assert not bench.turning


@pytest.mark.parametrize("pulse", [700, 799, 2201, 65534, 1])
def test_42_an_invalid_pulse_is_ignored(pulse: int) -> None:
    bench = armed()
    repeat(bench, 0.2, chan3=1500)
    assert not said(bench, "channels outside")
    repeat(bench, chan3=pulse)
    assert not bench.turning
    assert bench.texts.count(f"GCS {DRIVER}: channels outside 800..2200 us are ignored") == 1


def test_42_channels_9_to_18_ignore_zero_and_release_at_65534() -> None:
    bench = armed()
    repeat(bench, 0.6, chan3=1500, chan9=1600)
    repeat(bench, 0.6, chan3=1500, chan9=0)
    assert bench.newest(m.RcChannels).chan9_raw == 1600
    repeat(bench, 0.6, chan3=1500, chan9=65534)
    assert bench.newest(m.RcChannels).chan9_raw == m.UINT16_MAX


def test_an_override_from_another_ground_station_is_ignored() -> None:
    bench = armed()
    bench.say(override(chan3=1500), OTHER)
    bench.say(override(chan3=1900), OTHER)
    bench.wait(CYCLE)
    assert not bench.turning


def test_without_a_stick_or_an_override_there_are_no_channels() -> None:
    bench = armed()
    bench.command(Command.REQUEST_MESSAGE, m.RcChannels.id)
    channels = bench.newest(m.RcChannels)
    assert (channels.chancount, channels.chan1_raw, channels.chan3_raw) == (0, m.UINT16_MAX, m.UINT16_MAX)


def demand(throttle: float | None = 0.0, steering: float | None = 0.0, sideways: float | None = None) -> Demand:
    return Demand(throttle, steering, 1.0, 255, 7, sideways)


@pytest.mark.parametrize("axis", ["throttle", "steering", "sideways"])
@pytest.mark.parametrize("sign", [1, -1])
def test_each_axis_moves_beyond_the_dead_band_either_way(axis: str, sign: int) -> None:
    at_the_edge, beyond = demand(**{axis: sign * 0.25}), demand(**{axis: sign * 0.26})
    assert at_the_edge.is_neutral(0.25)
    assert not at_the_edge.requests_motion(0.25)
    assert not beyond.is_neutral(0.25)
    assert beyond.requests_motion(0.25)


@pytest.mark.parametrize("axis", ["throttle", "steering"])
def test_an_axis_without_a_demand_is_still_but_no_stick_at_rest(axis: str) -> None:
    missing = demand(**{axis: None})
    assert not missing.is_neutral(0.25)
    assert not missing.requests_motion(0.25)
    assert not missing.requests_motion(0.0)
    assert demand().is_neutral(0.0)


def test_a_drivers_demand_is_not_direct_and_has_no_sideways_axis() -> None:
    made = Demand(0.5, 0.5, 1.0, 255, 7)
    assert not made.direct
    assert made.sideways is None


class TestManualControl:
    def parse(self, *, sideways: bool = False, **axes: int) -> Demand | None:
        message = ManualControl(
            target=1, **({"x": INVALID_AXIS, "y": 0, "z": 0, "r": INVALID_AXIS, "buttons": 0} | axes)
        )
        return from_manual_control(message, 255, 7, 1.0, sideways=sideways)

    def test_x_is_throttle_and_r_is_steering(self) -> None:
        assert self.parse(x=500, r=-250) == Demand(0.5, -0.25, 1.0, 255, 7)
        assert self.parse(x=500) == Demand(0.5, None, 1.0, 255, 7)
        assert self.parse(r=500) == Demand(None, 0.5, 1.0, 255, 7)
        assert self.parse() is None

    @pytest.mark.parametrize(("y", "side"), [(1000, 1.0), (-1000, -1.0), (250, 0.25), (1001, None), (-1001, None)])
    def test_y_is_sideways_of_a_vehicle_that_can(self, y: int, side: float | None) -> None:
        assert self.parse(x=0, y=y, sideways=True) == Demand(0.0, None, 1.0, 255, 7, side)
        assert self.parse(x=0, y=y) == Demand(0.0, None, 1.0, 255, 7)
        assert self.parse(y=y, sideways=True) == (None if side is None else Demand(None, None, 1.0, 255, 7, side))
        assert self.parse(y=y) is None

    def test_sideways_is_off_by_default(self) -> None:
        message = ManualControl(target=1, x=0, y=500, z=0, r=0, buttons=0)
        assert from_manual_control(message, 255, 7, 1.0) == Demand(0.0, 0.0, 1.0, 255, 7)


class TestOverride:
    def message(self, **channels: int) -> RcChannelsOverride:
        raw = {f"chan{number}_raw": UINT16_MAX for number in range(1, 19)}
        raw |= {f"{name}_raw": value for name, value in channels.items()}
        return RcChannelsOverride(target_system=1, target_component=1, **raw)

    def test_a_new_one_holds_nothing(self) -> None:
        override = RcOverride()
        assert override.channels == {}
        assert not override.has_invalid_value
        assert override.build_demand(255, 7, 1.0, 0.5) == Demand(None, 0.0, 1.0, 255, 7)

    @pytest.mark.parametrize(
        ("channel", "spoken"), [("chan1", True), ("chan2", False), ("chan3", True), ("chan4", False)]
    )
    @pytest.mark.parametrize("value", [1500, 0])
    def test_it_speaks_of_throttle_or_steering(self, channel: str, spoken: bool, value: int) -> None:
        assert RcOverride().update(self.message(**{channel: value}), 1.0) is spoken

    def test_what_is_no_pulse_speaks_of_nothing(self) -> None:
        assert not RcOverride().update(self.message(chan1=700, chan3=700), 1.0)
        assert RcOverride().update(self.message(chan1=1500, chan3=700), 1.0)

    @each_row(
        ("value", "held", "invalid"),
        [(800, True, False), (2200, True, False), (799, False, True), (2201, False, True), (1, False, True),
         (65533, False, True), (65534, False, True), (65535, False, False), (0, False, False)],
    )  # fmt: skip
    @each_row("number", [1, 8])
    def test_values_of_channels_1_to_8(self, number: int, value: int, held: bool, invalid: bool) -> None:
        override = RcOverride()
        override.update(self.message(**{f"chan{number}": value}), 1.0)
        assert (number in override.channels) is held
        assert override.has_invalid_value is invalid
        override.update(self.message(), 1.0)
        assert not override.has_invalid_value

    @each_row(
        ("value", "held", "invalid"),
        [(800, True, False), (2200, True, False), (799, False, True), (1, False, True), (65533, False, True),
         (65534, False, False), (65535, False, False), (0, False, False)],
    )  # fmt: skip
    @each_row("number", [9, 18])
    def test_values_of_channels_9_to_18(self, number: int, value: int, held: bool, invalid: bool) -> None:
        override = RcOverride()
        override.update(self.message(**{f"chan{number}": value}), 1.0)
        assert (number in override.channels) is held
        assert override.has_invalid_value is invalid

    def test_what_holds_a_channel_and_what_gives_it_back(self) -> None:
        override = RcOverride()
        override.update(self.message(chan1=1600, chan8=1700, chan9=1800, chan18=1900), 1.0)
        assert {number: (each.pulse, each.time) for number, each in override.channels.items()} == {
            1: (1600, 1.0), 8: (1700, 1.0), 9: (1800, 1.0), 18: (1900, 1.0)
        }  # fmt: skip
        override.update(self.message(chan1=65535, chan8=700, chan9=0, chan18=65535), 2.0)  # nothing of it counts
        assert len(override.channels) == 4
        override.update(self.message(chan1=0, chan8=0, chan9=65534, chan18=65534), 3.0)
        assert override.channels == {}
        override.update(self.message(chan1=0), 4.0)  # which was not held
        assert override.channels == {}

    def test_a_channel_counts_up_to_its_time(self) -> None:
        override = RcOverride()
        override.update(self.message(chan1=1900, chan3=1100), 1.0)
        assert override.build_demand(255, 7, 1.5, 0.5) == Demand(-1.0, 1.0, 1.0, 255, 7)
        assert override.build_demand(255, 7, 1.6, 0.5) == Demand(None, 0.0, 1.6, 255, 7)

    def test_the_oldest_channel_that_moves_gives_the_time(self) -> None:
        override = RcOverride()
        override.update(self.message(chan3=1900), 1.0)
        override.update(self.message(chan1=1900), 1.2)
        assert override.build_demand(255, 7, 1.3, 0.5).time == 1.0
        override.update(self.message(chan3=1900), 1.4)
        assert override.build_demand(255, 7, 1.5, 0.5).time == 1.2
        override.update(self.message(chan1=1510), 1.5)  # at rest
        assert override.build_demand(255, 7, 1.6, 0.5).time == 1.4
        override.update(self.message(chan3=1510), 1.6)
        assert override.build_demand(255, 7, 1.7, 0.5).time == 1.7


@each_row(
    ("microseconds", "value"),
    [(1500, 0.0), (1530, 0.0), (1470, 0.0), (1531, 1 / 370), (1469, -1 / 370), (1715, 0.5), (1900, 1.0), (1901, 1.0),
     (1100, -1.0), (800, -1.0), (2200, 1.0)],
)  # fmt: skip
def test_deflection_of_a_pulse(microseconds: int, value: float) -> None:
    assert deflection(microseconds) == value


@pytest.mark.parametrize(
    ("value", "microseconds"), [(0.0, 1500), (1.0, 1900), (-1.0, 1100), (0.5, 1700), (0.001, 1500)]
)
def test_pulse_of_a_deflection(value: float, microseconds: int) -> None:
    assert pulse(value) == microseconds
