"""What the Log screen shows of the marked line: its whole text, when, from where, how severe, and its group."""

from __future__ import annotations

import time
from collections.abc import Iterator

import msgspec

from groundstation.snapshot import LogLine
from groundstation.ui.log.filter import SEVERITY_NAMES, first_time, tag_of
from groundstation.ui.log.join import LogGroup

SEVERITY_MEANINGS = (
    "the system cannot be used", "act at once: a system that is not primary fails",
    "act at once: a primary system fails", "a redundant or secondary system fails",
    "an error may follow if nothing is done", "unusual, but no error: find the cause",
    "normal operation, nothing to do", "for developers only",
)  # fmt: skip
"""MAV_SEVERITY 0 to 7, after common.xml."""

RESULTS = (
    ("ACCEPTED", "valid, and executed or being executed"),
    ("TEMPORARILY_REJECTED", "valid, but not possible now: try again later"),
    ("DENIED", "a parameter is wrong, or this ground station may not: the same again is refused again"),
    ("UNSUPPORTED", "the vehicle does not know this command"),
    ("FAILED", "valid, but it failed: put the reason right first"),
    ("IN_PROGRESS", "being executed, the end follows"),
    ("CANCELLED", "cancelled before its end"),
    ("COMMAND_LONG_ONLY", "only accepted as COMMAND_LONG"),
    ("COMMAND_INT_ONLY", "only accepted as COMMAND_INT"),
    ("COMMAND_UNSUPPORTED_MAV_FRAME", "the frame of the position is not supported"),
    ("NOT_IN_CONTROL", "valid, but this ground station is not in control"),
)
"""MAV_RESULT 0 to 10: names as in dialects.enums.result_token, and meanings after common.xml."""

PLACES = {"you": "you, at this ground station", "line": "the : line of this ground station"}
"""Label of a line without a vehicle -> its source."""


class DetailRow(msgspec.Struct, frozen=True):
    """A named text, wrapped by the widget."""

    name: str
    text: str
    severity: int = 6
    """MAV_SEVERITY, for its colour."""


class LogDetail(msgspec.Struct, frozen=True):
    """Everything of one line."""

    title: str = "detail"
    rows: tuple[DetailRow, ...] = ()


def describe(line: LogLine | None, group: LogGroup) -> LogDetail:
    """Return the detail of a line and of what belongs to it; without a line, that there is none."""
    if line is None:
        return LogDetail(rows=(DetailRow("", "no line is shown"),))
    text = DetailRow("text", line.text, line.severity)
    return LogDetail(tag_of(line), (text, *_group_rows(line, group), *_line_rows(line)))


def _line_rows(line: LogLine) -> Iterator[DetailRow]:
    yield DetailRow("time", time.strftime("%Y-%m-%d ", time.localtime(line.time)) + clock(line.time))
    if line.count > 1:
        yield DetailRow("repeats", f"×{line.count}, {clock(first_time(line))} to {clock(line.time)}")
    yield DetailRow("source", source_of(line))
    severity = max(0, min(7, line.severity))
    yield DetailRow("severity", f"{SEVERITY_NAMES[severity]} ({severity}): {SEVERITY_MEANINGS[severity]}")


def _group_rows(line: LogLine, group: LogGroup) -> Iterator[DetailRow]:
    answer, request = group.answer, group.request
    if answer is None:
        return
    if request is not None and request != line:
        yield DetailRow("request", f"{clock(request.time)} {request.text}")
    if answer != line:
        yield DetailRow("answer", f"{clock(answer.time)} {answer.text}", answer.severity)
    if request is not None:
        yield DetailRow("after", f"{max(0.0, answer.time - request.time):.2f} s")
    if answer.origin is not None and answer.origin.result is not None:
        yield DetailRow("result", result_text(answer.origin.result), answer.severity)
    for text in group.texts:
        if text != line:
            yield DetailRow("it said", f"{clock(text.time)} {text.text}", text.severity)


def result_text(number: int) -> str:
    """Return a MAV_RESULT by name and number, and what it means."""
    name, meaning = RESULTS[number] if 0 <= number < len(RESULTS) else ("a result without a name", "")
    return f"{name} ({number}): {meaning}".removesuffix(": ")


def source_of(line: LogLine) -> str:
    """Return the system, the component and the vehicle's name that a line came from."""
    origin = line.origin
    if origin is None:
        return PLACES.get(line.label, "this ground station" if line.label == "station" else "a vehicle")
    ids = f"{origin.system}/{origin.component}" if origin.component else f"system {origin.system}"
    return f"{ids} {origin.vehicle}".rstrip()


def clock(at: float) -> str:
    """Return a time of the wall clock, rounded to tenths of a second."""
    tenths = round(at * 10)
    return time.strftime("%H:%M:%S", time.localtime(tenths // 10)) + f".{tenths % 10}"
