"""RC_CHANNELS_OVERRIDE, channel by channel: bad input 42."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from tests.vehicle.bench import CYCLE, DRIVER, OTHER, Bench, said


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
