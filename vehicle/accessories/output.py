"""One relay or servo: its specification, its target value and repetition, and the driver that outputs it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple

import msgspec

from vehicle.accessories import OFF, Accessory
from vehicle.hardware.error_text import format_error

RETRY_INTERVAL = 1.0
"""s after a failure until the driver is called again."""

Until = Literal["end", "stop", "disarm"]
"""When an accessory returns to its safe value; it stays there until another value is commanded.

end: when the vehicle program ends or is killed.
stop: also at an emergency stop; no other value is accepted until the stop is released.
disarm: also when the vehicle is disarmed or stopped by a failsafe; no other value is accepted meanwhile.
"""


class PulseRange(NamedTuple):
    """Permitted pulses of a servo, us."""

    low: int
    trim: int
    high: int


class AccessorySpec(msgspec.Struct, frozen=True):
    """The specification of one accessory, built from its settings."""

    kind: Literal["relay", "servo"]
    number: int
    make: Callable[[int], Accessory]
    """Opens the driver with a start value. May raise anything."""
    driver: str = "simulated"
    start: int = OFF
    safe: int = OFF
    until: Until = "stop"
    pulses: PulseRange | None = None
    """None for a relay."""
    taken: Sequence[str] = ()
    shared: Mapping[str, str] = msgspec.field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name in texts for the operator."""
        return f"{self.kind} {self.number}"

    def format_value(self, value: int) -> str:
        """Return a value as text for the operator."""
        if self.kind == "relay":
            return "on" if value else "off"
        return f"{value} us" if value else "no pulses"


class RepeatState(msgspec.Struct):
    """A running repetition (DO_REPEAT_RELAY, DO_REPEAT_SERVO): alternates between two values."""

    away: int
    rest: int
    changes_left: int
    """Number of remaining changes; an even number changes to `away` next."""
    period: float
    """s between two changes."""
    due: float
    """Time of the next change."""


class AccessoryOutput:
    """One accessory. Call `update` in each cycle. Never raises, whatever the driver does."""

    def __init__(self, spec: AccessorySpec) -> None:
        self.spec = spec
        self.target = spec.start
        """Value to output."""
        self.actual: int | None = None
        """Value of the hardware; None before it is opened, after it is closed, and if opening failed."""
        self.fault: str | None = None
        """Why the target could not be set, one line."""
        self._accessory: Accessory | None = None
        self._repeat: RepeatState | None = None
        self._retry_due = 0.0

    @property
    def busy(self) -> bool:
        """Whether a repetition runs, or the hardware has not got the target yet."""
        return self._repeat is not None or (self._accessory is not None and self.target != self.actual)

    def open(self) -> None:
        """Open the driver with the start value."""
        self._attempt(self._make, self.spec.start)

    def set_value(self, value: int) -> None:
        """Set the target, and end a repetition."""
        self.target, self._repeat = value, None

    def start_repeat(self, away: int | None, times: int, period: float, now: float) -> None:
        """Start a repetition: change `times` times to another value and back.

        A servo changes from its trim to `away`. A relay, for which `away` is None, changes to the other state.
        """
        if away is None:
            rest = self._repeat.rest if self._repeat else self.target
            away = int(not rest)
        else:
            rest = self.spec.pulses.trim if self.spec.pulses else OFF
        self._repeat = RepeatState(away, rest, 2 * times, period, now)

    def set_safe(self) -> bool:
        """Set the safe value. Returns True if the target was another one or a repetition was running."""
        changed = self.target != self.spec.safe or self._repeat is not None
        self.set_value(self.spec.safe)
        return changed

    def update(self, now: float) -> bool:
        """Advance a repetition and output the target if needed. Returns False if the driver failed."""
        self._advance_repeat(now)
        done = self.target == self.actual and self.fault is None  # after a failure the value is unknown
        if self._accessory is None or done or now < self._retry_due:
            return True
        self.fault = None
        self._attempt(self._accessory.set, self.target)
        if self.fault is not None:
            self._retry_due = now + RETRY_INTERVAL
            return False
        self.actual = self.target
        return True

    def close(self) -> None:
        """Set the safe value, then release the hardware. May be called twice."""
        accessory, self._accessory, self.actual = self._accessory, None, None
        if accessory is not None:
            self.set_safe()
            self._attempt(accessory.set, self.spec.safe)
            self._attempt(accessory.close)

    def _make(self, value: int) -> None:
        self._accessory = self.spec.make(value)
        self.actual = value

    def _attempt(self, step: Callable[..., None], *values: int) -> None:
        try:
            step(*values)
        except Exception as error:  # a driver may raise anything
            self.fault = format_error(error)

    def _advance_repeat(self, now: float) -> None:
        repeat = self._repeat
        if repeat is None or now < repeat.due:
            return
        self.target = repeat.rest if repeat.changes_left % 2 else repeat.away
        repeat.changes_left -= 1
        repeat.due = now + repeat.period
        if not repeat.changes_left:
            self._repeat = None
