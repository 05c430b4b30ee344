"""Live table of links and routes on a terminal."""

from __future__ import annotations

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from link.bridge.status import BridgeStatus, LinkStatus, RouteStatus

LINK_COLUMNS = (
    "link", "peers", "in\n/s", "in\nB/s", "out\n/s", "out\nB/s", "loss", "CRC", "noise\nB", "unknown", "dropped",
)  # fmt: skip
ROUTE_COLUMNS = ("system", "component", "link", "address", "/s", "lost", "silent")
NAMED = ("link", "address")
NAME_WIDTH = 14
"""Least width of a name, which may take several lines: so all columns fit into 80."""
QUIET_AFTER = 3.0
"""s of silence that are highlighted: three missing heartbeats."""


class LiveTable:
    """Draws on `console` until close()."""

    def __init__(self, console: Console) -> None:
        self._live = Live(console=console, auto_refresh=False)
        self._live.start()

    def update(self, status: BridgeStatus) -> None:
        """Draw a new status."""
        self._live.update(build_tables(status), refresh=True)

    def close(self) -> None:
        """Leave the last table on the screen and restore the terminal."""
        self._live.stop()


def build_tables(status: BridgeStatus) -> Group:
    """Build both tables, with the problems below them."""
    problems = [link.problem for link in status.links] + [status.recorder_problem]
    lines = [Text(problem, style="red") for problem in problems if problem]
    return Group(_links(status), _routes(status), *lines)


def _links(status: BridgeStatus) -> Table:
    table = _table("links", LINK_COLUMNS)
    for link in status.links:
        table.add_row(*_link(link), style="red" if link.problem else None)
    return table


def _link(link: LinkStatus) -> list[Text]:
    rates = (link.frames_in_per_s, link.bytes_in_per_s, link.frames_out_per_s, link.bytes_out_per_s)
    counts = (link.crc_errors, link.noise_bytes, link.unknown, link.dropped)
    cells = [link.endpoint, str(link.peers), *map(format_count, rates), f"{link.loss:.1%}", *map(format_count, counts)]
    return [Text(cell) for cell in cells]


def format_count(number: float) -> str:
    """Format a count in at most five characters up to 10^13: 98765, 123k, 45.6M."""
    for unit, suffix in ((1.0, ""), (1e3, "k"), (1e6, "M"), (1e9, "G")):
        size = number / unit
        if size < 9999.5 or (not suffix and size < 99999.5):
            return f"{size:.1f}{suffix}" if suffix and size < 99.95 else f"{size:.0f}{suffix}"
    return f"{number:.0e}"


def _routes(status: BridgeStatus) -> Table:
    table = _table("routes", ROUTE_COLUMNS)
    for route in status.routes:
        table.add_row(*_route(route), style="yellow" if route.silence > QUIET_AFTER else None)
    if status.duplicates:
        table.caption = f"{status.duplicates} duplicate frames over redundant links"
    return table


def _route(route: RouteStatus) -> list[Text]:
    where = "" if route.address == route.endpoint else route.address
    numbers = (format_count(route.frames_per_s), format_count(route.lost), f"{route.silence:.1f} s")
    return [Text(cell) for cell in (str(route.system), str(route.component), route.endpoint, where, *numbers)]


def _table(title: str, columns: tuple[str, ...]) -> Table:
    table = Table(title=title, title_justify="left", box=None, padding=(0, 1, 0, 0))
    for column in columns:
        if column in NAMED:
            table.add_column(column, overflow="fold", min_width=NAME_WIDTH)
        else:
            table.add_column(column, justify="right", no_wrap=True)
    return table
