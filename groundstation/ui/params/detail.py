"""Detail of one parameter: its texts, values, range, list of values or bits, and why it matters."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, GREEN, TEXT, WHITE, style
from groundstation.ui.params.edit.checks import Level, check_value, is_rounded, range_text
from groundstation.ui.params.edit.reasons import reason_for
from groundstation.ui.params.range_line import range_lines
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.views.params import ParamInfo
from link.services.param.float32 import value_text

LABEL = 12
"""Width of the labels."""
TALL = 20
"""Rows from which on texts are shown whole before the values."""
MAX_TEXT = 3
"""Lines of a text below that."""
_CHECK_COLOURS = {Level.GOOD: GREEN, Level.WARNING: AMBER, Level.UNKNOWN: DIM}


class DetailValue(msgspec.Struct, frozen=True):
    """What the detail shows."""

    info: ParamInfo | None = None
    new: float | None = None
    """The pending value, or the one that is being typed; None: there is none."""
    typed: str | None = None
    """The text in the field; None: nothing is being typed."""
    choices: tuple[tuple[float, str], ...] | None = None
    """The part of the list of values that the text matches; None: the whole list."""
    cursor: int = -1
    """Row of the list or of the bits while a value is typed."""
    file: str = ""
    """The file that is compared."""
    top: int = 0
    note: str = ""
    """In place of a parameter; or why there are no texts."""


class ParamDetail(Instrument[DetailValue]):
    """Lines about one parameter, from `top` on; while a value is typed its list comes first."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw what fits."""
        value = self.value
        if value.info is None:
            return [strip((f" {line}", style(DIM))) for line in wrap(value.note, width - 2)]
        lines = list(detail_lines(value, width - 2, short=height < TALL))
        top = self._top(value, len(lines), height)
        return [strip((" ", style()), *parts).crop(0, width) for parts in lines[top : top + height]]

    def _top(self, value: DetailValue, count: int, height: int) -> int:
        """Return the first line: while a list is edited, so that its cursor is seen."""
        if value.cursor >= 0 and value.typed is not None:
            return max(0, min(value.cursor + 4 - height // 2, count - height))
        return max(0, min(value.top, count - height))


def detail_lines(value: DetailValue, width: int, *, short: bool) -> Iterator[list[Part]]:
    """Yield all lines of a parameter; `short`: what matters most comes first."""
    info = value.info
    if info is None:
        return
    editing = value.typed is not None and bool(info.values or info.bits)
    if editing:
        yield from _values(value, info, width)
        yield from _facts(value, info, width)
        yield from _list(value, info, width)
        return
    if info.title:
        yield from ([(line, style(WHITE, bold=True))] for line in wrap(info.title, width))
    yield from ([(line, style(TEXT))] for line in _text(info.text, width, MAX_TEXT if short else len(info.text)))
    if info.title or info.text:
        yield []
    parts = [_values(value, info, width), _facts(value, info, width), _reason(info, width), _list(value, info, width)]
    if short:
        parts[1], parts[2] = parts[2], parts[1]
    for part in parts:
        yield from part
    if value.note:
        yield []
        yield from ([(line, style(DIM))] for line in wrap(value.note, width))


def _values(value: DetailValue, info: ParamInfo, width: int) -> Iterator[list[Part]]:
    if value.typed is not None or value.new is not None:
        yield _new_line(value, info, width)
        yield from _check_line(value, info, width)
    yield _labelled("on vehicle", value_text(info.value), TEXT)
    yield _labelled("default", "--" if info.default is None else value_text(info.default), TEXT)
    if value.file:
        yield _labelled("in the file", "--" if info.file is None else value_text(info.file), TEXT)
    if info.unit:
        yield _labelled("unit", info.unit, TEXT)
    if info.step:
        yield _labelled("step", value_text(info.step), TEXT)
    if info.low is not None or info.high is not None:
        yield _labelled("range", range_text(info), TEXT)


def _facts(value: DetailValue, info: ParamInfo, width: int) -> Iterator[list[Part]]:
    index = "" if info.index is None else f" · index {info.index}"
    yield _labelled("type", f"{info.kind}{index}", DIM)
    yield _effect(info)
    if info.low is not None and info.high is not None and not info.values and not info.bits:
        shown = info.value if value.new is None else value.new
        yield from range_lines(info.low, info.high, info.default, shown, min(width, 44))


def _text(text: str, width: int, most: int) -> list[str]:
    """Return a text in at most so many lines; one that is cut says so."""
    lines = wrap(text, width) if text else []
    return lines if len(lines) <= most else [*lines[: most - 1], f"{lines[most - 1][: width - 1]}…"]


def _reason(info: ParamInfo, width: int) -> Iterator[list[Part]]:
    if why := reason_for(info.name):
        yield []
        yield [("why it matters here", style(AMBER, bold=True))]
        yield from ([(line, style(TEXT))] for line in wrap(why, width))
        yield []


def _new_line(value: DetailValue, info: ParamInfo, width: int) -> list[Part]:
    """Return the new value on a ground of its own; one that is sent as another float32 says so."""
    shown = "--" if value.new is None else value_text(value.new)
    if value.new is not None and value.typed is not None and is_rounded(value.typed, value.new):
        shown = f"{shown} rounded"
    return [
        ("new value".ljust(LABEL), style(DIM, FAINT)),
        (clean(shown).ljust(width - LABEL), style(BLUE, FAINT, bold=True)),
    ]


def _check_line(value: DetailValue, info: ParamInfo, width: int) -> Iterator[list[Part]]:
    if value.new is not None and (check := check_value(info, value.new)).text:
        yield [(" " * LABEL, style()), (check.fitted(width - LABEL), style(_CHECK_COLOURS[check.level]))]


def _effect(info: ParamInfo) -> list[Part]:
    if info.read_only:
        return _labelled("changes", "read-only", AMBER)
    if info.reboot:
        return _labelled("effect", "after a restart", AMBER)
    if info.not_armed:
        return _labelled("effect", "only while disarmed", AMBER)
    described = bool(info.title or info.text or info.values or info.bits)
    return _labelled("effect", "at once" if described else "not known", DIM)


def _labelled(label: str, text: str, colour: str) -> list[Part]:
    return [(label.ljust(LABEL), style(DIM)), (clean(text), style(colour))]


def _list(value: DetailValue, info: ParamInfo, width: int) -> Iterator[list[Part]]:
    """Yield the list of values, or of bits: ✓ what is set or will be."""
    now = info.value if value.new is None else value.new
    if info.values:
        choices = info.values if value.choices is None else value.choices
        yield [
            (
                f"values ({len(choices)} of {len(info.values)})" if len(choices) < len(info.values) else "values",
                style(DIM),
            )
        ]
        for row, (number, name) in enumerate(choices):
            yield _choice(f"{value_text(number):>4} {name}", number == now, row == value.cursor, width)
    elif info.bits:
        yield [("bits" if value.typed is None else "bits · TAB toggles", style(DIM))]
        whole = int(now) if now.is_integer() else 0
        for row, (bit, name) in enumerate(info.bits):
            yield _choice(f"{bit:>4} {name}", bool(whole >> bit & 1), row == value.cursor, width)


def _choice(text: str, chosen: bool, at_cursor: bool, width: int) -> list[Part]:
    ground = FAINT if at_cursor else BACKGROUND
    mark = (f"{'›' if at_cursor else ' '}{'✓' if chosen else ' '}", style(GREEN, ground))
    return [
        mark,
        (
            clean(text)[: width - 2].ljust(width - 2 if at_cursor else 0),
            style(WHITE if chosen else TEXT, ground, bold=chosen),
        ),
    ]
