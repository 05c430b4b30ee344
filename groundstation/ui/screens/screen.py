"""ConsoleScreen: what all screens have, and what the app and a screen know of each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from textual.app import ComposeResult
from textual.screen import Screen
from textual.widget import Widget

from groundstation.actions import OperatorAction
from groundstation.input.keymap import Keymap
from groundstation.intents.union import AnyIntent
from groundstation.screens import find_screen
from groundstation.ui.display_state import DisplayState, ScreenInfo, ScreenKey
from groundstation.ui.instruments import CHROME, InstrumentRow
from groundstation.ui.widgets.instrument import Instrument
from groundstation.views.base import View, ViewRequest

Kept = TypeVar("Kept")


@dataclass(frozen=True, slots=True)
class ScreenContext:
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
    kept: dict[type, Any] = field(default_factory=dict)
    """What screens keep while they are closed, by its class."""

    def keep(self, kind: type[Kept]) -> Kept:
        """Return the object of this class that lives as long as the app: a screen itself ends when it is closed."""
        found: Kept = self.kept.setdefault(kind, kind())
        return found


class ConsoleScreen(Screen[None]):
    """A screen of the SCREENS table: status bar and tabs, its own part (`compose_body`), a hint and the footer.

    Keys that it does not stop go to the app: screen keys, and Escape goes back. Keys drive on the Drive screen only.
    """

    AUTO_FOCUS = ""
    DEFAULT_CSS = """
    ConsoleScreen { background: $background; }
    ConsoleScreen #status, ConsoleScreen #tabs, ConsoleScreen #hint, ConsoleScreen #footer { height: 1; }
    """
    ROWS: ClassVar[tuple[InstrumentRow, ...]] = CHROME
    """Instruments that the screen builds by their place, and shows."""
    KEYS: ClassVar[tuple[ScreenKey, ...]] = ()
    """Keys of this screen, for its footer and the help."""
    HINT: ClassVar[str] = "ESC goes back to Drive, the only screen where keys drive"

    def __init__(self, context: ScreenContext) -> None:
        super().__init__()
        self.context = context
        self._built: dict[str, Instrument[Any]] = {}
        self._state = context.newest()

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
    def hint(self) -> str:
        """What to do next on this screen."""
        return self.HINT

    @property
    def takes_text(self) -> bool:
        """A text field of the screen has the keys: characters are no stop keys then."""
        return False

    # ---- what all of them do ----

    def compose(self) -> ComposeResult:
        """Lay out the screen."""
        self._state = replace(self._state, screen=self.describe())
        yield from self.build_place("top")
        yield from self.compose_body()
        yield from self.build_place("bottom")

    def build_place(self, place: str) -> Iterator[Instrument[Any]]:
        """Build the instruments of one place."""
        for row in self.ROWS:
            if row.place == place:
                self._built[row.id] = row.build(row.value(self._state), id=row.id)
                yield self._built[row.id]

    def describe(self) -> ScreenInfo:
        """Return what the common parts must know of this screen."""
        row = find_screen(f"{type(self).__module__}:{type(self).__name__}")
        return ScreenInfo(row.id if row else type(self).__name__, self.KEYS, self.hint, self.takes_text)

    def show_state(self, now: DisplayState) -> None:
        """Give every instrument its value; each redraws only the lines that changed."""
        self._state = replace(now, screen=self.describe())
        self.show_rows()
        self.show_body(self._state)

    def show_rows(self) -> None:
        """Show the state in the instruments of ROWS."""
        for row in self.ROWS:
            self.show_row(row)

    def show_row(self, row: InstrumentRow) -> None:
        """Show the state in one of them."""
        if row.id in self._built:
            self._built[row.id].show(row.value(self._state))
