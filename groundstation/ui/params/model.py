"""What the Parameters screen shows: a page of the vehicle's parameters, and changes that are not sent yet.

Knows no widget. Changes are kept here until they are written, with the values that they replace, so that a write can be
undone by another one.
"""

from __future__ import annotations

from typing import ClassVar

from groundstation.intents.services import CancelRequest, FetchParams, WriteParams
from groundstation.intents.union import AnyIntent
from groundstation.natural_order import natural_key
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.display.tab_marks import TabMark
from groundstation.ui.look.colours import BLUE
from groundstation.ui.params.edit.editor import ValueEditor
from groundstation.ui.params.edit.pending import PendingChange, PendingChanges
from groundstation.ui.params.favourites import Favourites
from groundstation.ui.params.scope import ALL, ParamScope, ScopeKind, ScopeRow, group_of, scope_rows
from groundstation.ui.params.status import status_text, written_text
from groundstation.views.base import ViewRequest
from groundstation.views.params import (
    ParamDiff,
    ParamDiffRequest,
    ParamInfo,
    ParamInfoRequest,
    ParamInfos,
    ParamPage,
    ParamPageRequest,
    ParamRow,
)

MAX_INFOS = 40
"""Pending changes whose texts are requested: more than a screen shows."""
MAX_NAMES = 2000
"""Names of one request."""


