"""What a screen draws: the newest snapshot, and what the UI itself knows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.input.keymap import Keymap
from groundstation.snapshot import Snapshot
from groundstation.ui.keys.key_gate import GateClosure, GateLevel
from groundstation.ui.keys.keynames import format_key, main_key
from groundstation.ui.keys.pad_state import PadState


class ScreenKey(msgspec.Struct, frozen=True):
    """A key of one screen, beside the actions that work everywhere."""

    key: str
    """Textual's name."""
    label: str
    """One or two words for the footer."""
    help: str
    commands: bool = False
    """It reaches a vehicle: the mouse does not press it in the footer."""


class ScreenInfo(msgspec.Struct, frozen=True):
    """What the parts that all screens have must know of the one they are on."""

    id: str = "drive"
    """Id of its row in SCREENS."""
    keys: tuple[ScreenKey, ...] = ()
    hint: str = ""
    """What to do next on this screen; the Drive screen has rules for it (alerts.py)."""
    text: bool = False
    """A text field of the screen has the keys."""

    @property
    def drives(self) -> bool:
        """Keys may drive on this screen."""
        return self.id == "drive"


DRIVE_INFO = ScreenInfo()


class DisplayState(msgspec.Struct, frozen=True):
    """Input of the alert rules, of every instrument and of every screen."""

    snapshot: Snapshot
    keymap: Keymap
    closure: GateClosure | None = None
    """Why keys do not drive now, as far as the UI knows; None when they do."""
    hold: HoldProgress | None = None
    """The action whose key is held to confirm it."""
    station_alive: bool = True
    outage: str = ""
    """What the watchdog reports of a station that has ended or does not respond; empty while it runs."""
    away: float | None = None
    """Seconds for which nobody was attached to tmux, so that control was released; None if it was not."""
    pressed: frozenset[str] = frozenset()
    """Keys that the UI saw go down, sooner than a snapshot can report them."""
    key_hint: str | None = None
    """Why the last key did nothing, if that has a usual reason."""
    terminal_round_trip: float | None = None
    """Seconds from a ping of the terminal to its answer."""
    terminal_silence: float | None = None
    """Seconds for which an answer of the terminal is missing; None if it never answered."""
    promises_releases: bool = False
    """The terminal says that it reports key releases, which only the first one proves (OperatorView)."""
    screen: ScreenInfo = DRIVE_INFO
    unseen_lesson: str = ""
    """Why the lesson is not shown, and what to do; empty where there is none, or the pupil has hidden it."""
    ascii: bool = False
    """The terminal shows ASCII characters only."""
    still: bool = False
    """Nothing may move by itself."""
    muted: bool = False
    """`--speak` was given, and nothing is said."""
    gamepad: PadState | None = None
    """The gamepad; None where none was asked for."""
    kept: Mapping[type, Any] = msgspec.field(default_factory=dict)
    """What screens keep while they are closed, by its class (ScreenContext.keep)."""

    def agent_key(self, action: str) -> str:
        """Return the key of an action about proposals that counts now, as it is printed; "" where none does."""
        if self.closure is None or self.closure.level is GateLevel.COMMANDS:
            return self.key(action)
        keys = (key for key in self.keymap.get_keys(action) if key in self.closure.agent_keys)
        return next((format_key(key) for key in keys), "")

    def key(self, action: str) -> str:
        """Return the main key of an action as it is printed, "?" where it has none."""
        key = main_key(self.keymap, action)
        return "?" if key is None else format_key(key)
