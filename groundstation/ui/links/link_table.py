"""Link table of the Links screen: one row per link, and below it what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.display.wrap import wrap
from groundstation.ui.links.vehicle_table import age_text
from groundstation.ui.look.colours import AMBER, DIM, GREEN, RED, TEXT, style
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, strip
from groundstation.views.links import LinkRow, LinksView

COLUMNS = (
    Column("", 2),
    Column("endpoint", 21, most=34),
    Column("peer", 16, 5, most=26),
    Column("in/s", 5, 1, right=True),
    Column("out/s", 5, 1, right=True),
    Column("kB/s", 5, 2, right=True),
    Column("loss", 6, 1, right=True),
    Column("lost", 5, 3, right=True),
    Column("bad", 4, 3, right=True),
    Column("refused", 7, 6, right=True),
    Column("unsent", 6, 7, right=True),
    Column("rtt", 6, 1, right=True),
    Column("age", 5, 1, right=True),
    Column("jitter", 6, 8, right=True),
    Column("line", 4, 4, right=True),
)

MUCH_LOSS, SLOW_TRIP, FULL_LINE = 0.02, 0.2, 0.6
"""Loss, round trip in s and share of a line from which on they are amber: above 60 % of a serial line the queues of
the vehicle grow."""
OLD = 1.5
"""s of age from which on it is amber: longer than from one heartbeat to the next."""


class LinkTableValue(msgspec.Struct, frozen=True):
    """The links, and the first of the lines below the titles that is shown."""

    view: LinksView | None = None
    """None until the first one has arrived."""
    top: int = 0
    cursor: int | None = None
    """Index of the link under the cursor; None: the cursor is in another panel."""


class LinkTable(Instrument[LinkTableValue]):
    """Figures in columns, problems in whole lines."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the titles and the lines from `top` on."""
        view = self.value.view
        if view is None or not view.rows:
            text = "waiting for the station" if view is None else "no link yet"
            return [strip((f" {text}", style(DIM))).crop(0, width)]
        widths = fit(COLUMNS, width)
        return [header(COLUMNS, widths), *self._lines(width)[self.value.top :][: height - 1]]

    def wanted(self, width: int) -> int:
        """Return how many lines everything needs."""
        return 1 + len(self._lines(width))

    def _lines(self, width: int) -> list[Strip]:
        rows = self.value.view.rows if self.value.view else ()
        widths = fit(COLUMNS, width)
        cursor = self.value.cursor
        several = sum(link.age is not None for link in rows) > 1
        return [
            line
            for link in rows
            for line in (
                _row(link, widths, marked=link.index == cursor, counts=several and link.counts),
                *_remarks(link, width),
            )
        ]

    def line_of(self, index: int, width: int) -> int:
        """Return the line of a link, counted from the first one below the titles."""
        line = 0
        for link in self.value.view.rows if self.value.view else ():
            if link.index == index:
                break
            line += 1 + len(list(_remarks(link, width)))
        return line


def _row(link: LinkRow, widths: tuple[int, ...], *, marked: bool, counts: bool) -> Strip:
    loss, jitter, share = map(finite_or_none, (link.loss, link.jitter, link.share))
    heard = link.frames_in > 0
    mark, colour = ("✗", RED) if link.problem else ("★" if counts else "●", GREEN) if heard else ("·", DIM)
    return row(
        COLUMNS,
        widths,
        [
            (f"{'›' if marked else ' '}{mark}", style(colour, bold=True)),
            (link.name, style(RED if link.problem else TEXT)),
            (_peers(link), style(DIM)),
            (f"{link.frames_in:.0f}", style(TEXT if heard else DIM)),
            (f"{link.frames_out:.0f}", style(TEXT if link.frames_out else DIM)),
            (f"{(link.bytes_in + link.bytes_out) / 1000:.1f}", style(TEXT if heard else DIM)),
            ("--" if loss is None else f"{100 * loss:.1f}%", _warn(loss, MUCH_LOSS)),
            _count(link.lost, DIM),
            _count(link.crc_errors, AMBER),
            _count(link.refused, AMBER),
            _count(link.dropped, AMBER),
            _trip(link.round_trip),
            _age(link.age),
            ("--" if jitter is None else f"±{1000 * jitter:.1f}", style(DIM if jitter is None else TEXT)),
            ("--" if share is None else f"{100 * share:.0f}%", _warn(share, FULL_LINE)),
        ],
    )


def _remarks(link: LinkRow, width: int) -> Iterator[Strip]:
    """Yield the lines below a row: its problem whole, and a line that is nearly full."""
    for path in link.more:
        trip, age = _trip(path.round_trip)[0], _age(path.age)[0]
        yield strip((f"    also from {path.address}: round trip {trip}, age {age}", style(DIM))).crop(0, width)
    for line in wrap(link.problem or "", width - 4):
        if line:
            yield strip((f"    {line}", style(RED)))
    if link.unverified:
        yield strip((f"    signing has refused frames: {link.unverified}", style(AMBER))).crop(0, width)
    if link.retry_in is not None:
        yield strip((f"    next try in {link.retry_in:.0f} s", style(AMBER)))
    if link.watch_only:
        yield strip(("    watch only: nothing is sent", style(AMBER)))
    share = finite_or_none(link.share)
    if link.capacity and share is not None and (share >= FULL_LINE or link.headroom < 1.0):
        radio = f", the radio allows {100 * link.headroom:.0f}%" if link.headroom < 1.0 else ""
        text = f"    {100 * share:.0f}% of {link.capacity / 1000:.1f} kB/s each way{radio}"
        yield strip((text, style(AMBER))).crop(0, width)


def _count(number: int, colour: str) -> Part:
    return (str(number) if number < 100_000 else f"{number // 1000}k"), style(colour if number else DIM)


def _trip(seconds: float | None) -> Part:
    trip = finite_or_none(seconds)
    return ("--" if trip is None else f"{1000 * trip:.0f} ms"), _warn(trip, SLOW_TRIP)


def _age(seconds: float | None) -> Part:
    age = finite_or_none(seconds)
    return ("--" if age is None else age_text(age)), _warn(age, OLD)


def _warn(value: float | None, limit: float) -> Style:
    return style(DIM if value is None else AMBER if value >= limit else TEXT)


def _peers(link: LinkRow) -> str:
    if not link.peers:
        return "connected" if link.peer_count else "nobody yet"
    more = link.peer_count - 1
    return f"{link.peers[0]} +{more}" if more > 0 else link.peers[0]
