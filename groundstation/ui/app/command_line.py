"""Command line: one line over the screen that is shown, for the verbs of `mavhelm` and screens by name."""

from __future__ import annotations

from collections.abc import Callable

from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.screen import ModalScreen
from textual.widgets import Static

from groundstation.intents.line import RunLine
from groundstation.screens import SCREENS
from groundstation.ui.app.command_history import CommandHistory, complete_text
from groundstation.ui.app.local_lines import complete_local, find_local
from groundstation.ui.base.own_dismissal import OwnDismissal
from groundstation.ui.base.screen import ScreenContext
from groundstation.ui.keys.keynames import is_character
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.line_field import FieldUse, LineField
from groundstation.views.line import ASKS, FAILED, RUNNING, LineRequest, LineView

SHOWN = 12
"""Words that are proposed on the screen."""
_SCREENS = frozenset(row.action for row in SCREENS)
HINT = "verb, screen, endpoint or /filter · TAB completes · ↑ ↓ lines before · ESC closes"


class CommandLine(OwnDismissal[str], ModalScreen[str]):
    """Gives the line that is done here, or "". Keys do not drive meanwhile; all but stop keys are text."""

    AUTO_FOCUS = ""
    DEFAULT_CSS = """
    CommandLine { align: left bottom; background: transparent; }
    CommandLine #words { width: 100%; height: auto; max-height: 4; padding: 0 1; background: $panel; color: $dim; }
    CommandLine #line { height: 1; margin: 0 0 1 0; background: $panel; }
    CommandLine #colon { width: 2; padding: 0 0 0 1; background: $panel; color: $primary; }
    CommandLine LineField { dock: none; width: 1fr; padding: 0 1 0 0; }
    """

    def __init__(self, context: ScreenContext, text: str = "") -> None:
        super().__init__()
        self.context = context
        self._first = text
        self.field = LineField()
        self._history = context.keep(CommandHistory)
        self._words: tuple[str, ...] = ()
        self._proposed = Static(HINT, id="words", markup=False)
        self._asked: Callable[[], None] | None = None
        self._line = ""

    def compose(self) -> ComposeResult:
        """Lay out the proposed words and the field."""
        yield self._proposed
        yield Horizontal(Static(":", id="colon", markup=False), self.field, id="line")

    def on_mount(self) -> None:
        """Open the field."""
        self._open(self._first)
        if self._first:
            self._change(self._first)

    @property
    def takes_text(self) -> bool:
        """Letters are text: unless a question waits for an answer."""
        return self._asked is None

    @property
    def request(self) -> LineRequest:
        """What the station shall answer while this is open."""
        return LineRequest(self._history.number, self.field.value if self.takes_text else "", self._system)

    @property
    def _system(self) -> int:
        vehicle = self.context.newest().snapshot.vehicle
        return 0 if vehicle is None else vehicle.system

    def show_view(self, view: LineView) -> None:
        """Show the words that complete the text, and act on how the line stands."""
        if view.text == self.field.value and self.takes_text:
            self._words = tuple(dict.fromkeys([*view.words, *complete_local(view.text)]))
            if self.field.value:
                self._propose()
        if view.number == self._history.number != self._history.told and self._line and view.note:
            self._act(view)

    def _act(self, view: LineView) -> None:
        self._history.told = view.number if view.state != RUNNING else self._history.told
        if view.state == ASKS:
            line = self._line
            self._asked = lambda: self._send(line, confirmed=True)
            self._proposed.update(f"{view.note}  y does it, any other key not")
        elif view.state == FAILED:
            self._open(self._line)
            self._proposed.update(view.note)
        else:
            self.dismiss(view.note)

    def on_key(self, event: events.Key) -> None:
        """Give a key to the question or the field; a function key leaves for its screen."""
        event.stop()
        action = self.context.keymap.get_action(event.key)
        if action is not None and action.id in _SCREENS and not is_character(event.key):
            self.dismiss("")
            self.context.perform(action)
            return
        if not self.is_current or (self._asked is not None and isinstance(event, KeyRepeat)):
            return
        if self._asked is not None:
            perform = self._asked if event.key == "y" else None
            if perform is not None:
                perform()
            self.dismiss("" if perform else "not done")
        elif self.field.is_open:
            self.field.take_key(event)
        elif event.key == "escape":
            self.dismiss("")

    def on_paste(self, event: events.Paste) -> None:
        """Give pasted text to the field."""
        if self.field.is_open and self.is_current:
            self.field.take_paste(event)

    def _open(self, text: str) -> None:
        self._line = ""
        self._history.begin()
        use = FieldUse(self._submit, self._change, cancel=self._close, key=self._take_key)
        self.field.open(use, text=text)

    def _close(self) -> None:
        self.dismiss("")

    def _change(self, text: str) -> None:
        self._words = complete_local(text) if text else ()
        self._propose()

    def _propose(self) -> None:
        words = "  ".join(self._words[:SHOWN]) + ("  ..." if len(self._words) > SHOWN else "")
        self._proposed.update(words or HINT)

    def _take_key(self, key: str) -> str | None:
        text = self.field.value
        if key == "tab":
            return complete_text(text, self._words)
        if key in ("up", "down"):
            return self._history.move(-1 if key == "up" else 1, text)
        return None

    def _submit(self, text: str) -> None:
        line = text.strip().removeprefix(":").strip()
        self._history.add(line)
        if not line or find_local(line) is not None:
            self.dismiss(f":{line}" if line else "")
            return
        self._line = line
        self._proposed.update(f"{line} ...")
        self._send(line, confirmed=False)

    def _send(self, line: str, *, confirmed: bool) -> None:
        self._history.number = self.context.numbers.take()
        self.context.send(RunLine(self._history.number, line, self._system, confirmed))
