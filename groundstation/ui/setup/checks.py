"""The pre-arm checks: what the vehicle said, what to do, and its subsystems."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import BLUE, DIM, GREEN, RED, TEXT, WHITE, style
from groundstation.ui.setup.chain import MARKS
from groundstation.ui.widgets.instrument import Instrument, Part, cropped, strip
from groundstation.views.doctor import DoctorView
from link.runtime.diagnosis import Health


class ChecksValue(msgspec.Struct, frozen=True):
    """The view; None until the first one has arrived."""

    view: DoctorView | None = None


class ChecksPanel(Instrument[ChecksValue]):
    """Reasons first, then the subsystems of SYS_STATUS."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines that fit."""
        view = self.value.view
        if view is None or not view.system:
            return [strip((" no vehicle yet", style(DIM)))]
        lines = [*_reasons(view, width), *_answer(view), *_sensors(view)]
        return [cropped(strip(*line), width) for line in lines[:height]]


def _reasons(view: DoctorView, width: int) -> Iterator[list[Part]]:
    for each in view.texts:
        for number, line in enumerate(wrap(each.text, width - 4)):
            yield [(" ✗ " if not number else "   ", style(RED, bold=True)), (line, style(WHITE, bold=True))]
        for line in wrap(each.advice, width - 6) if each.advice else ():
            yield [("   → ", style(BLUE)), (line, style(BLUE))]
    if view.texts:
        yield []


def _answer(view: DoctorView) -> Iterator[list[Part]]:
    """Say how the request for the checks stands, where it has not simply been answered."""
    checked = view.checked
    if checked is None or checked.state == "accepted":
        if checked is not None and not view.texts:
            yield [(" ✓ ", style(GREEN, bold=True)), ("no reason against arming was given", style(TEXT))]
            yield []
        return
    if checked.state == "running":
        yield [(" asked, waiting for the answer", style(DIM))]
    else:
        why = "the vehicle cannot run them on request" if "UNSUPPORTED" in checked.detail else checked.detail
        yield [(" ✗ ", style(RED, bold=True)), (clean(f"{checked.state}: {why}"), style(TEXT))]
    yield []


def _sensors(view: DoctorView) -> Iterator[list[Part]]:
    if not view.sensors:
        yield [(" SYS_STATUS has not arrived yet", style(DIM))]
    for each in view.sensors:
        mark, colour = MARKS[each.health]
        off = "  not enabled" if each.health is Health.UNKNOWN else ""
        yield [(f" {mark} ", style(colour, bold=True)), (each.name, style(TEXT)), (off, style(DIM))]


def checks_age(view: DoctorView) -> str:
    """Return when the checks ran last."""
    if view.checked is not None and view.checked.state == "running":
        return "asked"
    return "c asks the vehicle" if view.checked_ago is None else f"{view.checked_ago:.0f} s ago, c asks again"
