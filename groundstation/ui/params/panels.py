"""Which panel of the Parameters screen has the arrows, and what they and ENTER do in it. Knows no widget."""

from __future__ import annotations

from groundstation.ui.display.display_state import ScreenKey
from groundstation.ui.params.model import ParamModel

PARAM_KEYS = (
    ScreenKey("slash", "Find", "Show the parameters with any of these words in the name or the texts"),
    ScreenKey("enter", "Edit", "Change the value here first: a number, 0x…, a name of its list, bits"),
    ScreenKey("W", "Write", "List the changes once more and write them to the vehicle after a question", commands=True),
    ScreenKey("tab", "Panel", "Groups, comparison, detail, or the table again"),
    ScreenKey("x", "Drop", "Drop the change of the selected parameter"),
    ScreenKey("u", "Undo", "Undo the last step; after a write the old values are changes again"),
    ScreenKey("d", "Default", "Change the selected parameter to its default"),
    ScreenKey("S", "Save", "Save to a file: all, changed or group; MAVProxy, QGroundControl or Mission Planner"),
    ScreenKey("O", "Open", "Open a parameter file and compare; without a name: close it"),
    ScreenKey("a", "Take all", "Make all values of the file that differ changes"),
    ScreenKey("c", "Changed", "Show only what is not at its default, or all again"),
    ScreenKey("asterisk", "Favourite", "Make the selected parameter a favourite, or one no more"),
    ScreenKey("y", "Copy", "Copy name and value of the selected parameter"),
    ScreenKey("ctrl+r", "Redo", "Do again what was undone"),
    ScreenKey("R", "Read", "Read all parameters again, or those that are missing"),
    ScreenKey("E", "Memory", "Have the vehicle store all parameters, or reset them to their defaults", commands=True),
    ScreenKey("X", "Cancel", "Cancel the reading or writing that runs"),
)


class ParamPanels:
    """The chosen panel, and the cursors that are not of the table."""

    def __init__(self, model: ParamModel) -> None:
        self._model = model
        self.chosen = "table"
        self.has_file = False
        """A file is compared."""
        self.group = 0
        """Cursor in the list of groups."""
        self.difference = 0
        """Cursor in the comparison."""
        self.detail_top = 0
        """First line of the detail."""

    def next(self) -> None:
        """Choose the next panel."""
        panels = ["table", "groups", *(["compare"] if self.has_file else []), "detail"]
        at = panels.index(self.chosen) if self.chosen in panels else 0
        self.chosen = panels[(at + 1) % len(panels)]

    def go_back(self) -> bool:
        """Choose the table; return whether another panel was chosen."""
        before, self.chosen = self.chosen, "table"
        return before != "table"

    def move(self, rows: int) -> None:
        """Move in the chosen panel."""
        if self.chosen == "groups":
            self.group = max(0, min(len(self._model.scopes) - 1, self.group + rows))
        elif self.chosen == "compare":
            last = len(self._model.diff.different) - 1 if self._model.diff else 0
            self.difference = max(0, min(last, self.difference + rows))
        elif self.chosen == "detail":
            self.detail_top = max(0, min(500, self.detail_top + rows))
        else:
            self._model.move(rows)
            self.detail_top = 0

    def enter(self) -> bool:
        """Open the group, or take a value of the file; return whether there was one to open or to take."""
        scopes = self._model.scopes
        if self.chosen == "groups" and self.group < len(scopes):
            self._model.set_scope(scopes[self.group].scope)
            self.chosen = "table"
            return True
        if self.chosen == "compare":
            self._model.take_from_file(self.difference)
            return True
        return False

    def edit_key(self, key: str) -> str | None:
        """Handle a key of the value editor that is not text; return the new text."""
        editor = self._model.editor
        if editor is None or key not in ("up", "down", "tab"):
            return None
        if key == "tab":
            editor.toggle()
        else:
            editor.move(1 if key == "down" else -1)
        return editor.text
