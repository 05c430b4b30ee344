"""Which rows of the edited plan a filter shows."""

from __future__ import annotations

import math
from collections.abc import Sequence

from groundstation.ui.map.plan.commands import command_title
from groundstation.ui.map.plan.editor import PlanEditor
from groundstation.ui.map.plan.rows import Items, Rows


class TableFilter:
    """`text` has words of which a row has all: number, command, parameters, "new" and "changed"."""

    def __init__(self) -> None:
        self.text = ""
        self._known: tuple[Rows, Items, str, int] | None = None
        self._found: Sequence[int] = ()

    def rows(self, editor: PlanEditor, first: int) -> Sequence[int]:
        """Return the indices of the rows of the edited plan; `first` is the number of its first item."""
        rows, base = editor.rows(), editor.base.get(editor.layer, ())
        if not self.text.strip():
            return range(len(rows))
        known = self._known
        same = known is not None and known[0] is rows and known[1] is base and known[2:] == (self.text, first)
        if not same:  # asked for several times in a frame
            self._known, words = (rows, base, self.text, first), self.text.lower().split()
            texts = [_describe(editor, index, first) for index in range(len(rows))]
            self._found = [index for index, text in enumerate(texts) if all(word in text for word in words)]
        return self._found


def _describe(editor: PlanEditor, index: int, first: int) -> str:
    row = editor.rows()[index]
    mark = "new" if row.origin is None else "changed" if editor.was(row) is not None else ""
    params = " ".join(f"{value:g}" for value in row.item.params if value and not math.isnan(value))
    return f"{index + first} {command_title(row.item.command)} {params} {mark}".lower()
