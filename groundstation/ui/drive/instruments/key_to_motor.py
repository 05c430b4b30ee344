"""From the finger to the wheel: the parts of the way of a key press, and the age of the demand against its limit."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.snapshot import Snapshot, VehicleView
from groundstation.snapshot.drive import KeyToMotor, Timing
from groundstation.ui.look.colours import AMBER, DIM, GREEN, LINE, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, strip

NAME, FIGURES, P99, LIMIT = 14, 6, 9, 5
"""Cells beside the bar."""

OLD, STALE = 0.5, 1.0
"""Shares of the limit from which on the age is amber, and red."""


UNKNOWN = KeyToMotor()


class WayValue(msgspec.Struct, frozen=True):
    """Times in ms, rounded to what is drawn."""

    way: KeyToMotor = UNKNOWN
    age: float | None = None
    estimated: bool = False
    limit: float | None = None
    """From this age on the vehicle no longer obeys; None: not known, or never."""
    obeyed: bool = False
    """The motors turn, and the demand asks for it."""

    @classmethod
    def from_snapshot(cls, snapshot: Snapshot) -> WayValue:
        """Return the way to the selected vehicle."""
        vehicle = snapshot.vehicle
        if vehicle is None:
            return cls()
        way, age = vehicle.key_to_motor, finite_or_none(vehicle.command_age)
        return cls(
            _rounded_way(way),
            None if age is None or age > 99.0 else round(1000 * age),
            vehicle.command_age_estimated,
            command_limit(vehicle),
            _turns_by_demand(vehicle),
        )


def command_limit(vehicle: VehicleView) -> float | None:
    """Return the age in ms from which on the vehicle no longer obeys a demand, by its own parameters."""
    bound = next((stop.bound for stop in vehicle.stops if stop.name == "no command" and not stop.never), None)
    return None if bound is None else 1000 * bound


def _turns_by_demand(vehicle: VehicleView) -> bool:
    """Return whether motors turn while a demand for motion is in force."""
    turning = any(output.value for output in vehicle.outputs)
    return vehicle.armed and vehicle.drivable and turning and any(vehicle.demand or ())


def _rounded_way(way: KeyToMotor) -> KeyToMotor:
    return KeyToMotor(*map(_rounded, (way.key_sent, way.sent_heard, way.heard_motor, way.total)))


def _rounded(timing: Timing) -> Timing:
    newest, p99 = finite_or_none(timing.newest), finite_or_none(timing.p99)
    return Timing(None if newest is None else round(1000 * newest, 1), None if p99 is None else round(1000 * p99, 1))


class WayPanel(Instrument[WayValue]):
    """One line for each part, as far as they fit: the sum and the age of the demand first."""

    BORDER_TITLE = "from your finger to the wheel · ms"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw bars of one scale, and the age of the demand on a line that ends at its limit."""
        value = self.value
        way, total = value.way, self._part("key to motor", value.way.total, width, at_most=True)
        parts = [
            self._part("key to sent", way.key_sent, width),
            self._part("sent to heard", way.sent_heard, width),
            self._part("heard to motor", way.heard_motor, width, at_most=True),
        ]
        age, note = self._age(width), strip((self._note(), style(DIM)))
        if height >= len(parts) + 4:
            lines = [*parts, total, strip((" " * width, style())), age, note]
        else:
            lines = [total, age, note]
        return [line.crop(0, width) for line in lines[:height]]

    def _part(self, name: str, timing: Timing, width: int, at_most: bool = False) -> Strip:
        whole = name == "key to motor"
        figures = "--" if timing.newest is None else f"{'≤' if at_most else ''}{_ms(timing.newest)}"
        p99 = "" if timing.p99 is None else f"p99 {_ms(timing.p99)}"
        room = max(0, width - NAME - FIGURES - P99 - 1)
        full = min(room, round((timing.newest or 0.0) / self._scale * room))
        known = timing.newest is not None
        full = max(full, int(known and room > 0))
        return strip(
            (f"{name:<{NAME}}", style(TEXT if whole else DIM)),
            (f"{figures:>{FIGURES}} ", style(TEXT if known else DIM, bold=whole)),
            ("━" * full, style(GREEN)),
            (" " * (room - full), style()),
            (f"{p99:>{P99}}", style(DIM)),
        )

    @property
    def _scale(self) -> float:
        way = self.value.way
        return max(1.0, *(part.newest or 0.0 for part in (way.total, way.key_sent, way.sent_heard, way.heard_motor)))

    def _age(self, width: int) -> Strip:
        value, limit = self.value, self.value.limit
        text = "--" if value.age is None else f"{'~' if value.estimated else ''}{_ms(value.age)}"
        share = value.age / limit if value.age is not None and limit else None
        colour = DIM if share is None else GREEN if share < OLD else AMBER if share < STALE else RED
        room = max(0, width - NAME - FIGURES - LIMIT - 2)
        full = 0 if share is None else min(room, round(share * room))
        line: list[Part] = [("━" * full, style(colour)), ("·" * (room - full), style(DIM if limit else LINE))]
        end = f"┤{_ms(limit)}" if limit else " --"
        return strip(
            (f"{'command age':<{NAME}}", style(TEXT)), (f"{text:>{FIGURES}} ", style(colour, bold=True)), *line,
            (end, style(DIM)),
        )  # fmt: skip

    def _note(self) -> str:
        if self.value.age is None:
            return "no demand is in use"
        if self.value.estimated:
            return "~ an estimate: the vehicle does not tell"
        age = f"{_ms(self.value.age)} ms old"
        if self.value.limit is not None and self.value.age >= self.value.limit:
            return f"the demand is {age}: not obeyed"
        return f"the motors obey a demand {age}" if self.value.obeyed else f"the newest demand is {age}"


def _ms(value: float) -> str:
    return f"{value:.1f}" if value < 9.95 and value != int(value) else f"{value:.0f}"
