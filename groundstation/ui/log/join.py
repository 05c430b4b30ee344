"""Lines of the log that belong together: a request, the answer to it, and what the vehicle said to it."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from groundstation.snapshot import LogLine
from groundstation.ui.log.filter import first_time

ANSWER_WITHIN = 15.0
"""s from a request to its answer; commands are repeated for less than that."""

TEXT_WITHIN = 1.0
"""s between an answer and a STATUSTEXT that explains it; either may be first."""

ANSWER, TEXT, COMMAND_LINE = "ack", "vehicle", "line"
REQUESTS = ("you", COMMAND_LINE)
"""Labels of lines (LogLine.label)."""


class LogGroup(msgspec.Struct, frozen=True):
    """What belongs to one answer; empty where a line stands alone."""

    request: LogLine | None = None
    answer: LogLine | None = None
    texts: tuple[LogLine, ...] = ()

    @property
    def numbers(self) -> frozenset[int]:
        """Numbers of its lines; empty where it is one line only."""
        lines = [line for line in (self.request, self.answer, *self.texts) if line is not None]
        return frozenset(line.number for line in lines) if len(lines) > 1 else frozenset()


def find_group(lines: Sequence[LogLine], marked: LogLine) -> LogGroup:
    """Return what belongs to the marked line; `lines` are all lines in their order."""
    reach = ANSWER_WITHIN + TEXT_WITHIN
    near = [line for line in lines if marked.time - reach <= line.time and first_time(line) <= marked.time + reach]
    answer = _answer_of(near, marked)
    if answer is None:
        return LogGroup()
    texts = tuple(line for line in near if line.label == TEXT and _explains(line, answer))
    return LogGroup(_request_of(near, answer), answer, texts)


def _answer_of(near: Sequence[LogLine], marked: LogLine) -> LogLine | None:
    answers = [line for line in near if line.label == ANSWER]
    if marked.label == ANSWER:
        return marked
    if marked.label == TEXT:
        found = [line for line in answers if _explains(marked, line)]
        return min(found, key=lambda line: _distance(marked, line), default=None)
    return next((line for line in answers if _request_of(near, line) == marked), None)


def _request_of(near: Sequence[LogLine], answer: LogLine) -> LogLine | None:
    """Return the newest request with the words of the answer, else the `:` line of which it is the first answer."""
    before = [line for line in near if _may_have_caused(line, answer)]
    named = [line for line in before if line.label in REQUESTS and _names(line, answer)]
    if named:
        return named[-1]
    last = next((line for line in reversed(before) if line.label == ANSWER or _is_typed(line)), None)
    return last if last is not None and _is_typed(last) else None


def _may_have_caused(line: LogLine, answer: LogLine) -> bool:
    return line.number < answer.number and first_time(answer) - line.time <= ANSWER_WITHIN


def _is_typed(line: LogLine) -> bool:
    return line.label == COMMAND_LINE and line.text.startswith(":")


def _names(request: LogLine, answer: LogLine) -> bool:
    wanted = request.text.removeprefix(":").lower()
    heads = (answer.text.lower(), answer.text.lower().partition(": ")[2])
    return any(head == wanted or head.startswith((f"{wanted} ", f"{wanted}:")) for head in heads)


def _explains(text: LogLine, answer: LogLine) -> bool:
    same = text.origin is None or answer.origin is None or text.origin.system == answer.origin.system
    return same and _distance(text, answer) <= TEXT_WITHIN


def _distance(text: LogLine, answer: LogLine) -> float:
    return min(_apart(text.time, answer), _apart(first_time(text), answer))


def _apart(at: float, line: LogLine) -> float:
    return min(abs(at - line.time), abs(at - first_time(line)))
