"""The view of the Replay screen, built from an index, a player and what is being done."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from groundstation.replay.events import EventList, LogEvent
from groundstation.replay.log_check import LogCheck
from groundstation.replay.log_index import LogIndex
from groundstation.replay.log_search import LogSearch
from groundstation.replay.player import ReplayPlayer
from groundstation.replay.source import LogSource
from groundstation.views.replay import (
    MAX_COLUMNS,
    MAX_ROWS,
    ReplayEvent,
    ReplayRequest,
    ReplaySign,
    ReplaySpan,
    ReplayView,
    Timeline,
)

MAX_SPANS = 300
_SIGNS = ("ARM", "FAIL", "LINK", "CLOCK", "DAMAG", "TEXT", "ITEM", "ACK")
"""Kinds that have a sign on the timeline; of texts and answers only warnings and worse."""
WARNING = 4


class OpenLog(Protocol):
    """What a picture is built from: a LogReplay."""

    name: str
    path: str
    source: LogSource
    index: LogIndex
    check: LogCheck
    player: ReplayPlayer
    search: LogSearch | None
    note: str
    notes: int


def build_view(log: OpenLog, request: ReplayRequest) -> ReplayView:
    """Return the view for a request."""
    index, player, findings = log.index, log.player, log.index.findings
    events = findings.finder.events
    current = events.place(player.position, after=True) - 1
    top = _top(request, current, len(events))
    rows = max(1, min(request.rows, MAX_ROWS))
    return ReplayView(
        file=log.name,
        path=log.path,
        size=log.source.size,
        began=index.clock.wall(0.0),
        ended=index.clock.wall(index.duration),
        messages=index.frames,
        position=player.position,
        wall=index.clock.wall(player.position),
        duration=index.duration,
        playing=player.playing,
        backwards=player.backwards,
        speed=player.speed,
        marks=player.marks,
        cut=(_cut(index, player.marks[0]), _cut(index, player.marks[1])),
        loop=player.loop,
        indexed=index.progress,
        checked=log.check.progress,
        damaged=index.damaged + log.check.damaged,
        tail=index.tail,
        lost=log.check.lost,
        stations=tuple(sorted({system for system, _ in findings.finder.stations})),
        vehicles=tuple(sorted(findings.finder.vehicles)),
        timeline=build_timeline(index, request.columns),
        events=tuple(_event(event, index) for event in events.slice(top, rows)),
        top=top,
        total=len(events),
        current=current,
        current_event=_event(events[current], index) if current >= 0 else None,
        searching="" if log.search is None else log.search.query.text,
        note=log.note,
        notes=log.notes,
    )


def _cut(index: LogIndex, mark: float | None) -> float | None:
    return None if mark is None else index.clock.wall(mark) - index.clock.wall(0.0)


def _top(request: ReplayRequest, current: int, total: int) -> int:
    rows = max(1, min(request.rows, MAX_ROWS))
    top = current - rows // 2 if request.top is None else request.top
    return max(0, min(top, total - rows))


def _event(event: LogEvent, index: LogIndex) -> ReplayEvent:
    return ReplayEvent(event.time, index.clock.wall(event.time), event.kind, event.severity, event.text)


def build_timeline(index: LogIndex, columns: int) -> Timeline:
    """Return what happened over the log, in so many columns."""
    findings, end = index.findings, index.duration
    columns = max(1, min(columns, MAX_COLUMNS))
    events = findings.finder.events
    system = min(findings.finder.vehicles, default=0)
    return Timeline(
        modes=_spans(events, "MODE", system, end),
        armed=tuple(span for span in _spans(events, "ARM", system, end) if span.text == "armed"),
        speed=findings.speed.columns(columns, end),
        demand=findings.demand.columns(columns, end),
        lost=findings.lost.columns(columns, end),
        damage=findings.damage.columns(columns, end),
        signs=tuple(_signs(events, columns, end)),
    )


def _spans(events: EventList, kind: str, system: int, end: float) -> tuple[ReplaySpan, ...]:
    """Return how long each mode, or armed, lasted. Of very many only the longest are drawn."""
    changes = [event for event in events if event.kind == kind and event.system == system]
    ends = [*(event.time for event in changes[1:]), end]
    spans = [
        ReplaySpan(event.time, until, event.text.rpartition("→")[2].strip())
        for event, until in zip(changes, ends, strict=False)
    ]
    longest = sorted(spans, key=lambda span: span.start - span.end)[:MAX_SPANS]
    return tuple(sorted(longest, key=lambda span: span.start))


def _signs(events: EventList, columns: int, end: float) -> Iterator[ReplaySign]:
    """Yield the most severe event of each column."""
    best: dict[int, LogEvent] = {}
    for event in events:
        if event.kind not in _SIGNS or (event.kind in ("TEXT", "ACK") and event.severity > WARNING):
            continue
        column = min(columns - 1, int(event.time / end * columns)) if end > 0 else 0
        if column not in best or event.severity < best[column].severity:
            best[column] = event
    for column, event in sorted(best.items()):
        yield ReplaySign(column, event.kind, event.severity, event.text[:40])
