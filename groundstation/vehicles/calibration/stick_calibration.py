"""Calibration of the RC sticks: the ends and the centre of each channel, as RC_CHANNELS shows them.

ArduPilot has no command for it. A ground station watches the channels while the operator moves the sticks, and sets
RCn_MIN, RCn_TRIM and RCn_MAX (https://ardupilot.org/rover/docs/common-radio-control-calibration.html). In an armed
vehicle RC_CHANNELS may be a ground station's demand, and the sticks may drive: it must be disarmed.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from dialects import messages as m
from groundstation.views.doctor import ParamFix, StickRow

CHANNELS = 16
"""Channels that have parameters."""

PULSES = range(800, 2201)
"""us that RCn_MIN and RCn_MAX allow; RC_CHANNELS has 0 and 65535 for channels that are not there."""

LEAST_TRAVEL = 300
"""us between the ends of a channel that was moved; what moves less keeps its values."""

RATE = 10.0
"""Hz of RC_CHANNELS while it runs: an end that is held for 0.2 s is seen."""


class Travel(msgspec.Struct, frozen=True):
    """Where a channel has been, us."""

    low: int
    high: int
    now: int

    @property
    def moved(self) -> bool:
        """It counts."""
        return self.high - self.low >= LEAST_TRAVEL

    def extended(self, pulse: int) -> Travel:
        """Return the same with one more pulse."""
        return Travel(min(self.low, pulse), max(self.high, pulse), pulse)


class StickCalibration:
    """The channels of one vehicle."""

    def __init__(self) -> None:
        self.running = False
        self._travels: dict[int, Travel] = {}

    def begin(self) -> None:
        """Watch from now on."""
        self.running, self._travels = True, {}

    def end(self) -> None:
        """Watch no more."""
        self.running = False

    def receive(self, message: m.Message) -> None:
        """Handle an RC_CHANNELS."""
        if not self.running or not isinstance(message, m.RcChannels):
            return
        for channel in range(1, CHANNELS + 1):
            pulse = getattr(message, f"chan{channel}_raw")
            if pulse in PULSES:
                self._travels[channel] = self._travels.get(channel, Travel(pulse, pulse, pulse)).extended(pulse)

    @property
    def rows(self) -> tuple[StickRow, ...]:
        """The channels that are there."""
        return tuple(
            StickRow(channel, travel.low, travel.high, travel.now, travel.moved)
            for channel, travel in sorted(self._travels.items())
        )

    @property
    def moved(self) -> tuple[int, ...]:
        """The channels that count."""
        return tuple(row.channel for row in self.rows if row.moved)

    @property
    def values(self) -> dict[str, float]:
        """Parameter -> its new value, of the channels that count. The centre is where the stick is now."""
        return {
            f"RC{channel}_{name}": float(value)
            for channel, travel in sorted(self._travels.items())
            if travel.moved
            for name, value in (("MIN", travel.low), ("TRIM", travel.now), ("MAX", travel.high))
        }

    def changes(self, values: Mapping[str, float]) -> tuple[ParamFix, ...]:
        """Return what to set; `values` are those of the vehicle now."""
        return tuple(
            ParamFix(name, values[name], value)
            for name, value in self.values.items()
            if name in values and values[name] != value
        )

    def unread(self, values: Mapping[str, float]) -> tuple[str, ...]:
        """Return the parameters whose present value is not known."""
        return tuple(name for name in self.values if name not in values)
