"""LineField: one line of text that a screen asks for, hidden until then."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import msgspec
from textual import events
from textual.actions import SkipAction, parse
from textual.widgets import Input


def _ignore(text: str) -> None:
    """Do nothing with the text."""


def _no_text(key: str) -> str | None:
    """Do nothing with a key."""
    return None


class FieldUse(msgspec.Struct, frozen=True):
    """What a text is asked for."""

    submit: Callable[[str], None]
    """Called with the text when ENTER ends it; the field is closed then."""
    change: Callable[[str], None] = _ignore
    """Called while the text is typed."""
    cancel: Callable[[], None] = lambda: None
    """Called when ESC ends it; the field is closed then."""
    key: Callable[[str], str | None] = _no_text
    """Called with a key that is not text, such as "down"; returns the new text, None if the key does nothing."""


class LineField(Input):
    """A field of a screen. While it is open, all keys but emergency stop and ^k are text."""

    DEFAULT_CSS = """
    LineField { display: none; height: 1; border: none; padding: 0 1; background: $panel; }
    LineField:focus { border: none; }
    """

    def __init__(self) -> None:
        super().__init__(id="field", select_on_focus=False)
        self.cursor_blink = False
        self._use: FieldUse | None = None

    def open(self, use: FieldUse, *, text: str = "", placeholder: str = "", selected: bool = False) -> None:
        """Show the field with a text. `selected`: what is typed replaces it, unless a cursor key comes first."""
        self._use = None  # the text is not a change
        self.value, self.placeholder = text, placeholder
        self.cursor_position = len(text)
        if selected:
            self.select_all()
        self._use = use
        self.display = True
        self.screen.set_focus(self)  # at once: the next keys of the same read are text

    @property
    def is_open(self) -> bool:
        """Whether the field has the keys."""
        return self.screen.focused is self

    def take_key(self, event: events.Key) -> None:
        """Handle a key. The screen calls it for each key, so that keys of one read act in their order."""
        if event.key in ("escape", "enter"):
            self._close(submitted=event.key == "enter")
        elif event.is_printable and event.character:
            self.replace(event.character, *self.selection)
        elif self._use is not None and (text := self._use.key(event.key)) is not None:
            self.value, self.cursor_position = text, len(text)
        elif not self._edit(event.key):
            return
        event.stop()

    def take_paste(self, event: events.Paste) -> None:
        """Insert the first line of what was pasted."""
        self._on_paste(event)

    def _edit(self, key: str) -> bool:
        """Perform what Input binds to a key, at once; return whether it does something."""
        done = False
        for binding in self._bindings.key_to_bindings.get(key, ()):
            _, name, arguments = parse(binding.action)
            with contextlib.suppress(SkipAction):  # scrolling, which a line does not
                getattr(self, f"action_{name}")(*arguments)
                done = True
        return done

    def _forward_event(self, event: events.Event) -> None:
        """Leave keys and pastes to the screen: in a queue of its own, this widget would take them out of turn."""
        self.screen._forward_event(event)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Pass the text on."""
        event.stop()
        if self._use is not None:
            self._use.change(event.value)

    def _close(self, *, submitted: bool) -> None:
        use, self._use = self._use, None
        self.display = False
        self.screen.set_focus(None)
        if use is not None:
            use.submit(self.value) if submitted else use.cancel()
