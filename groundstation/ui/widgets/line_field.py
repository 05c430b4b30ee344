"""LineField: one line of text that a screen asks for, hidden until then."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from textual import events
from textual.widgets import Input


def _ignore(text: str) -> None:
    """Do nothing with the text."""


def _no_text(key: str) -> str | None:
    """Do nothing with a key."""
    return None


@dataclass(frozen=True, slots=True)
class FieldUse:
    """What a text is asked for."""

    submit: Callable[[str], None]
    """Called with the text when ENTER ends it; the field is closed then."""
    change: Callable[[str], None] = _ignore
    """Called while the text is typed."""
    cancel: Callable[[], None] = lambda: None
    """Called when ESC ends it; the field is closed then."""
    key: Callable[[str], str | None] = _no_text
    """Called with a key that is no text, such as "down"; returns the new text, None if the key does nothing."""


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

    def open(self, use: FieldUse, *, text: str = "", placeholder: str = "") -> None:
        """Show the field with a text."""
        self._use = None  # the text is no change
        self.value, self.placeholder = text, placeholder
        self.cursor_position = len(text)
        self._use = use
        self.display = True
        self.screen.set_focus(self)  # at once: the next keys of the same read are text

    @property
    def is_open(self) -> bool:
        """Whether the field has the keys."""
        return self.screen.focused is self

    def take_key(self, event: events.Key) -> None:
        """Handle what the field has not: ESC, and the keys behind the opening one in one read."""
        if event.key == "escape":
            event.stop()
            self._close(submitted=False)
        elif event.key == "enter":
            event.stop()
            self._close(submitted=True)
        elif event.is_printable and event.character:
            event.stop()
            self.insert_text_at_cursor(event.character)
        elif self._use is not None and (text := self._use.key(event.key)) is not None:
            event.stop()
            self.value, self.cursor_position = text, len(text)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Pass the text on."""
        event.stop()
        if self._use is not None:
            self._use.change(event.value)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Pass the whole text on."""
        event.stop()
        self._close(submitted=True)

    def _close(self, *, submitted: bool) -> None:
        use, self._use = self._use, None
        self.display = False
        self.screen.set_focus(None)
        if use is not None:
            use.submit(self.value) if submitted else use.cancel()
