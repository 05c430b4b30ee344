"""Values of the tables of the Replay screen: the events of a log, and the logs that are here."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

from groundstation.ui.base.local_files import LocalFile
from groundstation.ui.files.log_summary import LogSummary
from groundstation.ui.files.tables import SUMMARY_COLUMNS, size_text, summary_cells
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, WHITE, YELLOW
from groundstation.ui.replay.model import ReplayModel, event_time
from groundstation.ui.widgets.columns import Column
from groundstation.ui.widgets.row_table import Cell, RowTableValue, dim
from groundstation.views.replay import ReplayEvent

COLUMNS = (Column("", 10), Column("", 5), Column("", 12, most=200))
FILE_COLUMNS = (Column("log", 24, most=60), *SUMMARY_COLUMNS)

WARNING, ERROR = 4, 3
"""MAV_SEVERITY."""

_COLOURS = {
    "MODE": BLUE, "ARM": YELLOW, "FAIL": RED, "TEXT": BLUE, "CMD": TEXT, "ACK": GREEN, "KEY": YELLOW, "ITEM": BLUE,
    "LINK": AMBER, "CLOCK": AMBER, "DAMAG": RED, "GCS": TEXT,
}  # fmt: skip


def events_value(model: ReplayModel) -> RowTableValue:
    """Return the events of the newest view; those that are still to come are dim."""
    view = model.view
    if view is None or not view.events:
        return RowTableValue(COLUMNS, notes=(dim("reading the log" if view is None else "no events"),))
    rows = tuple(_row(event, view.position) for event in view.events)
    chosen = model.chosen
    cursor = None if chosen is None or chosen < view.top else chosen - view.top
    return RowTableValue(COLUMNS, rows, cursor if cursor is not None and cursor < len(rows) else None, titled=False)


def _row(event: ReplayEvent, position: float) -> tuple[Cell, ...]:
    ahead = event.time > position
    colour = kind_colour(event.kind, event.severity)
    tag = Cell(event.kind, DIM if ahead and event.severity > WARNING else colour, bold=event.severity <= WARNING)
    text = Cell(event.text, DIM if ahead else RED if event.severity < ERROR else TEXT)
    return Cell(event_time(event), DIM), tag, text


def kind_colour(kind: str, severity: int) -> str:
    """Return the colour of an event."""
    if severity < ERROR:
        return RED
    return AMBER if severity <= WARNING else _COLOURS.get(kind, TEXT)


def logs_value(
    logs: Sequence[LocalFile],
    summaries: Mapping[LocalFile, LogSummary | None],
    cursor: int | None = None,
    hidden: int = 0,
) -> RowTableValue:
    """Return the telemetry logs of the folder, for a screen without an open log; `hidden` more are not listed."""
    rows = tuple(
        (
            Cell(each.name, WHITE),
            *summary_cells(summaries.get(each)),
            Cell(size_text(each.size)),
            dim(time.strftime("%Y-%m-%d %H:%M", time.localtime(each.changed))),
        )
        for each in logs
    )
    how = "ENTER opens the marked one" if rows else "there is none here"
    notes: tuple[Cell, ...] = (dim(f"no log is open: {how}; `mavhelm replay FILE` opens any"),)
    if hidden:
        notes += (dim(f"not listed: {hidden} below 30 s in which nothing was armed; Files (^g 9) has all"),)
    return RowTableValue(FILE_COLUMNS, rows, cursor if rows else None, notes)
