"""Driving strip: what a driver must see, for terminals in which the console does not fit, down to 40x10."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.snapshot import LogLine, OperatorView
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.hints import hint
from groundstation.ui.display.wrap import wrap
from groundstation.ui.drive.instruments.keycaps import Keycaps, KeycapsValue, bound_parts, style_parts
from groundstation.ui.drive.instruments.speed import speed_text
from groundstation.ui.drive.instruments.sticks import Bar, StickBars, build_bars
from groundstation.ui.drive.instruments.stops import StopsLine, StopsValue
from groundstation.ui.log.panel import LogPanel
from groundstation.ui.look.colours import BLUE, DIM, PANEL, TEXT, badge, style
from groundstation.ui.widgets.alert import LOOKS, MARKS, AlertValue
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.ui.widgets.status import (
    StatusBarValue,
    arming_badges,
    driver_part,
    health_parts,
    mode_badge,
    muted_parts,
    recording_parts,
)

TALL = 14
"""Rows from which on there are bars, what stops the vehicle, and caps, if the alerts leave room."""

LEAST_TEXTS = 2
"""Lines of the log that they leave."""

BOUND_LINE = 3
"""Index of the line of the vehicle that says what ends a drive."""

HINT_LINES = 2
"""Lines of the hint, above the footer."""


class StripValue(msgspec.Struct, frozen=True):
    """What the strip shows."""

    status: StatusBarValue
    alerts: AlertValue
    caps: KeycapsValue
    footer: FooterValue
    hint: str
    texts: tuple[LogLine, ...]
    """The newest messages, for the lines that are left."""
    bars: tuple[Bar, ...] = ()
    stops: StopsValue = StopsValue()

    @classmethod
    def from_state(cls, now: DisplayState) -> StripValue:
        """Return the strip of a display state."""
        return cls(
            StatusBarValue.from_state(now),
            AlertValue.from_state(now),
            KeycapsValue.from_state(now),
            FooterValue.from_state(now),
            hint(now),
            now.snapshot.texts,
            build_bars(now.snapshot),
            StopsValue.from_state(now),
        )


class DrivingStrip(Instrument[StripValue]):
    """State, speed and keys at the top, hint and footer at the bottom, between them the alerts, then messages."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many lines as there are; the alerts are whole as far as they fit."""
        top = [strip(*line).crop(0, width) for line in self._state()]
        alerts = list(self._alerts(width))
        hints = self._hints(width)
        room = max(0, height - len(top) - len(hints) - 1)
        if len(alerts) > room:
            room, hints = room + len(hints) - 1, hints[:1]
        if len(alerts) > room:
            alerts = [*alerts[: room - 1], self._more(width)] if room else []
        if height >= TALL and self.value.status.snapshot.vehicle is not None:
            lines = len(top)
            top = self._with_drive(top, room - len(alerts) - LEAST_TEXTS, width)
            room -= len(top) - lines
        texts = LogPanel(self.value.texts).draw(width, room - len(alerts)) if room > len(alerts) else []
        blank = [strip((" " * width, style()))] * (room - len(alerts) - len(texts))
        return [*top, *alerts, *blank, *texts, *hints, *KeyFooter(self.value.footer).draw(width, 1)]

    def _with_drive(self, top: list[Strip], spare: int, width: int) -> list[Strip]:
        """Return the lines of the vehicle and what fits beside them in `spare` lines, the most important first."""
        stops, bars, caps = self._drive(width)
        for part in (stops, bars):
            if len(part) <= spare:
                top, spare = [*top, *part], spare - len(part)
        if len(caps) - 1 <= spare:  # the line of the bound is drawn beside the caps
            top = [*top[:BOUND_LINE], *top[BOUND_LINE + 1 :], *caps]
        return top

    def _drive(self, width: int) -> tuple[list[Strip], list[Strip], list[Strip]]:
        """Return what stops the vehicle, the bars and the caps."""
        value, inside = self.value, width - 2
        return (
            StopsLine(value.stops).draw(width, 1),
            [Strip([*strip((" ", style())), *line]) for line in StickBars(value.bars).draw(inside, 2)],
            [Strip([*strip((" ", style())), *line]) for line in Keycaps(value.caps).draw(inside, 3)],
        )

    def _hints(self, width: int) -> list[Strip]:
        lines = wrap(f"› {self.value.hint}", width - 2)[:HINT_LINES]
        return [strip((f" {line}".ljust(width), style(TEXT, PANEL))) for line in lines]

    def _state(self) -> Iterator[list[Part]]:
        """Yield the lines of the vehicle. Arming comes first: it is never cut off."""
        vehicle, caps = self.value.status.snapshot.vehicle, self.value.caps
        space: Part = (" ", style())
        if vehicle is None:
            yield [(" mavhelm ", badge(BLUE)), (" no vehicle", style(DIM))]
            yield [space, (self.value.status.snapshot.waiting or "", style(TEXT))]
            return
        dot = recording_parts(self.value.status.snapshot.recording)
        status = self.value.status
        mute = muted_parts(muted=status.muted)
        yield [*arming_badges(vehicle), mode_badge(vehicle), *mute, (f" {vehicle.name} ", badge(BLUE)), *dot]
        who = driver_part(vehicle, station_runs=status.station_runs, watches=bool(status.snapshot.lease.driver))
        yield [space, who, space, *health_parts(vehicle)]
        demand = _demand(self.value.status.snapshot.operator)
        yield [space, (f"{speed_text(vehicle)} m/s", style(TEXT, bold=True)), ("  " + demand, style(DIM))]
        yield [space, *(bound_parts(caps) if caps.style == "hold" else style_parts(caps))]

    def _alerts(self, width: int) -> Iterator[Strip]:
        for alert in self.value.alerts.alerts:
            for number, line in enumerate(wrap(alert.text, width - 3)):
                mark = MARKS[alert.level] if number == 0 else " "
                yield strip((f" {mark} {line}".ljust(width), LOOKS[alert.level]()))

    def _more(self, width: int) -> Strip:
        look = LOOKS[self.value.alerts.alerts[-1].level]()
        return strip((f" … {self.value.alerts.list_key} lists all".ljust(width), look)).crop(0, width)


def _demand(operator: OperatorView) -> str:
    return f"throttle {100 * operator.throttle:+.0f}% turn {100 * operator.steering:+.0f}%"