class ParamModel:
    """The newest page, the selected row, and the pending changes."""

    SCREEN: ClassVar[str] = "params"

    def __init__(self, numbers: RequestNumbers, favourites: Favourites | None = None) -> None:
        self._numbers = numbers
        self._favourites = favourites
        self.page: ParamPage | None = None
        self.diff: ParamDiff | None = None
        self.infos: dict[str, ParamInfo] = {}
        """What is known of the selected parameter and of those with a change."""
        self.filter = ""
        self.scope = ALL
        self.changes = PendingChanges()
        self.editor: ValueEditor | None = None
        """The value that is being typed."""
        self.last_write = ""
        """How the last write ended."""
        self._system: int | None = None
        """The vehicle that the changes are for."""
        self._top = self._selected = 0
        self._height = 1
        self._fetched: set[int] = set()
        """Systems whose parameters were requested by opening the screen."""
        self._writing: tuple[int, tuple[PendingChange, ...]] | None = None
        self.fetch_after: int | None = None
        """Request after whose end the parameters are read again: a reset changes them."""

    def tab_mark(self) -> TabMark | None:
        """Return a pencil with the number of changes that are not written."""
        return TabMark(f"✎{len(self.pending)}", BLUE, short="✎") if self.pending else None

    # ---- what the station sends ----

    @property
    def requests(self) -> tuple[ViewRequest, ...]:
        """What to request."""
        names = tuple(self.pending)[:MAX_INFOS]
        name = self.editor.row.name if self.editor else self.selected.name if self.selected else None
        infos = ParamInfoRequest((*([name] if name else []), *(each for each in names if each != name)))
        return (self.request, infos, *([ParamDiffRequest()] if self.page and self.page.file else []))

    @property
    def request(self) -> ParamPageRequest:
        """The page to request."""
        group = self.scope.group
        return ParamPageRequest(
            self.filter, self.changed_only, self._top, self._height, group=group, names=self._names_of_scope
        )

    @property
    def changed_only(self) -> bool:
        """Only what is not at its default is shown."""
        return self.scope.kind is ScopeKind.CHANGED

    @property
    def _names_of_scope(self) -> tuple[str, ...] | None:
        if self.scope.kind is ScopeKind.PENDING:
            return tuple(sorted(self.pending, key=natural_key))[:MAX_NAMES]
        return tuple(sorted(self.favourites, key=natural_key)) if self.scope.kind is ScopeKind.FAVOURITES else None

    def show_page(self, page: ParamPage) -> tuple[AnyIntent, ...]:
        """Show a page; return the intents that follow: parameters that are not known are fetched once."""
        if self.page is not None and self.page.known and not page.known:
            self._fetched.discard(page.system)  # the station has forgotten them: the vehicle was lost, or restarted
        if page.system != self._system:
            self._forget_vehicle(page.system)
        self.page = page
        self._selected = max(0, min(self._selected, page.matching - 1))
        self._finish_write(page)
        if self._ended(page, self.fetch_after):
            self.fetch_after = None
            return (self.fetch(),)
        # ArduPilot sends some values by itself: a few that are known are not the list.
        if page.known + page.missing >= max(1, page.total or 0) or page.running or page.system in self._fetched:
            return ()
        self._fetched.add(page.system)
        return (self.fetch(),)

    def show_infos(self, view: ParamInfos) -> None:
        """Store the details of the requested parameters."""
        if self.page is not None and view.system == self.page.system:
            self.infos = {info.name: info for info in view.infos}
            if self.editor is not None and self.editor.row.name in self.infos:
                self.editor.set_info(self.infos[self.editor.row.name])

    def show_diff(self, view: ParamDiff) -> str | None:
        """Handle the comparison with a file; return how it ends, once for each file."""
        is_new = bool(view.file) and (self.diff is None or self.diff.file != view.file)
        self.diff = view
        return _diff_note(view) if is_new else None

    def _forget_vehicle(self, system: int) -> None:
        """Forget what was for another vehicle."""
        self._system = system
        self.changes.clear()
        self._writing, self.diff, self.editor, self.infos, self.last_write = None, None, None, {}, ""

    # ---- table ----

    def set_height(self, rows: int) -> None:
        """Set how many rows fit."""
        self._height = max(1, rows)
        self._keep_selected_in_view()

    def move(self, rows: int) -> None:
        """Move the selection."""
        last = max(0, (self.page.matching if self.page else 0) - 1)
        self._selected = max(0, min(last, self._selected + rows))
        self._keep_selected_in_view()

    def set_filter(self, text: str) -> None:
        """Show other parameters, the first of them selected."""
        self.filter = text
        self._top = self._selected = 0

    def set_scope(self, scope: ParamScope) -> None:
        """Show other parameters, the first of them selected."""
        self.scope = scope
        self._top = self._selected = 0

    @property
    def selected(self) -> ParamRow | None:
        """The selected parameter, if its row has arrived."""
        page = self.page
        if page is None or not 0 <= self._selected - page.first < len(page.rows):
            return None
        return page.rows[self._selected - page.first]

    @property
    def selected_index(self) -> int:
        """Place of the selected row among those of the page, -1 if it is not there."""
        row = self.selected
        return self._selected - self.page.first if self.page is not None and row is not None else -1

    @property
    def scopes(self) -> tuple[ScopeRow, ...]:
        """The list of groups."""
        page = self.page
        groups = {name: group_of(name, page) for name in self.pending} if page else {}
        return scope_rows(page, groups, len(self.favourites))

    def _keep_selected_in_view(self) -> None:
        self._top = max(self._selected - self._height + 1, min(self._top, self._selected))

    # ---- favourites ----

    @property
    def favourites(self) -> frozenset[str]:
        """Names of the favourites for this kind of autopilot."""
        if self._favourites is None or self.page is None:
            return frozenset()
        return self._favourites.get(self.page.autopilot)

    def toggle_favourite(self) -> str | None:
        """Make the selected parameter a favourite, or one no more; return why it is not saved."""
        if self._favourites is None or self.page is None or self.selected is None:
            return "no parameter is selected"
        return self._favourites.toggle(self.page.autopilot, self.selected.name)

    @property
    def favourites_warning(self) -> str:
        """What is wrong with the file of the favourites."""
        return self._favourites.warning if self._favourites else ""

    # ---- changes ----

    @property
    def pending(self) -> dict[str, PendingChange]:
        """The changes that are not written, by name."""
        return self.changes.by_name

    def propose(self, system: int, *changes: PendingChange) -> None:
        """Make changes pending that another screen recommends for this vehicle, in one step."""
        if system != self._system:
            self._forget_vehicle(system)
        self.changes.set(changes)

    def open_editor(self) -> ValueEditor | None:
        """Begin to change the selected parameter."""
        row = self.selected
        if row is not None:
            change = self.pending.get(row.name)
            self.editor = ValueEditor(row, change.value if change else row.value, self.infos.get(row.name))
        return self.editor

    def close_editor(self, *, keep: bool) -> str | None:
        """End the change; return what is wrong with the value."""
        editor, self.editor = self.editor, None
        if editor is None or not keep:
            return None
        value = editor.result()
        if isinstance(value, str):
            return value
        if self._is_read_only(editor.row.name):
            return f"{editor.row.name} is read-only"
        self.changes.set([PendingChange(editor.row.name, editor.row.value, value)])
        return None

    def change_to_default(self) -> str | None:
        """Make the default of the selected parameter pending; return why that cannot be done."""
        row = self.selected
        if row is not None and self._is_read_only(row.name):
            return f"{row.name} is read-only"
        if row is None or row.default is None:
            return "this vehicle does not report the default"
        self.changes.set([PendingChange(row.name, row.value, row.default)])
        return None

    def _is_read_only(self, name: str) -> bool:
        info = self.infos.get(name)
        return info is not None and info.read_only

    def take_from_file(self, index: int | None = None) -> int:
        """Make the values of the file pending: one difference, or all; return how many."""
        different = self.diff.different if self.diff else ()
        chosen = different if index is None else different[index : index + 1]
        self.changes.set(PendingChange(name, here, wanted) for name, here, wanted in chosen)
        return len(chosen)

    def drop(self) -> bool:
        """Drop the change of the selected parameter; return whether it had one."""
        return self.selected is not None and self.changes.drop(self.selected.name)

    # ---- requests ----

    def take_number(self) -> int:
        """Return the number of the next request."""
        return self._numbers.take()

    def fetch(self) -> AnyIntent:
        """Return the intent that reads all parameters again, or those that are missing."""
        return FetchParams(self._numbers.take())

    def cancel(self) -> tuple[AnyIntent, ...]:
        """Return the intents that cancel what runs."""
        return tuple(CancelRequest(line.number) for line in self.page.running) if self.page else ()

    @property
    def may_write(self) -> bool:
        """There are pending changes, and none are being written."""
        return bool(self.pending) and self._writing is None and self.page is not None

    def write(self) -> tuple[AnyIntent, ...]:
        """Write the pending changes in the order in which they are listed."""
        if not self.may_write or self.page is None:
            return ()
        number = self._numbers.take()
        changes = tuple(self.pending[name] for name in sorted(self.pending, key=natural_key))
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
        tried = changes if line.state == "accepted" else changes[: line.done]
        done = [each for each in tried if each.name not in line.kept]
        self.changes.take_written(done)
        left = [each.name for each in changes[len(tried) :]]
        self.last_write = written_text(line, [each.name for each in done], left)

    def _ended(self, page: ParamPage, number: int | None) -> bool:
        """Return whether a request of ours has been accepted."""
        return any(each.number == number and each.state == "accepted" for each in page.ended)

    @property
    def status(self) -> str:
        """How the requests stand, one line."""
        return status_text(self.page, self.last_write, edited=bool(self.pending))


def _diff_note(diff: ParamDiff) -> str:
    count = len(diff.different)
    if not count:
        return f"{diff.file}: nothing differs, {diff.same} are the same"
    differ = "differs" if count == 1 else "differ"
    return f"{diff.file}: {count} {differ}, {diff.same} are the same · TAB lists them, a takes all"
