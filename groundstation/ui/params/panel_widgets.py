"""The widgets of the Parameters screen, and what of the model each of them shows."""

from __future__ import annotations

from typing import Any

from textual.widget import Widget

from groundstation.natural_order import natural_key
from groundstation.ui.base.panels import BORDERS
from groundstation.ui.display.wrap import clean, plain
from groundstation.ui.params.compare import CompareList, CompareValue
from groundstation.ui.params.detail import DetailValue, ParamDetail
from groundstation.ui.params.edit.pending_table import PendingList, PendingValue
from groundstation.ui.params.groups import GroupList, GroupListValue
from groundstation.ui.params.model import ParamModel
from groundstation.ui.params.panels import ParamPanels
from groundstation.ui.params.scope import ALL
from groundstation.ui.params.table import TITLES, ParamTable, ParamTableValue
from groundstation.ui.widgets.instrument import Instrument
from groundstation.views.params import ParamInfo, ParamPage

MAX_PENDING = 4
"""Rows of the pending changes below a table of 24 rows."""


class ParamWidgets:
    """One widget for each panel."""

    def __init__(self) -> None:
        self.groups = GroupList(GroupListValue(), id="groups")
        self.table = ParamTable(ParamTableValue(), id="table")
        self.detail = ParamDetail(DetailValue(), id="detail")
        self.compare = CompareList(CompareValue(), id="compare")
        self.pending = PendingList(PendingValue(), id="pending")
        self._by_name: dict[str, Instrument[Any]] = {
            "groups": self.groups,
            "table": self.table,
            "detail": self.detail,
            "compare": self.compare,
        }

    def name_of(self, widget: Widget) -> str:
        """Return the panel of a widget that has a cursor; "" for any other."""
        return next((name for name, each in self._by_name.items() if each is widget), "")

    def height_of(self, panel: str) -> int:
        """Return how many rows of its list a panel shows."""
        return max(1, self._by_name[panel].size.height - (TITLES if panel == "table" else 0))

    def show(self, model: ParamModel, panels: ParamPanels, *, armed: bool, room: int) -> None:
        """Show the model; `room`: rows that the pending changes may take below the table, 0: they stand at its side."""
        for name, widget in self._by_name.items():
            widget.set_class(panels.chosen == name, "-chosen")
        self._show_table(model)
        self.groups.show(GroupListValue(model.scopes, panels.group, model.scope, panels.chosen == "groups"))
        self._show_detail(model, panels)
        self._show_compare(model, panels)
        self._show_pending(model, armed=armed, room=room)

    def _show_table(self, model: ParamModel) -> None:
        page, pending = model.page, model.pending
        rows = page.rows if page else ()
        shown = {each.name for each in rows}
        self.table.show(
            ParamTableValue(
                rows,
                model.selected_index,
                {name: change for name, change in pending.items() if name in shown},
                {name: info for name, info in model.infos.items() if name in pending},
                model.favourites & shown,
                _empty_note(model, page),
            )
        )
        scope = "" if model.scope == ALL else f" · {model.scope.label}"
        words = f" / {model.filter}" if model.filter else ""
        self.table.border_title = plain(f"parameters{scope}{words}")
        self.table.border_subtitle = plain(_count_text(page) if page else "")

    def _show_detail(self, model: ParamModel, panels: ParamPanels) -> None:
        page, editor = model.page, model.editor
        row = editor.row if editor else model.selected
        info = (
            (model.infos.get(row.name) or ParamInfo(row.name, default=row.default, value=row.value, kind=row.kind))
            if row
            else None
        )
        change = model.pending.get(row.name) if row else None
        new = editor.value if editor else change.value if change else None
        described = bool(page and (page.texts == "" or info is None or info.title or info.text))
        self.detail.show(
            DetailValue(
                info,
                new,
                editor.text if editor else None,
                tuple(editor.choices) if editor else None,
                editor.cursor if editor else -1,
                page.file if page else "",
                panels.detail_top,
                "choose a parameter with ↑ ↓" if row is None else "" if described or page is None else _no_text(page),
            )
        )
        self.detail.border_title = plain(row.name if row else "detail")

    def _show_compare(self, model: ParamModel, panels: ParamPanels) -> None:
        diff = model.diff
        pending = frozenset(model.pending) & {name for name, _, _ in diff.different} if diff else frozenset[str]()
        self.compare.show(CompareValue(diff, panels.difference, pending, panels.chosen == "compare"))
        self.compare.border_title = plain(f"compare with {diff.file}" if diff else "compare with a file")
        self.compare.border_subtitle = "ENTER takes one · a takes all"

    def _show_pending(self, model: ParamModel, *, armed: bool, room: int) -> None:
        changes = tuple(model.pending[name] for name in sorted(model.pending, key=natural_key))
        self.pending.show(PendingValue(changes, model.infos, armed, model.last_write))
        self.pending.styles.display = "block" if changes or not room else "none"
        self.pending.styles.height = BORDERS + min(room, len(changes) + (room > MAX_PENDING)) if room else "1fr"
        self.pending.border_subtitle = plain(
            f"{len(changes)} {'edit' if len(changes) == 1 else 'edits'}" if changes else ""
        )


def _empty_note(model: ParamModel, page: ParamPage | None) -> str:
    """Return what stands in place of rows."""
    if page is None:
        return "no vehicle yet"
    if page.running:
        return "reading the parameters"
    if page.known:
        return "nothing matches"
    ended = page.ended[-1] if page.ended else None
    if ended is not None and ended.state == "no answer":
        return "this vehicle answers no list: R asks again; single ones: mavhelm param get NAME"
    return "no parameters: R reads them again"


def _count_text(page: ParamPage) -> str:
    shown = f"{page.matching} of " if page.matching != page.known else ""
    of_all = f" of {page.total}" if page.total is not None and page.total != page.known else ""
    missing = f" · {page.missing} missing" if page.missing else ""
    return f"{shown}{page.known}{'' if shown else of_all}{missing} · system {page.system}"


def _no_text(page: ParamPage) -> str:
    return clean(f"no text in {page.texts}" if " " not in page.texts or page.texts == "the vehicle" else page.texts)
