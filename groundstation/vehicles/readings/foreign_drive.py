"""How a vehicle without our dialect drives: the demand that it obeys, and its motor outputs.

ArduPilot tells both as pulses (RC_CHANNELS, SERVO_OUTPUT_RAW), whose meaning its parameters say. PX4 tells its outputs
in ACTUATOR_OUTPUT_STATUS, in units that depend on the driver; only those of -1..1 are known here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from dialects import messages as m
from dialects.enums import Autopilot
from dialects.messages import UINT16_MAX
from groundstation.snapshot import OutputView
from groundstation.vehicles.readings.outputs import PARAMS, servo_names
from groundstation.vehicles.readings.values import within

NO_PULSE = (0, UINT16_MAX)
"""An output or a channel that is off or not known; else 1000 to 2000 us."""

SUFFIXES = ("MIN", "TRIM", "MAX", "REVERSED")


def pulse_params(channel: str) -> tuple[str, ...]:
    """Return the parameters of a channel, e.g. "SERVO1", "RC3"."""
    return tuple(f"{channel}_{suffix}" for suffix in SUFFIXES)


def pulse_fraction(pulse: int, channel: str, values: Mapping[str, float]) -> float | None:
    """Return what a pulse in us means, -1..1; None for no pulse, and while a parameter of the channel is not known."""
    known = [values.get(name) for name in pulse_params(channel)]
    low, trim, high, reverse = known
    if pulse in NO_PULSE or low is None or trim is None or high is None or reverse is None:
        return None
    span = high - trim if pulse >= trim else trim - low
    if span <= 0:  # the parameters make no sense
        return None
    return within((pulse - trim) / span * (-1 if reverse else 1))


RC_MAP = {"throttle": "RCMAP_THROTTLE", "steering": "RCMAP_ROLL"}
"""Axis -> the parameter with the number of its RC channel. A rover steers by the roll channel."""

FRESH = 3.0
"""s for which a report counts: three periods of the slowest stream, 1 Hz."""

MAX_ACTUATORS = 4
DRIVING = 2
"""Outputs of a rover that are shown from the start. PX4 reports 16, of which further ones are shown once they move."""

Outputs = tuple[float, ...]


class ForeignDrive:
    """The newest reports of one vehicle; `values` are its known parameters."""

    def __init__(self) -> None:
        self.values: Mapping[str, float] = {}
        self._rc: m.RcChannels | None = None
        self._servos: m.ServoOutputRaw | None = None
        self._actuators: m.ActuatorOutputStatus | None = None
        self._actuator_count = DRIVING
        self._times: dict[str, float] = {}

    def handle_rc(self, message: m.RcChannels, now: float) -> None:
        """Handle an RC_CHANNELS."""
        self._rc, self._times["rc"] = message, now

    def handle_servos(self, message: m.ServoOutputRaw, now: float) -> None:
        """Handle a SERVO_OUTPUT_RAW."""
        self._servos, self._times["outputs"] = message, now

    def handle_actuators(self, message: m.ActuatorOutputStatus, now: float) -> None:
        """Handle an ACTUATOR_OUTPUT_STATUS."""
        if self._actuators is not None:
            pairs = zip(message.actuator[:MAX_ACTUATORS], self._actuators.actuator, strict=False)
            moved = [number for number, (value, before) in enumerate(pairs, 1) if value != before]
            self._actuator_count = max(self._actuator_count, *moved, 0)
        self._actuators, self._times["outputs"] = message, now

    def demand(self, now: float) -> tuple[float, float] | None:
        """Return throttle and steering as the vehicle obeys them, -1..1; None unless both are known."""
        if self._rc is None or now - self._times["rc"] > FRESH:
            return None
        throttle, steering = (self._axis(self._rc, name) for name in RC_MAP.values())
        return None if throttle is None or steering is None else (throttle, steering)

    def outputs(self, now: float) -> tuple[OutputView, ...]:
        """Return the motor outputs."""
        if now - self._times.get("outputs", -math.inf) > FRESH:
            return ()
        if self._actuators is not None:
            return self._actuator_views(self._actuators)
        return tuple(
            OutputView(name=name, value=pulse_fraction(pulse, f"SERVO{channel}", self.values))
            for channel, name, pulse in self._pulses()
            if pulse not in NO_PULSE
        )

    @property
    def raw_outputs(self) -> Outputs:
        """The outputs as reported, to see that one has changed."""
        if self._actuators is not None:
            return tuple(self._actuators.actuator[:MAX_ACTUATORS])
        return tuple(float(pulse) for _, _, pulse in self._pulses())

    def _axis(self, rc: m.RcChannels, name: str) -> float | None:
        number = self.values.get(name)
        if number is None or not 1 <= number <= 18:
            return None
        return pulse_fraction(getattr(rc, f"chan{number:.0f}_raw"), f"RC{number:.0f}", self.values)

    def _pulses(self) -> Iterable[tuple[int, str, int]]:
        names = servo_names(self.values)
        return ((channel, name, getattr(self._servos, f"servo{channel}_raw", 0)) for channel, name in names.items())

    def _actuator_views(self, message: m.ActuatorOutputStatus) -> tuple[OutputView, ...]:
        values = message.actuator[: min(self._actuator_count, message.active)]
        return tuple(
            OutputView(name=f"output {number}", value=value if abs(value) <= 1.0 else None)
            for number, value in enumerate(values, 1)
        )


def drive_params(autopilot: int, values: Mapping[str, float]) -> Iterable[str]:
    """Yield the parameters that tell demand and outputs; more of them once those that name the channels are known."""
    if autopilot != Autopilot.ARDUPILOT:
        return
    yield from PARAMS.values()
    yield from RC_MAP.values()
    for channel in servo_names(values):
        yield from pulse_params(f"SERVO{channel}")
    for name in RC_MAP.values():
        if name in values:
            yield from pulse_params(f"RC{values[name]:.0f}")
