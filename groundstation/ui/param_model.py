"""What the Parameters screen shows: a page of the vehicle's parameters, and changes that are not sent yet.

Knows no widget. Changes are kept here until they are written, with the values that they replace, so that a write can be
undone by another one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from groundstation.intents.services import CancelRequest, FetchParams, WriteParams
from groundstation.intents.union import AnyIntent
from groundstation.ui.request_numbers import RequestNumbers
from groundstation.views.params import ParamPage, ParamPageRequest, ParamRow
from groundstation.views.requests import RequestLine

MAX_UNDO = 100
INTEGERS = ("UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32")


@dataclass(frozen=True, slots=True)
class PendingChange:
    """A value that is not sent yet."""

    name: str
    before: float
    value: float


@dataclass(frozen=True, slots=True)
class ParamTableValue:
    """What the table draws."""

    rows: tuple[ParamRow, ...] = ()
    selected: int | None = None
    """Index of the selected row in `rows`."""
    pending: tuple[PendingChange, ...] = ()
    note: str = ""
    """In place of rows, where there are none."""


class ParamModel:
    """The newest page, the selected row, and the pending changes."""

    def __init__(self, numbers: RequestNumbers) -> None:
        self._numbers = numbers
        self.page: ParamPage | None = None
        self.filter = ""
        self.changed_only = False
        self.pending: dict[str, PendingChange] = {}
        self._undo: list[dict[str, PendingChange]] = []
        self._top = self._selected = 0
        self._height = 1
        self._fetched: set[int] = set()
        """Systems whose parameters were requested by opening the screen."""
        self._writing: tuple[int, tuple[PendingChange, ...]] | None = None

    # ---- the page ----

    @property
    def request(self) -> ParamPageRequest:
        """The page to request."""
        return ParamPageRequest(self.filter, self.changed_only, self._top, self._height)

    def show_page(self, page: ParamPage) -> tuple[AnyIntent, ...]:
        """Take a page; return the intents that follow: parameters that are not known are fetched once."""
        if self.page is not None and self.page.known and not page.known:
            self._fetched.discard(page.system)  # the station has forgotten them: the vehicle was lost, or restarted
        if self.page is not None and page.system != self.page.system:
            self.pending, self._undo, self._writing = {}, [], None  # they were for another vehicle
        self.page = page
        self._selected = max(0, min(self._selected, page.matching - 1))
        self._finish_write(page)
        if page.known or page.running or page.system in self._fetched:
            return ()
        self._fetched.add(page.system)
        return (self.fetch(),)

    def set_height(self, rows: int) -> None:
        """Set how many rows fit."""
        self._height = max(1, rows)
        self._keep_selected_in_view()

    def move(self, rows: int) -> None:
        """Move the selection."""
        last = max(0, (self.page.matching if self.page else 0) - 1)
        self._selected = max(0, min(last, self._selected + rows))
        self._keep_selected_in_view()

    def set_filter(self, text: str, *, changed_only: bool | None = None) -> None:
        """Show other parameters, the first of them selected."""
        self.filter = text
        self.changed_only = self.changed_only if changed_only is None else changed_only
        self._top = self._selected = 0

    @property
    def selected(self) -> ParamRow | None:
        """The selected parameter, if its row has arrived."""
        page = self.page
        if page is None or not 0 <= self._selected - page.first < len(page.rows):
            return None
        return page.rows[self._selected - page.first]

    @property
    def table(self) -> ParamTableValue:
        """What the table shows."""
        page = self.page
        if page is None or not page.rows:
            return ParamTableValue(note=self._empty_note(page))
        index = self._selected - page.first
        selected = index if 0 <= index < len(page.rows) else None
        return ParamTableValue(page.rows, selected, tuple(self.pending.values()))

    def _empty_note(self, page: ParamPage | None) -> str:
        if page is None:
            return "no vehicle yet"
        if page.running:
            return "reading the parameters"
        return "nothing matches" if page.known else "no parameters: R reads them again"

    def _keep_selected_in_view(self) -> None:
        self._top = max(self._selected - self._height + 1, min(self._top, self._selected))

    # ---- changes ----

    def change(self, text: str) -> str | None:
        """Make the typed value of the selected parameter pending; return what is wrong with it."""
        row = self.selected
        if row is None:
            return "no parameter is selected"
        try:
            value = float(int(text, 16)) if text.lower().startswith("0x") else float(text)
        except (ValueError, OverflowError):
            return f"{text!r} is not a number"
        if not math.isfinite(value):
            return f"{text!r} cannot be set"
        if row.kind in INTEGERS and value != int(value):
            return f"{row.name} is {row.kind}: whole numbers only"
        self._set_pending(row, value)
        return None

    def change_to_default(self) -> str | None:
        """Make the default of the selected parameter pending; return why that cannot be done."""
        row = self.selected
        if row is None or row.default is None:
            return "this vehicle does not report the default"
        self._set_pending(row, row.default)
        return None

    def drop(self) -> None:
        """Drop the change of the selected parameter."""
        row = self.selected
        if row is not None and row.name in self.pending:
            self._remember()
            del self.pending[row.name]

    def undo(self) -> bool:
        """Go back one step; after a write the old values are pending again."""
        if not self._undo:
            return False
        self.pending = self._undo.pop()
        return True

    def _set_pending(self, row: ParamRow, value: float) -> None:
        self._remember()
        self.pending.pop(row.name, None)
        if value != row.value:
            self.pending[row.name] = PendingChange(row.name, row.value, value)

    def _remember(self) -> None:
        self._undo = [*self._undo[1 - MAX_UNDO :], dict(self.pending)]

    # ---- requests ----

    def fetch(self) -> AnyIntent:
        """Return the intent that reads all parameters again."""
        return FetchParams(self._numbers.take())

    def cancel(self) -> tuple[AnyIntent, ...]:
        """Return the intents that cancel what runs."""
        return tuple(CancelRequest(line.number) for line in self.page.running) if self.page else ()

    @property
    def may_write(self) -> bool:
        """There are pending changes, and none are being written."""
        return bool(self.pending) and self._writing is None and self.page is not None

    def write(self) -> tuple[AnyIntent, ...]:
        """Write the pending changes."""
        if not self.may_write or self.page is None:
            return ()
        changes, number = tuple(self.pending.values()), self._numbers.take()
        self._writing = number, changes
        return (WriteParams(number, self.page.system, tuple((each.name, each.value) for each in changes)),)

    def _finish_write(self, page: ParamPage) -> None:
        """Keep what was not set pending; undo makes the old values of the others pending."""
        if self._writing is None:
            return
        number, changes = self._writing
        line = next((each for each in page.ended if each.number == number), None)
        if line is None:
            return
        self._writing = None
        done = changes if line.state == "accepted" else changes[: line.done]
        self._undo = [{each.name: replace(each, before=each.value, value=each.before) for each in done}]
        for each in done:
            self.pending.pop(each.name, None)

    @property
    def status(self) -> str:
        """How the requests stand, one line."""
        page = self.page
        if page is None:
            return ""
        if page.running:
            return " · ".join(map(_running_text, page.running))
        return _ended_text(page.ended[-1]) if page.ended else ""


def _running_text(line: RequestLine) -> str:
    return f"{line.what} {line.done}" + (f"/{line.total}" if line.total is not None else "")


def _ended_text(line: RequestLine) -> str:
    """Return how a request ended; a failure begins with the reason, which must be seen on a narrow screen, too."""
    if line.state == "accepted":
        return f"{line.what}: {line.detail or 'done'}"
    return f"{line.state}: {line.detail or line.what}"
