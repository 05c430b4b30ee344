"""Values of the tables of the Files screen: logs of the vehicle, its file tree, files here, tasks."""

from __future__ import annotations

import time

from groundstation.intents.files import DIFFERS
from groundstation.ui.base.local_files import LocalFile
from groundstation.ui.display.task_list import TaskList
from groundstation.ui.files.log_summary import LogSummary
from groundstation.ui.files.model import PART, FilesModel, FilesPanel
from groundstation.ui.files.tree import TreeRow
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, WHITE
from groundstation.ui.widgets.columns import Column
from groundstation.ui.widgets.row_table import Cell, RowTableValue, dim
from groundstation.views.files import VehicleLog
from groundstation.views.requests import RequestLine

LOG_COLUMNS = (
    Column("id", 4, right=True),
    Column("begun (vehicle clock)", 21, 1),
    Column("size", 8, right=True),
    Column("here", 18, most=60),
)
TREE_COLUMNS = (Column("", 24, most=36), Column("", 16, 2, most=40), Column("", 8, 1, right=True))
SUMMARY_COLUMNS = (
    Column("vehicle", 10, 3),
    Column("length", 8, 2, right=True),
    Column("driven", 7, 2, right=True),
    Column("size", 9, right=True),
    Column("changed", 16, 1),
)
"""Columns of each list of logs behind the name; `summary_cells` fills the first three."""
HERE_COLUMNS = (Column("file", 24, most=44), *SUMMARY_COLUMNS, Column("", 14, most=44))
TASK_COLUMNS = (
    Column("", 22, most=40),
    Column("", 10, 2, most=20),
    Column("", 4, right=True),
    Column("", 28, 1, most=90),
)

_BLANK = Cell("")
_LOG_NOTES = (
    _BLANK,
    dim("D downloads, also the rest of a part · X erases all of them"),
    dim("downloads wait while you drive over a slow line"),
)
_TREE_NOTES = (
    _BLANK,
    dim("D downloads · U uploads into it · C compares with here · X deletes"),
)
_HERE_NOTES = (_BLANK, dim("U uploads · E exports · C compares with the file marked there · X deletes"))
BYTES = frozenset({"files", "export"})
"""Services whose progress is counted in bytes."""
_MARKS = {"accepted": ("✓", GREEN), "cancelled": ("·", DIM)}


def size_text(size: float) -> str:
    """Return a number of bytes as people read it."""
    for unit, factor in (("MB", 1e6), ("kB", 1e3)):
        if size >= 0.9995 * factor:
            return f"{size / factor:.1f} {unit}"
    return f"{size:.0f} B"


def logs_value(model: FilesModel) -> RowTableValue:
    """Return the logs of the vehicle."""
    view = model.view
    if view is None or view.logs is None:
        text = "no vehicle yet" if view is None else "reading the list of the logs"
        return RowTableValue(LOG_COLUMNS, notes=(dim(text),))
    rows = tuple(_log(each, model) for each in model.logs)
    notes = _LOG_NOTES if rows else (dim("no logs: the vehicle has none, or keeps none (a simulation without --tlog)"),)
    return RowTableValue(LOG_COLUMNS, rows, model.shown_cursor(FilesPanel.LOGS), notes)


def _log(log: VehicleLog, model: FilesModel) -> tuple[Cell, ...]:
    begun = time.strftime("%Y-%m-%d %H:%M", time.gmtime(log.begun)) if log.begun else "had no clock"
    number = Cell(str(log.number), WHITE, bold=True)
    return number, Cell(begun, TEXT if log.begun else DIM), Cell(size_text(log.size)), _here(log, model)


def _here(log: VehicleLog, model: FilesModel) -> Cell:
    """Return whether a log is here, all or a part of it, or on its way."""
    name = model.log_name(log.number)
    line = model.tasks.find(f"download log {log.number}", model.view.system if model.view else 0)
    if line is not None:
        return Cell(" ".join(filter(None, (percent_text(line), progress_text(line, model.tasks)))), BLUE)
    if model.disk.find(name) is not None:
        return Cell(f"✓ {name}", GREEN)
    part = model.disk.find(name + PART)
    if part is not None:
        share = f", {100 * part.size / log.size:.0f}%" if log.size else ""
        return Cell(f"part{share}: D goes on", AMBER)
    return dim("")


def tree_value(model: FilesModel) -> RowTableValue:
    """Return the tree of the files of the vehicle."""
    if model.view is None:
        return RowTableValue(TREE_COLUMNS, notes=(dim("no vehicle yet"),))
    tree = model.tree
    if tree[0].problem:
        notes = (
            Cell(f"{model.view.name} has no file service: {tree[0].problem}", AMBER),
            dim("logs work without it · R tries again"),
        )
        return RowTableValue(TREE_COLUMNS, notes=notes)
    rows = tuple(_node(each) for each in tree)
    return RowTableValue(TREE_COLUMNS, rows, model.shown_cursor(FilesPanel.TREE), _TREE_NOTES, titled=False)


