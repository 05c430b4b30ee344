"""ConsoleScreen: what all screens have, and what the app and a screen know of each other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import msgspec
from msgspec.structs import replace
from textual import events
from textual.app import ComposeResult
from textual.errors import NoWidget
from textual.geometry import Size
from textual.screen import Screen
from textual.widget import Widget

from groundstation.actions import ACTIONS, AGENT_ACTIONS, OperatorAction
from groundstation.input.keymap import Keymap
from groundstation.intents.union import AnyIntent
from groundstation.screens import SCREENS, ScreenRow, find_screen
from groundstation.ui.base.chrome import CHROME, PROPOSAL, PROPOSAL_ROWS, InstrumentRow
from groundstation.ui.base.question import ANSWER_WITHIN, Question
from groundstation.ui.display.display_state import DisplayState, ScreenInfo, ScreenKey
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.display.wrap import plain
from groundstation.ui.learn.lesson_dock import LessonDock
from groundstation.ui.learn.pane import LessonPane
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.terminal.mouse import MouseReport
from groundstation.ui.terminal.painting import LineCompositor, painted_at_once
from groundstation.ui.terminal.picture_output import PictureOutput
from groundstation.ui.widgets.footer import KeyFooter
from groundstation.ui.widgets.instrument import Instrument
from groundstation.ui.widgets.line_field import LineField
from groundstation.ui.widgets.tabs import TabBar
from groundstation.views.base import View, ViewRequest

Kept = TypeVar("Kept")

NOTE_TIME = 10.0
"""s for which a note is shown in the hint line."""

WHEEL_ROWS = 3
"""Steps of one notch of the wheel."""

LIST_ARROWS = ("up", "down")
"""What the wheel presses in a list."""


class ScreenContext(msgspec.Struct, frozen=True):
    """What every screen gets from the app."""

    keymap: Keymap
    send: Callable[[AnyIntent], None]
    """Sends an intent to the station."""
    perform: Callable[[OperatorAction], None]
    """Performs an action of the app itself, such as opening another screen."""
    newest: Callable[[], DisplayState]
    """Returns the newest display state: what a screen shows first."""
    folder: Path
    """Where screens save files."""
    open_log: Callable[[Path | None, str], str] = lambda file, at: ""
    """Shows a telemetry log from a time on, "" for its start, in place of this app; returns why not, or ""."""
    dialect: str | None = None
    """File of a further dialect, for the programs that a screen starts."""
    numbers: RequestNumbers = msgspec.field(default_factory=RequestNumbers)
    """Numbers for requests to the station."""
    kept: dict[type, Any] = msgspec.field(default_factory=dict)
    """What screens keep while they are closed, by its class."""
    lesson: LessonDock | None = None
    """The lesson whose pane is docked beside every screen; None without one."""
    came_from: Callable[[], ScreenRow] = lambda: SCREENS[0]
    """Returns the screen that was shown before this one."""
    pictures: PictureOutput = msgspec.field(default_factory=PictureOutput)
    """How the terminal shows pictures."""

    def keep(self, kind: type[Kept], *args: Any) -> Kept:
        """Return the object of this class that lives as long as the app: a screen itself ends when it is closed.

        `args` are for its constructor, the first time.
        """
        if kind not in self.kept:
            self.kept[kind] = kind(*args)
        found: Kept = self.kept[kind]
        return found


class ConsoleScreen(Screen[None]):
    """A screen of the SCREENS table: status bar and tabs, its own part (`compose_body`), a hint and the footer.

    Keys that it does not stop go to the app: screen keys, and Escape goes back. Keys drive on the Drive screen only.
    """

    AUTO_FOCUS = ""
    DEFAULT_CSS = """
    ConsoleScreen { background: $background; }
    ConsoleScreen #status, ConsoleScreen #tabs, ConsoleScreen #hint, ConsoleScreen #footer { height: 1; }
    ConsoleScreen #proposal { display: none; height: 3; }
    ConsoleScreen.-proposal #proposal { display: block; }
    ConsoleScreen .panel {
        border: round $line;
        border-title-color: $primary;
        border-subtitle-color: $dim;
        background: $background;
    }
    ConsoleScreen .panel.-chosen { border: round $primary; border-title-style: bold reverse; }
    """
    ROWS: ClassVar[tuple[InstrumentRow, ...]] = CHROME
    """Instruments that the screen builds by their place, and shows."""
    KEYS: ClassVar[tuple[ScreenKey, ...]] = ()
    """Keys of this screen, for its footer and the help."""
    HINT: ClassVar[str] = "ESC goes back to Drive, the only screen where keys drive"

    def __init__(self, context: ScreenContext) -> None:
        super().__init__()
        self._compositor = LineCompositor()
        self.context = context
        self._built: dict[str, Instrument[Any]] = {}
        self._state = context.newest()
        self.field = LineField()
        self._question: Question | None = None
        self._note, self._note_until = "", 0.0
        self._pane: LessonPane | None = None

    # ---- what a screen defines ----

    def compose_body(self) -> Iterable[Widget]:
        """Yield the widgets between the tabs and the hint."""
        return ()

    def show_body(self, now: DisplayState) -> None:
        """Show a display state in them; called at up to 16 Hz while the screen is on top."""

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return which views the station shall send while the screen is on top."""
        return ()

    def show_view(self, view: View) -> None:
        """Show a view that it has requested."""

    @property
    def advice(self) -> str:
        """What to do next on this screen."""
        return self.HINT

    def perform_key(self, event: events.Key) -> bool:
        """Handle a key of this screen; return False for any other, which goes on to the app."""
        return False

    def uses(self, key: str) -> bool:
        """Return whether a key is one of this screen."""
        return any(each.key == key for each in self.KEYS)

    @property
    def marked_text(self) -> str:
        """The text of what is under the cursor, which `y` copies; "" for nothing."""
        return ""

    def release_key(self, key: str) -> None:
        """Handle the release of a key, on terminals that report it; also while something else has the keys."""

    def filter_by(self, text: str) -> bool:
        """Show only what a text describes, "" all; return False if this screen has no filter."""
        return False

    @property
    def kept_filter(self) -> str:
        """The text of a filter that ENTER has kept: ESC clears it first, then leaves."""
        return ""

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Choose the panel of a widget; return the keys that the wheel presses there, up and down, or None."""
        return None

    def leave(self) -> None:
        """Stop what must not go on while this screen is not on top."""

    # ---- what a screen uses ----

    def build_panel(self, widget: Widget, title: str) -> Widget:
        """Return a widget with the frame of a panel; class `-chosen` marks the one that has the arrows."""
        widget.add_class("panel")
        widget.border_title = plain(title)
        return widget

    def say(self, text: str | None) -> None:
        """Show a note in the hint line for some seconds; None: there is nothing to say."""
        if text is not None:
            self._note, self._note_until = text, time.monotonic() + NOTE_TIME

    def copy(self, text: str) -> None:
        """Copy a text by the terminal (OSC 52), and say so."""
        self.app.copy_to_clipboard(text)
        self.say(f"copied {text}, where the terminal allows it (OSC 52)")

    def open_log(self, file: Path | None, at: str = "") -> None:
        """Show a telemetry log in this terminal until it is quit, or say why not."""
        self.say(self.context.open_log(file, at) or None)

    def ask(self, text: str | Callable[[], str], perform: Callable[[], None], *, word: str = "") -> None:
        """Ask before an action: `y`, or `word` letter by letter, performs it."""
        shown = (lambda: text) if isinstance(text, str) else text
        self._question = Question(shown, perform, word, time.monotonic() + ANSWER_WITHIN)

    # ---- what all of them do ----

    @property
    def question(self) -> Question | None:
        """The question that waits for an answer."""
        if self._question is not None and time.monotonic() >= self._question.until:
            self._question = None
        return self._question

    @property
    def hint(self) -> str:
        """Return the question, a note, or what to do."""
        if self.question is not None:
            return self.question.hint
        return self._note if time.monotonic() < self._note_until else self.advice

    @property
    def takes_text(self) -> bool:
        """Letters are text and no stop keys: in the field, and in a question that is answered by a word."""
        return (self.field.is_attached and self.field.is_open) or bool(self.question and self.question.word)

    @property
    def agent_keys(self) -> frozenset[str]:
        """Return the keys that permit or decline a proposal here: those for which the screen has no use of its own."""
        if PROPOSAL.id not in self._built or self.takes_text or self.question is not None:
            return frozenset()
        keys = (key for action in AGENT_ACTIONS for key in self.context.keymap.get_keys(action))
        return frozenset(key for key in keys if not self.uses(key))

    def on_screen_suspend(self, event: events.ScreenSuspend) -> None:
        """Something else is on top now: a question is not answered there."""
        self._question = None
        self.leave()

    def on_key(self, event: events.Key) -> None:
        """Give a key to the field, the question or the screen; those of other screens go on to the app."""
        if self.field.is_attached and self.field.is_open:
            self.field.take_key(event)
            return
        takers = (self._answer, self._clear_filter, self.perform_key, self._copy_marked)
        if not any(take(event) for take in takers):
            return
        event.stop()
        if self.is_current:
            self.show_state(self._state)

    def take_mouse(self, report: MouseReport) -> None:
        """Point at what is shown: the wheel moves, a click chooses. It types no text and answers no question."""
        if self.takes_text or self.question is not None:
            return
        try:
            widget, _ = self.get_widget_at(report.column, report.row)
        except NoWidget:
            return
        if isinstance(widget, (TabBar, KeyFooter)):
            if not report.wheel:
                self._click(widget, report.column - widget.content_region.x)
        else:
            self._move_by(report, widget)
        if self.is_current:
            self.show_state(self._state)

    def _click(self, widget: TabBar | KeyFooter, column: int) -> None:
        if isinstance(widget, KeyFooter):
            self._press(widget.key_at(column))
        elif (tab := widget.tab_at(column)) is not None:
            self.context.perform(ACTIONS[tab.action])

    def _move_by(self, report: MouseReport, widget: Widget) -> None:
        if (keys := self.choose_panel_of(widget)) is not None:
            rows = WHEEL_ROWS * report.wheel or _rows_to(widget, report.row - widget.content_region.y, keys)
            for _ in range(abs(rows)):
                self._press(keys[rows > 0])

    def _press(self, key: str) -> None:
        """Perform a key of the screen as if it was typed; the station hears nothing of it."""
        if key and not self.perform_key(events.Key(key, None)) and key == "escape":
            self.context.perform(ACTIONS["app.drive"])

    def on_paste(self, event: events.Paste) -> None:
        """Give pasted text to the field; nothing else takes any."""
        if self.field.is_attached and self.field.is_open:
            self.field.take_paste(event)

    def _copy_marked(self, event: events.Key) -> bool:
        if event.key != "y" or not self.marked_text:
            return False
        self.copy(self.marked_text)
        return True

    def _clear_filter(self, event: events.Key) -> bool:
        return event.key == "escape" and bool(self.kept_filter) and self.filter_by("")

    def _answer(self, event: events.Key) -> bool:
        question = self.question
        if question is None:
            return False
        if not isinstance(event, KeyRepeat):  # the key that asked may still be held
            self._question = None
            if question.answer(event.key, time.monotonic()):
                self._question = question
        return True

    def compose(self) -> ComposeResult:
        """Lay out the screen."""
        self._state = replace(self._state, screen=self.describe())
        self.set_class(self._state.snapshot.proposal is not None, "-proposal")
        yield from self.build_place("top")
        yield from self.compose_body()
        yield self.field
        yield from self.build_place("bottom")
        yield from self.build_pane()

    def build_place(self, place: str) -> Iterator[Instrument[Any]]:
        """Build the instruments of one place."""
        for row in self.ROWS:
            if row.place == place:
                self._built[row.id] = row.build(row.value(self._state), id=row.id)
                yield self._built[row.id]

    def build_pane(self) -> Iterator[LessonPane]:
        """Build the pane of the lesson, if there is one."""
        if self.context.lesson is not None:
            self._pane = self.context.lesson.build(self.app.size, self.context.keymap)
            yield self._pane

    @property
    def room(self) -> Size:
        """Columns and rows that the pane of a lesson and the proposal of an agent leave to the screen."""
        size = self.app.size
        if self.context.lesson is not None:
            size = Size(*self.context.lesson.room(size))
        shown = PROPOSAL in self.ROWS and self.has_class("-proposal")
        return Size(size.width, max(1, size.height - PROPOSAL_ROWS)) if shown else size

    def _get_breakpoint_classes(self, dimension: int, breakpoints: list[tuple[int, str]]) -> set[str]:
        """Choose the classes of HORIZONTAL_BREAKPOINTS by the room. Overrides Textual 8.2.8; no screen has others."""
        return super()._get_breakpoint_classes(self.room.width, breakpoints)

    def _show_pane(self) -> None:
        """Show the lesson; when its pane was hidden or shown, lay out the screen anew."""
        if self._pane is None or self.context.lesson is None:
            return
        before = self._pane.value.place
        self._pane.show(self.context.lesson.value(self.app.size, self.context.keymap))
        if self._pane.value.place is not before:
            self.post_message(events.Resize(self.size, self.size))

    def describe(self) -> ScreenInfo:
        """Return what the common parts must know of this screen."""
        row = find_screen(f"{type(self).__module__}:{type(self).__name__}")
        return ScreenInfo(row.id if row else type(self).__name__, self.KEYS, self.hint, self.takes_text)

    def keep_state(self, now: DisplayState) -> None:
        """Store a state to show later: what a hidden screen draws, Textual paints again on the one on top of it."""
        self._state = replace(now, screen=self.describe())

    def show_state(self, now: DisplayState) -> None:
        """Give every instrument its value; each redraws only the lines that changed."""
        self.keep_state(now)
        if self.has_class("-proposal") != (now.snapshot.proposal is not None):
            self.toggle_class("-proposal")
            self.post_message(events.Resize(self.size, self.size))  # screens share their rows then
        with painted_at_once(self):
            self.show_rows()
            self.show_body(self._state)
            self._show_pane()

    def show_rows(self) -> None:
        """Show the state in the instruments of ROWS."""
        for row in self.ROWS:
            self.show_row(row)

    def show_row(self, row: InstrumentRow) -> None:
        """Show the state in one of them."""
        if row.id in self._built:
            self._built[row.id].show(row.value(self._state))


def _rows_to(widget: Widget, line: int, keys: tuple[str, str]) -> int:
    """Return by how many rows a click moves the cursor of a list."""
    rows = widget.rows_to(line) if isinstance(widget, Instrument) and keys == LIST_ARROWS else None
    return rows or 0
