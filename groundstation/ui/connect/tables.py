"""Values of the tables of the Connect screen: heard vehicles, recent endpoints, serial ports, simulators."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

from groundstation.recent.recent import RecentEndpoint
from groundstation.sitl.simulators import SIMULATORS
from groundstation.ui.base.local_files import LocalFile
from groundstation.ui.files.log_summary import LogSummary
from groundstation.ui.files.tables import size_text, summary_cells
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, TEXT, WHITE, YELLOW
from groundstation.ui.widgets.columns import Column
from groundstation.ui.widgets.row_table import Cell, RowTableValue, dim
from groundstation.views.connect import ConnectView, HeardRow, PortRow
from link.runtime.wsl import SERIAL_HINT

HEARD_COLUMNS = (
    Column("id", 3, right=True),
    Column("vehicle", 17, most=24),
    Column("mode", 9, most=12),
    Column("state", 9),
    Column("where from", 22, 1, most=44),
    Column("link", 15, 4, most=18),
    Column("heard", 6, 2, right=True),
    Column("control", 12, 5),
)

RECENT_COLUMNS = (
    Column("", 1),
    Column("endpoint", 26, most=34),
    Column("vehicle", 15, 2, most=20),
    Column("used", 12, 1, right=True),
)

PORT_COLUMNS = (Column("port", 12), Column("what", 10, 1, most=40), Column("state", 14, right=True))

LOG_COLUMNS = (
    Column("log", 24, most=34),
    Column("length", 7, 1, right=True),
    Column("driven", 7, 1, right=True),
    Column("size", 9, 3, right=True),
    Column("changed", 12, 2, right=True),
)

SIMULATOR_COLUMNS = (Column("key", 1), Column("simulator", 12), Column("what", 16, 1))

DAY = 86400.0

NO_SUMMARIES: Mapping[str, LogSummary | None] = {}


def heard_value(view: ConnectView | None, cursor: int | None) -> RowTableValue:
    """Return the table of what is heard."""
    if view is None:
        return RowTableValue(HEARD_COLUMNS, notes=(dim("waiting for the station"),))
    return RowTableValue(HEARD_COLUMNS, tuple(map(_heard, view.heard)), cursor, tuple(_heard_notes(view)))


def _heard(each: HeardRow) -> tuple[Cell, ...]:
    if each.announced:
        return _announced(each)
    control = "--" if each.driver is None else "nobody" if each.driver == 0 else f"by {each.driver}"
    flow = f"{each.rate:.0f}/s {each.bytes_per_second / 1000:.1f} kB/s" if each.rate else "open" if each.open else "--"
    host, port = each.address.rpartition(":")[0], each.endpoint.rpartition(":")[2]
    place = f"{host} to udp {port}" if each.address else each.endpoint
    return (
        Cell(str(each.system), WHITE, bold=True),
        Cell(each.name, WHITE if each.open else TEXT, bold=each.open),
        Cell(each.mode, AMBER if each.mode == "HOLD" else GREEN if each.mode == "MANUAL" else YELLOW),
        Cell("ARMED" if each.armed else "disarmed", AMBER if each.armed else TEXT),
        dim(place),
        Cell(flow, GREEN if each.open else DIM),
        dim(f"{each.silence:.1f} s" if each.silence < 100 else "long"),
        dim(control),
    )


def _announced(each: HeardRow) -> tuple[Cell, ...]:
    """Return the row of a vehicle that announces itself: all else is known once it is connected."""
    return (
        Cell(str(each.system or "--"), WHITE, bold=True),
        Cell(each.name, TEXT),
        dim("--"),
        dim("announced"),
        dim(each.endpoint.partition(":")[2]),
        dim("mDNS"),
        dim("--"),
        dim("--"),
    )


def _heard_notes(view: ConnectView) -> list[Cell]:
    notes = [Cell(f"{row.endpoint}: {row.problem}", AMBER) for row in view.listening if row.problem]
    free = [row.endpoint.removeprefix("udpin:") for row in view.listening if not row.problem]
    if not view.heard:
        where = f" on {' and '.join(free)}" if free else ""
        notes.append(dim(f"nothing heard{where} · ENTER starts a simulated rover"))
    elif any(not row.open and not row.announced for row in view.heard):
        notes.append(dim("a heartbeat is enough to be listed; nothing is sent to it before ENTER"))
    if view.search_problem:
        notes.append(Cell(view.search_problem, AMBER))
    elif view.searching:
        notes.append(dim("searching the network for vehicles that announce themselves"))
    for attempt in view.attempts:
        if attempt.state == "failed":
            again = "" if attempt.retry_in is None else f"; next try in {attempt.retry_in:.0f} s"
            notes.append(Cell(f"{attempt.endpoint}: {attempt.problem}{again}", AMBER))
    return notes


def recent_value(entries: Sequence[RecentEndpoint], opened: Sequence[str], cursor: int | None) -> RowTableValue:
    """Return the table of the endpoints used before; `opened` are those of open links."""
    rows = tuple(
        (
            Cell("*" if each.pinned else "", YELLOW, bold=True),
            Cell(each.endpoint, GREEN if each.endpoint in opened else TEXT),
            dim(each.vehicle),
            dim("open" if each.endpoint in opened else used_text(each.used)),
        )
        for each in entries
    )
    notes = () if rows else (dim("endpoints that you open are listed here"),)
    return RowTableValue(RECENT_COLUMNS, rows, cursor, notes, titled=False)


def used_text(used: float, now: float | None = None) -> str:
    """Return when an endpoint was used, in the local time of this machine."""
    now = time.time() if now is None else now
    then, today = time.localtime(used), time.localtime(now)
    if then[:3] == today[:3]:
        return time.strftime("today %H:%M", then)
    if time.localtime(now - DAY)[:3] == then[:3]:
        return "yesterday"
    return time.strftime("%b %d" if then.tm_year == today.tm_year else "%Y-%m-%d", then)


def ports_value(
    ports: Sequence[PortRow], opened: Sequence[str], baud: int, cursor: int | None, *, wsl: bool = False
) -> RowTableValue:
    """Return the table of the serial ports; ENTER opens the one under the cursor with this baud rate.

    `wsl`: Windows has the ports until one is attached.
    """
    rows = tuple(_port(each, opened, baud if number == cursor else None) for number, each in enumerate(ports))
    notes = [dim(SERIAL_HINT if wsl else "plug one in: it appears here")]
    if cursor is not None and cursor < len(ports):
        notes = [*_port_notes(ports[cursor]), dim("b changes the baud rate")]
    return RowTableValue(PORT_COLUMNS, rows, cursor, tuple(notes), titled=False)


def _port(each: PortRow, opened: Sequence[str], baud: int | None) -> tuple[Cell, ...]:
    open_as = next((text for text in opened if text.startswith(f"serial:{each.path}:")), "")
    state = Cell(str(baud) if baud else "", TEXT)
    if open_as:
        state = Cell(f"{open_as.rpartition(':')[2]} open ✓", GREEN)
    elif each.holder:
        state = Cell("in use: yours" if each.station else f"in use: {each.holder.partition(' ')[0]}", AMBER)
    elif not each.allowed:
        state = Cell("not allowed", AMBER)
    return Cell(each.path, WHITE if baud else TEXT, bold=True), dim(each.description or each.driver or each.ids), state


def _port_notes(each: PortRow) -> list[Cell]:
    facts = " · ".join(filter(None, (each.description, each.ids, each.driver)))
    notes = [dim(facts)] if facts else []
    if each.station:
        notes.append(Cell(f"a station of yours ({each.station}) has it open: mavhelm attach", AMBER))
    elif each.holder:
        notes.append(Cell(f"{each.holder} has it open: stop it first", AMBER))
    elif not each.allowed:
        notes.append(Cell("your user may not open it: sudo usermod -a -G dialout $USER, then log in again", AMBER))
    return notes


def logs_value(
    logs: Sequence[LocalFile], cursor: int | None, summaries: Mapping[str, LogSummary | None] = NO_SUMMARIES
) -> RowTableValue:
    """Return the table of the logs that are here: how long each is, and for how long a vehicle drove in it.

    `summaries` are by the name of the file: one that is being written is another `LocalFile` with each line.
    """
    rows = tuple(
        (
            Cell(each.name),
            *summary_cells(summaries.get(each.name))[1:],
            dim(size_text(each.size)),
            dim(used_text(each.changed)),
        )
        for each in logs
    )
    notes = (dim("logs of your sessions, and those that you download, are listed here"),) if not rows else ()
    return RowTableValue(LOG_COLUMNS, rows, cursor, notes)


def simulators_value(cursor: int | None, state: str | None) -> RowTableValue:
    """Return the table of the simulators; `state` is that of the one that runs."""
    rows = tuple((Cell(each.key, YELLOW, bold=True), Cell(each.label), dim(each.help)) for each in SIMULATORS)
    running = Cell(f"simulator: {state}", BLUE if state == "running" else AMBER) if state else None
    notes = [running] if running else [dim("it ends when this station ends")]
    return RowTableValue(SIMULATOR_COLUMNS, rows, cursor, tuple(notes), titled=False)