def _node(each: TreeRow) -> tuple[Cell, ...]:
    indent = "  " * each.depth
    if each.size is not None:
        return Cell(f"{indent}  {each.name}"), dim(""), dim(size_text(each.size))
    note = each.problem or ("reading" if each.opened and each.count is None else "")
    count = "" if each.count is None else "empty" if not each.count else f"{each.count} inside"
    mark = "▾" if each.opened else "▸"
    cell = Cell(note, AMBER) if each.problem else dim(note or count)
    return Cell(f"{indent}{mark} {each.name}", BLUE, bold=True), cell, dim("")


def here_value(model: FilesModel) -> RowTableValue:
    """Return the files of this machine."""
    rows = tuple(_local(each, model) for each in model.here)
    notes = _HERE_NOTES if rows else (dim("nothing here yet"),)
    recording = model.disk.recording
    if recording is not None and recording.path and not any(map(model.disk.is_recorded, model.here)):
        elsewhere = f"● {recording.path}: {length_text(recording.seconds)}, {size_text(recording.size)}"
        notes = (*notes, Cell(elsewhere, RED))
    return RowTableValue(HERE_COLUMNS, rows, model.shown_cursor(FilesPanel.HERE), notes)


def _local(each: LocalFile, model: FilesModel) -> tuple[Cell, ...]:
    part = each.name.endswith(PART)
    changed = time.strftime("%Y-%m-%d %H:%M", time.localtime(each.changed))
    vehicle, length, driven = summary_cells(model.disk.summaries.get(each))
    name = Cell(each.name, AMBER if part else TEXT)
    if model.disk.recording is not None and model.disk.is_recorded(each):
        size, seconds = size_text(model.disk.recording.size), length_text(model.disk.recording.seconds)
        return name, vehicle, Cell(seconds), dim(""), Cell(size), dim(changed), Cell("● being recorded", RED)
    size = size_text(each.size)
    return name, vehicle, length, driven, Cell(size), dim(changed), _local_note(each, model, part)


def summary_cells(found: LogSummary | None) -> tuple[Cell, Cell, Cell]:
    """Return of which vehicles a log is, how long, and for how long they drove."""
    if found is None:
        return dim(""), dim(""), dim("")
    systems = " ".join(map(str, found.systems))
    length = Cell("--" if found.length is None else length_text(found.length))
    return dim(f"id {systems}" if systems else "--"), length, _driven(found)


def _driven(found: LogSummary) -> Cell:
    if found.driven:
        return Cell(length_text(found.driven), GREEN)
    if found.armed:
        return Cell("armed", AMBER)
    return dim("" if found.armed is None else "no")


def length_text(seconds: float) -> str:
    """Return hours, minutes and seconds."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02}:{rest:02}" if minutes >= 60 else f"{minutes}:{rest:02}"


def _local_note(each: LocalFile, model: FilesModel, part: bool) -> Cell:
    """Return how the last comparison ended, or that a file is the beginning of one."""
    compared = model.disk.comparison_of(each)
    if compared:
        return Cell(f"✗ {compared}", RED) if compared.startswith(DIFFERS) else Cell(f"✓ {compared}", GREEN)
    return Cell("part: D goes on", AMBER) if part else dim("")


def tasks_value(tasks: TaskList, cursor: int | None) -> RowTableValue:
    """Return what runs and what has just ended."""
    rows = tuple(_task(line, tasks) for line in tasks.lines)
    notes = (dim("downloads and uploads are listed here; they go on when you leave this screen"),) if not rows else ()
    return RowTableValue(TASK_COLUMNS, rows, cursor, notes, titled=False)


def _task(line: RequestLine, tasks: TaskList) -> tuple[Cell, ...]:
    if line.state == "running":
        share = line.done / line.total if line.total else 0.0
        text = Cell(line.waits, AMBER) if line.waits else dim(progress_text(line, tasks))
        return Cell(line.what), Cell("", AMBER if line.waits else BLUE, bar=share), Cell(percent_text(line)), text
    mark, colour = _MARKS.get(line.state, ("✗", RED))
    detail = line.detail or ("what arrived is kept" if line.state == "cancelled" else "")
    if detail.startswith(DIFFERS):
        mark, colour = "✗", RED
    return dim(line.what), dim(line.state), Cell(mark, colour, bold=True), Cell(detail, RED if colour == RED else TEXT)


def percent_text(line: RequestLine) -> str:
    """Return how far a request is."""
    return f"{100 * line.done / line.total:.0f}%" if line.total else "--"


def progress_text(line: RequestLine, tasks: TaskList) -> str:
    """Return how fast a request goes, and for how long yet."""
    speed = tasks.speed(line)
    if speed is None:
        return "asked" if not line.done else ""
    if line.service not in BYTES:
        return f"{line.done} of {line.total or '?'}"
    left = "" if speed.left is None else f"  {speed.left:.0f} s left" if speed.left < 6000 else "  hours left"
    return f"{size_text(speed.per_second)}/s{left}{f'  {line.detail}' if line.detail else ''}"
