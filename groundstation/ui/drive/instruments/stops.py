"""What stops the vehicle, and when: a bar for each bound that fills as silence grows. One line of it in small ones."""

from __future__ import annotations

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.snapshot.drive import StopBound
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.instruments.stops_model import all_stops
from groundstation.ui.look.colours import AMBER, DIM, FAINT, GREEN, PANEL, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, length, strip

NAME, DOES, BOUND, NOW = 11, 9, 7, 7
"""Cells of the columns beside the bar."""

LEAST_BAR, LINE_BAR = 3, 3
SOON, NEAR = 0.5, 0.8
"""Shares of a bound from which on its bar is amber, and red."""

SHORT = {
    "key let go": "key", "pad let go": "pad", "terminal": "tty", "no command": "cmd", "no station": "gcs",
    "no key": "you", "... no RC": "no RC",
}  # fmt: skip
"""Name -> its name in the line of small terminals; those without one are not in it."""

_UNITS = {"deg": "°", "V": " V", "m": " m"}


class StopsValue(msgspec.Struct, frozen=True):
    """The bounds, with values rounded to what is drawn."""

    stops: tuple[StopBound, ...] = ()

    @classmethod
    def from_state(cls, now: DisplayState) -> StopsValue:
        """Return the bounds of a display state."""
        return cls(tuple(map(_rounded, all_stops(now))))


def _rounded(stop: StopBound) -> StopBound:
    value = finite_or_none(stop.value)
    digits = 0 if stop.unit == "deg" else 1 if stop.unit == "V" or (stop.bound or 0.0) >= 2.0 else 2
    return StopBound(
        stop.name, stop.does, stop.source, finite_or_none(stop.bound), None if value is None else round(value, digits),
        stop.never, stop.unit, stop.estimated,
    )  # fmt: skip


class StopsPanel(Instrument[StopsValue]):
    """One line for each bound."""

    BORDER_TITLE = "what stops it, and when"

    @property
    def wanted(self) -> int:
        """Lines that everything needs."""
        return len(self.value.stops) + 1

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit, the most important first; the last line says what the bars mean, or what is hidden."""
        stops = self.value.stops
        whole = len(stops) < height
        shown = stops if whole else stops[: height - 1]
        note = _note(stops) if whole else (f"and {len(stops) - len(shown)} more", style(DIM))
        lines = [strip(*_row(stop, width)).crop(0, width) for stop in shown]
        return [*lines, strip(note).crop(0, width)][:height] if stops else []


def _note(stops: tuple[StopBound, ...]) -> Part:
    off = sum(stop.never and stop.unit == "s" for stop in stops)
    unknown = any(stop.bound is None and not stop.never for stop in stops)
    if off:
        return f"never: {off} of {len(stops)} {'is' if off == 1 else 'are'} switched off", style(RED)
    return ("--: the vehicle has not told" if unknown else "a full bar stops it"), style(DIM)


def _row(stop: StopBound, width: int) -> list[Part]:
    room = max(0, width - NAME - DOES - BOUND - NOW - 1)
    does = "" if stop.never else stop.does
    parts: list[Part] = [(f"{stop.name:<{NAME}}"[:NAME], style(DIM)), (f"{does:<{DOES}}"[:DOES], style(TEXT))]
    parts += [(f"{bound_text(stop):>{BOUND}} ", _bound_look(stop))]
    if room < LEAST_BAR:
        return parts
    return [*parts, *_bar(stop, room), (f"{value_text(stop):>{NOW}}", style(share_colour(stop)))]


def _bar(stop: StopBound, width: int) -> list[Part]:
    share = stop.share
    full = 0 if share is None else min(width, round(share * width) or int(share > 0))
    return [("▄" * full, style(share_colour(stop), PANEL)), ("░" * (width - full), style(FAINT, PANEL))]


def share_colour(stop: StopBound) -> str:
    """Return the colour of a bar: a voltage and a tilt are no silence that grows, and only red close to the bound."""
    share = stop.share
    if share is None:
        return DIM
    if stop.unit == "V":
        return RED if share >= 1.0 else GREEN
    return RED if share >= NEAR else AMBER if share >= SOON else GREEN


def _bound_look(stop: StopBound) -> Style:
    if stop.never:
        return style(RED, bold=True) if stop.unit == "s" else style(DIM)
    return style(DIM if stop.bound is None else TEXT)


def bound_text(stop: StopBound) -> str:
    """Return the bound in words."""
    if stop.never:
        return "never" if stop.unit == "s" else "off"
    if stop.bound is None:
        return "--"
    return "at once" if stop.bound == 0 else _quantity(stop.bound, stop.unit)


def value_text(stop: StopBound) -> str:
    """Return where it stands, "~" before an estimate; empty where there is nothing to fill."""
    if stop.never or not stop.bound:
        return ""
    if stop.value is None:
        return "--"
    return f"{'~' if stop.estimated else ''}{_quantity(stop.value, stop.unit, stop.bound)}"


def _quantity(value: float, unit: str, bound: float | None = None) -> str:
    if unit != "s":
        return f"{value:.0f}°" if unit == "deg" else f"{value:.1f}{_UNITS.get(unit, '')}"
    if value >= 60.0:
        return f"{value // 60:.0f}:{value % 60:02.0f}"
    return f"{value:.2f} s" if (value if bound is None else bound) < 2.0 else f"{value:.1f} s"


class StopsLine(Instrument[StopsValue]):
    """The bounds in time on one line, as many as fit."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw name, bar and bound of each; what never stops is red."""
        parts: list[Part] = [(" stops without", style(DIM))]
        for stop in self._stops():
            item = _item(stop, gap=" " if len(parts) == 1 else "  ")
            if length(parts) + length(item) > width:
                break
            parts += item
        return [strip(*parts)] if self.value.stops else []

    def _stops(self) -> list[StopBound]:
        named: dict[str, StopBound] = {}
        for stop in self.value.stops:
            if stop.name in SHORT:
                named.setdefault(SHORT[stop.name], stop)
        return [named[name] for name in ("cmd", "no RC", "gcs", "key", "tty", "you") if name in named]


def _item(stop: StopBound, gap: str) -> list[Part]:
    bar = _bar(stop, LINE_BAR) if stop.bound and not stop.never else []
    behind: list[Part] = [(" ", style())] if bar else []
    return [(f"{gap}{SHORT[stop.name]} ", style(DIM)), *bar, *behind, (bound_text(stop), _bound_look(stop))]
