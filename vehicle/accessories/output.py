"""One relay or servo: what it may be given, what it is to give, and the accessory that gives it; no protocol."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from vehicle.accessories import OFF, Accessory
from vehicle.hardware.error_text import format_error

RETRY_INTERVAL = 1.0
"""s after a failure until an accessory is tried again."""

Until = Literal["end", "stop", "disarm"]
"""How long an accessory keeps what it was given. Then it gets its safe value, until somebody asks for another again.

end: until the vehicle's program ends, or is killed.
stop: also until an emergency stop, and not before it is released.
disarm: also until the vehicle is disarmed or a failsafe stops it; away from its safe value only while neither holds.
"""


class PulseRange(NamedTuple):
    """What a servo may get, us."""

    low: int
    trim: int
    high: int


@dataclass(frozen=True, slots=True)
class AccessorySpec:
    """One line of the settings, understood."""

    kind: Literal["relay", "servo"]
    number: int
    make: Callable[[int], Accessory]
    """Opens it with a first value. May raise anything."""
    driver: str = "simulated"
    start: int = OFF
    safe: int = OFF
    until: Until = "stop"
    pulses: PulseRange | None = None
    """Of a servo."""
    taken: Sequence[str] = ()
    shared: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """As the driver reads it."""
        return f"{self.kind} {self.number}"

    def format_value(self, value: int) -> str:
        """A value as the driver reads it."""
        if self.kind == "relay":
            return "on" if value else "off"
        return f"{value} us" if value else "no pulses"


@dataclass(slots=True)
class RepeatState:
    """To and fro."""

    away: int
    rest: int
    left: int
    """Changes to come: an even number goes away next."""
    period: float
    """s between two changes."""
    due: float


class AccessoryOutput:
    """`step` each cycle; the rest at any moment. It never raises, whatever the accessory does."""

    def __init__(self, output: AccessorySpec) -> None:
        self.spec = output
        self.target = output.start
        self.actual: int | None = None
        """What the hardware has; None before it is opened, after it is closed, and where it did not open."""
        self.fault: str | None = None
        """Why it does not do what is wanted, one line."""
        self._accessory: Accessory | None = None
        self._repeat: RepeatState | None = None
        self._retry_due = 0.0

    def open(self) -> None:
        """With its first value."""
        self._attempt(self._make, self.spec.start)

    def set_value(self, value: int) -> None:
        """From now on, in place of whatever was asked before."""
        self.target, self._repeat = value, None

    def start_repeat(self, away: int | None, times: int, period: float, now: float) -> None:
        """Go away and come back so many times: a servo from its trim to `away`, a relay, where `away` is None, to the
        other state and back.
        """
        if away is None:
            rest = self._repeat.rest if self._repeat else self.target
            away = int(not rest)
        else:
            rest = self.spec.pulses.trim if self.spec.pulses else OFF
        self._repeat = RepeatState(away, rest, 2 * times, period, now)

    def set_safe(self) -> bool:
        """Its safe value. True where that ends anything."""
        ends = self.target != self.spec.safe or self._repeat is not None
        self.set_value(self.spec.safe)
        return ends

    def update(self, now: float) -> bool:
        """Let the hardware have what is wanted at this moment. False where it did not take it."""
        self._go_on(now)
        done = self.target == self.actual and self.fault is None  # after a failure nobody knows what it has
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
        """Its safe value, then the hardware is let go. May come twice."""
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
        except Exception as error:  # anybody's driver may raise anything
            self.fault = format_error(error)

    def _go_on(self, now: float) -> None:
        repeat = self._repeat
        if repeat is None or now < repeat.due:
            return
        self.target = repeat.rest if repeat.left % 2 else repeat.away
        repeat.left -= 1
        repeat.due = now + repeat.period
        if not repeat.left:
            self._repeat = None
