"""Vehicle table of the Links screen: one row per vehicle, the cursor, and details of the vehicle under it."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, GREEN, RED, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, Part, cropped, finite_or_none, strip
from groundstation.views.links import VehicleRow, VehiclesView

COLUMNS = (
    Column("", 2),
    Column("id", 3, right=True),
    Column("name", 17, most=26),
    Column("firmware", 9, 6),
    Column("mode", 9, most=12),
    Column("state", 12),
    Column("battery", 11, 3),
    Column("where", 11, 2, most=14),
    Column("heard", 6, 1, right=True),
    Column("in control", 12, 5),
)

LOW_BATTERY = 0.25
"""Share below which the battery is amber."""

QUIET = 1.0
"""s since the last message from which on the age is amber."""

_MODES = {"MANUAL": GREEN, "HOLD": AMBER}


class VehicleTableValue(msgspec.Struct, frozen=True):
    """The vehicles, which one is selected and which one is under the cursor, by system id."""

    view: VehiclesView | None = None
    """None until the first one has arrived."""
    selected: int | None = None
    cursor: int | None = None
    waiting: str = ""
    """What the station waits for while there is no vehicle."""

    @property
    def under_cursor(self) -> VehicleRow | None:
        """The vehicle under the cursor."""
        rows = self.view.rows if self.view else ()
        return next((each for each in rows if each.system == self.cursor), None)


class VehicleTable(Instrument[VehicleTableValue]):
    """The table keeps the cursor in sight; the last lines are about the vehicle under it."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw titles, as many rows as fit, and what does not fit into a row."""
        view = self.value.view
        if view is None or not view.rows:
            text = "waiting for the station" if view is None else self.value.waiting or "no vehicle yet"
            return [strip((f" {clean(text)}", style(DIM))).crop(0, width)]
        tail = [cropped(line, width) for line in self._tail()]
        shown = max(1, height - 1 - len(tail)) if height < self.wanted else len(view.rows)
        tail = tail[: max(0, height - 1 - shown)]
        widths = fit(COLUMNS, width)
        first = self._first(shown)
        rows = [self._row(each, widths) for each in view.rows[first : first + shown]]
        return [header(COLUMNS, widths), *rows, *tail]

    @property
    def wanted(self) -> int:
        """Lines that everything needs."""
        rows = self.value.view.rows if self.value.view else ()
        return 1 + len(rows) + len(self._tail()) if rows else 1

    def _first(self, shown: int) -> int:
        rows = self.value.view.rows if self.value.view else ()
        at = next((index for index, each in enumerate(rows) if each.system == self.value.cursor), 0)
        return max(0, min(at - shown // 2, len(rows) - shown))

    def _row(self, each: VehicleRow, widths: tuple[int, ...]) -> Strip:
        chosen, cursor = each.system == self.value.selected, each.system == self.value.cursor
        ground = FAINT if cursor else BACKGROUND
        ink = TEXT if each.alive else DIM
        marks = f"{'›' if cursor else ' '}{'●' if chosen else ' '}"
        state, state_colour = state_text(each)
        battery, battery_colour = _battery(each)
        cells: list[tuple[str, str, bool]] = [
            (marks, BLUE, True),
            (str(each.system), ink, chosen),
            (each.name, WHITE if chosen else ink, chosen),
            (each.firmware or "--", DIM, False),
            (each.mode, _MODES.get(each.mode, YELLOW) if each.alive else DIM, False),
            (state, state_colour, state_colour == RED),
            (battery, battery_colour if each.alive else DIM, False),
            (where_text(each), ink if each.distance is not None else DIM, False),
            (age_text(each.silence), RED if not each.alive else AMBER if each.silence >= QUIET else DIM, False),
            (_control(each), GREEN if each.in_control else DIM, False),
        ]
        looks = [(text, style(colour, ground, bold=bold)) for text, colour, bold in cells]
        return row(COLUMNS, widths, looks, style(TEXT, ground))

    def _tail(self) -> list[Strip]:
        view, each = self.value.view, self.value.under_cursor
        lines = []
        if view is not None and view.not_shown:
            lines.append(strip((f"   {view.not_shown} more heard, not shown", style(AMBER))))
        if each is not None:
            lines.append(strip(*_details(each)))
        return lines


def _details(each: VehicleRow) -> list[Part]:
    """Return what the row has no room for, and the components."""
    parts: list[Part] = [(f"   {each.system} ", style(TEXT, bold=True))]
    words = [
        f"firmware {each.firmware}" if each.firmware else "firmware not known",
        each.state,
        f"in control: {_control(each)}",
        f"signing {each.signing}" if each.signing else "",
        *(f"{component.component} {component.kind}" for component in each.components),
    ]
    for word in filter(None, words):
        parts += [(" · " if len(parts) > 1 else "", style(DIM)), (clean(word), style(DIM))]
    return parts


def state_text(each: VehicleRow) -> tuple[str, str]:
    """Return armed or not, with what else counts, and its colour. A lost vehicle that was armed may still be armed."""
    if each.emergency_stop:
        return ("ARMED E-STOP" if each.armed else "E-STOP"), RED
    word = "ARMED" if each.armed else "disarmed"
    if not each.alive:
        return (f"{word} lost" if each.armed else "lost"), RED
    if each.state == "critical":
        return f"{word} CRIT", RED
    return word, RED if each.armed else TEXT


def where_text(each: VehicleRow) -> str:
    """Return distance and bearing."""
    if each.distance is None or each.bearing is None:
        return "--" if each.has_position else "no position"
    metres = each.distance
    far = f"{metres:.1f} m" if metres < 99.95 else f"{metres:.0f} m" if metres < 9999.5 else f"{metres / 1000:.0f} km"
    return f"{far} {each.bearing:03.0f}°"


def age_text(seconds: float) -> str:
    """Return an age: "0.1 s", "12 s", "2:14" in minutes, "3 h"."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < 60:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes}:{rest:02d}" if minutes < 100 else f"{minutes // 60} h"


def _battery(each: VehicleRow) -> tuple[str, str]:
    volts, share = finite_or_none(each.battery_voltage), finite_or_none(each.battery_remaining)
    words = [
        *([f"{volts:.1f} V"] if volts is not None else []),
        *([f"{100 * share:.0f}%"] if share is not None else []),
    ]
    return " ".join(words) or "--", AMBER if share is not None and share < LOW_BATTERY else TEXT if words else DIM


def _control(each: VehicleRow) -> str:
    if each.in_control:
        return "this one"
    if each.driver is None:
        return "not told"
    return f"by {each.driver}" if each.driver else "nobody"
