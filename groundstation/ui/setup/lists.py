"""Calibrations and facts of the vehicle: lists of short lines."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import BLUE, DIM, GREEN, RED, TEXT, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, cropped, strip
from groundstation.views.doctor import CalibrationRow, DoctorView, StickRow
from groundstation.views.requests import RequestLine
from link.runtime.diagnosis import Health

STICK_CELLS = 16
"""Cells of the travel of an RC channel."""

CALIBRATION_KEYS = {"accel": "A", "level": "H", "gyro": "Y", "pressure": "P", "compass": "C", "sticks": "R"}
"""Kind, without the autopilot's suffix -> its key."""


def calibration_key(row: CalibrationRow) -> str:
    """Return the key that begins a calibration."""
    return CALIBRATION_KEYS.get(row.kind.partition("-")[0], "?")


class ListValue(msgspec.Struct, frozen=True):
    """The view; None until the first one has arrived."""

    view: DoctorView | None = None


class CalibrationPanel(Instrument[ListValue]):
    """What can be calibrated, and what to do meanwhile."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw a line for each kind, or one for all where there is one row only."""
        view = self.value.view
        if view is None or not view.system:
            return [strip((" no vehicle yet", style(DIM)))]
        if height == 1:
            return [strip(*(_running(view, ended=False) or _in_one_line(view))).crop(0, width)]
        running = _running(view, ended=True)
        below = [running] if running else []
        below += [] if view.calibration_share is None else [_bar(view.calibration_share, width)]
        below += [[(f" {text}", style(BLUE, bold=True))] for text in wrap(view.calibration, width - 2)]
        room = height - len(below) - 1 if below else height  # what to do comes before what could be done
        lines = [_line(row) for row in view.calibrations] if view.sticks is None else _stick_lines(view.sticks)
        shown = [*lines[: max(0, room)], *([[]] if below else []), *below]
        return [cropped(strip(*line), width) for line in shown[:height]]


def _line(row: CalibrationRow) -> list[Part]:
    cannot = row.state == "cannot"
    key = style(DIM) if cannot else style(YELLOW, bold=True)
    looks = {Health.OK: GREEN, Health.FAULT: RED}
    return [
        (f" {calibration_key(row)} ", key),
        (f"{row.title:<16}", style(DIM if cannot else TEXT)),
        (row.state, style(looks.get(row.health, DIM))),
    ]


def _bar(share: float, width: int) -> list[Part]:
    """Return the progress of a calibration."""
    room = max(1, width - 8)
    full = round(share * room)
    return [(f" {share:4.0%} ", style(TEXT)), ("█" * full, style(BLUE)), ("░" * (room - full), style(DIM))]


def _stick_lines(sticks: tuple[StickRow, ...]) -> list[list[Part]]:
    """Return a line for each RC channel, those that were moved first."""
    rows = sorted(sticks, key=lambda row: not row.moved)
    return [_stick(row) for row in rows] or [[(" no RC channel is reported yet", style(DIM))]]


def _stick(row: StickRow) -> list[Part]:
    """Return the travel of a channel on a line from 900 to 2100 us, and where it is."""
    low, high, now = (max(0, min(STICK_CELLS - 1, (each - 900) * STICK_CELLS // 1200)) for each in row.pulses)
    cells = "".join("┃" if at == now else "█" if low <= at <= high else "·" for at in range(STICK_CELLS))
    look = style(TEXT) if row.moved else style(DIM)
    end = ("✓", style(GREEN)) if row.moved else ("", style(DIM))
    return [(f" {row.channel:>2} {row.low:>4} ", look), (cells, look), (f" {row.high:>4} ", look), end]


def _in_one_line(view: DoctorView) -> list[Part]:
    if view.calibration:
        return [(f" {clean(view.calibration)}", style(BLUE, bold=True))]
    parts: list[Part] = [(" calibrate", style(DIM))]
    for row in view.calibrations:
        if row.state != "cannot":
            done = " ✓" if row.health is Health.OK else ""
            parts += [(f" {calibration_key(row)} ", style(YELLOW, bold=True)), (f"{row.title}{done}", style(TEXT))]
    return parts if len(parts) > 1 else [(" calibration: this vehicle cannot", style(DIM))]


def _running(view: DoctorView, *, ended: bool) -> list[Part]:
    """Return how the newest request for a calibration stands; `ended`: also after its end."""
    line = next((each for each in reversed(view.requests) if each.what.startswith("calibrate")), None)
    if line is None or (line.state != "running" and (view.calibration or not ended)):
        return []
    colour = {"running": BLUE, "accepted": GREEN}.get(line.state, RED)
    return [(f" {clean(request_text(line))}", style(colour))]


def request_text(line: RequestLine) -> str:
    """Return how a request stands, in one line."""
    done = f" {line.done} %" if line.state == "running" and line.total else ""
    state = {"running": "…", "accepted": "done"}.get(line.state, line.state)
    return f"{line.what}: {state}{done}" + (f", {line.detail}" if line.detail else "")


class FactsPanel(Instrument[ListValue]):
    """What the vehicle is, and the keys for it as a whole."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the facts that fit, then the keys."""
        view = self.value.view
        if view is None or not view.system:
            return [strip((" no vehicle yet", style(DIM)))]
        keys: list[list[Part]] = [
            [(" B ", style(YELLOW, bold=True)), ("restart it", style(TEXT))],
            [(" S ", style(YELLOW, bold=True)), ("save a report for a bug", style(TEXT))],
        ]
        facts: list[list[Part]] = [
            [(f" {name:<10}", style(DIM)), (clean(text), style(TEXT))] for name, text in view.facts
        ]
        return [strip(*line).crop(0, width) for line in [*facts[: max(0, height - 3)], [], *keys][:height]]
