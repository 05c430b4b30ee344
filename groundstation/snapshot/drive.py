"""Parts of the snapshot for the Drive screen: key to motor, stop bounds, health, mission. Units as in the snapshot."""

from __future__ import annotations

import msgspec


class StopBound(msgspec.Struct, frozen=True, array_like=True):
    """One thing that stops the vehicle, or changes who drives it, and how near it is.

    Only what the vehicle's own parameters, or this program, promise: what was not read is None, never a default.
    """

    name: str
    """What is missing or wrong then, e.g. "no command"."""
    does: str
    """What follows, e.g. "neutral", "HOLD"."""
    source: str
    """The parameter that says so, or the part of this program."""
    bound: float | None = None
    """Limit in `unit`; 0: at once; None: not known."""
    value: float | None = None
    """Where it stands now; None: not known, or it does not count at present."""
    never: bool = False
    """Switched off."""
    unit: str = "s"
    """"s", "deg", or "V": a voltage is a lower limit, the others are upper ones."""
    estimated: bool = False
    """`value` is an estimate of this station: the vehicle does not report it."""

    @property
    def share(self) -> float | None:
        """How full the bar is, 0..1; None: there is nothing to fill."""
        if self.never or not self.bound or self.value is None:
            return None
        ratio = self.value / self.bound if self.unit != "V" else self.bound / max(self.value, 1e-3)
        return max(0.0, min(1.0, ratio))


class Timing(msgspec.Struct, frozen=True, array_like=True):
    """A time between two points on the way of a key press, s."""

    newest: float | None = None
    p99: float | None = None
    """99 % of the last presses took no longer; None without any."""


class KeyToMotor(msgspec.Struct, frozen=True, array_like=True):
    """The way of a key press to the motors. Half of a round trip counts for each direction.

    `heard_motor` and `total` are upper bounds: until the report that shows it, which may wait for its turn.
    """

    key_sent: Timing = Timing()
    sent_heard: Timing = Timing()
    heard_motor: Timing = Timing()
    total: Timing = Timing()


class HealthLine(msgspec.Struct, frozen=True, array_like=True):
    """One subsystem of the vehicle in words."""

    name: str
    text: str
    good: bool | None
    """False: look at it. None: it does not tell, or is not in use."""


class MissionProgress(msgspec.Struct, frozen=True, kw_only=True):
    """Where the mission stands. Distances in m."""

    current: int
    """Sequence number of the item that is driven to."""
    last: int | None = None
    """That of the last item; None: not known."""
    command: str = ""
    """The current item in words, e.g. "LOITER_TIME 10 s"; empty until the plan is here."""
    distance: float | None = None
    """To the place of the current item."""
    legs: tuple[float, ...] = ()
    """Lengths of the legs that end at `places`; empty until the plan is here."""
    places: tuple[int, ...] = ()
    """Sequence numbers of the items with a place."""
    left: float | None = None
    """To go, from here on."""
    time_left: float | None = None
    """At the present speed, s; None while it stands."""
