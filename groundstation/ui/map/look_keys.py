"""Keys of the Map screen that change what is seen, and nothing of the plans: view, layers, filter, copy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from groundstation.ui.map.model import NO_CURSOR, MapModel
from groundstation.ui.widgets.line_field import FieldUse, LineField


class LookScreen(Protocol):
    """What these keys need of a screen."""

    field: LineField

    @property
    def app(self) -> Any:
        """The app; it copies texts by OSC 52 of the terminal."""

    def say(self, text: str | None) -> None:
        """Show a note."""

    def redraw(self) -> None:
        """Draw at once."""


class LookKeys:
    """Handles the keys of `_ACTIONS`."""

    def __init__(self, screen: LookScreen, model: MapModel) -> None:
        self._screen = screen
        self._model = model

    def perform(self, key: str) -> bool:
        """Handle a key; return False for any other."""
        if key == "escape" and self._model.filter.text:
            self._filter("")
        elif key in _ACTIONS:
            _ACTIONS[key](self)
        else:
            return False
        return True

    def _zoom_in(self) -> None:
        self._model.ground.zoom(-1)

    def _zoom_out(self) -> None:
        self._model.ground.zoom(1)

    def _fit(self) -> None:
        self._model.ground.fit()

    def _follow(self) -> None:
        self._model.ground.follow()

    def _measure(self) -> None:
        self._model.ground.measure()

    def _next_plan(self) -> None:
        self._model.editor.next_layer()

    def _toggle_layers(self) -> None:
        self._screen.say(self._model.layers.toggle())

    def _copy(self) -> None:
        cursor = self._model.ground.cursor
        if cursor is None:
            self._screen.say(NO_CURSOR)
            return
        text = f"{cursor.latitude:.7f}, {cursor.longitude:.7f}"
        self._screen.app.copy_to_clipboard(text)
        self._screen.say(f"copied {text}, where the terminal allows it (OSC 52)")

    def _open_filter(self) -> None:
        before = self._model.filter.text
        use = FieldUse(self._filter, change=self._filter, cancel=lambda: self._filter(""))
        placeholder = "words of the command, numbers, new, changed"
        self._screen.field.open(use, text=before, placeholder=placeholder, selected=True)

    def _filter(self, text: str) -> None:
        self._model.set_filter(text)
        self._screen.redraw()


_ACTIONS: dict[str, Callable[[LookKeys], None]] = {
    "plus": LookKeys._zoom_in,
    "equals_sign": LookKeys._zoom_in,
    "minus": LookKeys._zoom_out,
    "f": LookKeys._fit,
    "c": LookKeys._follow,
    "b": LookKeys._measure,
    "e": LookKeys._next_plan,
    "l": LookKeys._toggle_layers,
    "y": LookKeys._copy,
    "slash": LookKeys._open_filter,
}
"""Key -> what it does."""
