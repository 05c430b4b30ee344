"""Key gate: which intents of keys may pass to the station now. Called by the input thread and the event loop.

Operations wanted: choose from the keys of one read those that pass, in the input thread and without waiting for a
drawing (`handle_keys`), and close at once from any thread (`close`).

Worst case: one read holds the key that opens a screen and keys that are meant for that screen, or a text that a line
has gathered. No command in it passes; stops always do. The event loop may draw meanwhile, so that the gate stays
closed for OPENING_TIMEOUT until it has opened the screen.

Why not simpler: a gate in the event loop alone would let a stop wait for a drawing, and one in the station alone would
judge by a state that is a packet old. So both processes have one, set in order on one pipe, and a lock makes a closure
and the keys of a read follow each other.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from enum import Enum, auto
from typing import Protocol

import msgspec

from groundstation.input.hold_to_confirm import HoldProgress, HoldToConfirm
from groundstation.input.keymap import BURST, SPLIT, KeyEvent, Keymap
from groundstation.input.style import Style
from groundstation.intents.agents import DeclineProposal
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.screens import SCREENS
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.ui.keys.keynames import is_character
from groundstation.ui.terminal.frozen_terminal import style_refusal
from groundstation.ui.terminal.tty_ping import TerminalPing
from groundstation.views.base import View


class StationConnection(Protocol):
    """The connection to the station: StationClient in the program.

    A protocol because the tests of the UI put a recorder in its place, without a station process behind it.
    """

    def send(self, *intents: AnyIntent) -> None:
        """Send intents; from any thread, never blocks."""

    def receive(self) -> Snapshot | None:
        """Return the newest snapshot that waits."""

    def pop_views(self) -> list[View]:
        """Return the views that came with it."""

    def filenos(self) -> list[int]:
        """Return the descriptors of which one is readable when a snapshot or an outage waits, or has ended."""

    @property
    def alive(self) -> bool:
        """The station process runs."""

    @property
    def outage(self) -> StationOutage:
        """What the watchdog reports of a station that has ended or does not respond."""


class GateLevel(Enum):
    """What passes the gate."""

    OPEN = auto()
    """Keys drive."""
    COMMANDS = auto()
    """Commands (disarm, mode) but no drive keys: the Drive screen is shown, but its driver may be absent."""
    STOPS = auto()
    """Only stops: the other keys are those of the screen or menu on top."""
    TEXT = auto()
    """Only stops that are not text: a text field has the keys, and SPACE is a letter there."""


class GateClosure(msgspec.Struct, frozen=True):
    """Why the gate is not open."""

    reason: str
    level: GateLevel = GateLevel.COMMANDS
    agent_keys: frozenset[str] = frozenset()
    """Keys that permit or decline what an agent proposes all the same: those of another screen, which shows it."""


STARTING = GateClosure("starting")
OTHER_SCREEN = GateClosure("another screen is open", GateLevel.STOPS)
TEXT_FIELD = GateClosure("a text field has the keys", GateLevel.TEXT)
REPLAY = GateClosure("this is a replay", GateLevel.STOPS)
LENT = GateClosure("a log has the terminal", GateLevel.STOPS)

OPENING_TIMEOUT = 1.0
"""s within which the event loop opens the screen whose key the input thread has seen. Until then the gate stays closed:
the next key may be meant for that screen."""

OPENING = frozenset(
    {"app.goto", "app.command", "app.next_screen", "app.previous_screen", *(row.action for row in SCREENS[1:])}
)
"""Actions that open a screen or menu on top of Drive."""

SHOW_PERIOD = 0.1
"""s between two presses of a held drive key that the event loop gets to see: its cap stays lit for 0.15 s after one
(pressed_keys.py), and nothing else follows from a repeat there."""

BURST_KEYS = 3
"""Different characters in one read from which on they are a text, which a line has gathered or a program types: two may
be a chord, or a change of keys on a slow line."""

PALETTE_KEY = "ctrl+p"
"""Opens Textual's command palette, which is a text field."""


class KeyGate:
    """Turns the keys of one read into intents and sends those that pass at once.

    The station has the same gate (`SetKeyGate` travels on the same pipe, in order) and keeps the sticks neutral while
    it is closed; this class decides on all other intents.
    """

    def __init__(
        self,
        client: StationConnection,
        keymap: Keymap,
        clock: Callable[[], float],
        *,
        find_proxy: Callable[[], str] = lambda: "",
    ) -> None:
        """`find_proxy` returns what hides a frozen terminal, for which no style but hold is chosen; "": each may be."""
        self._find_proxy = find_proxy
        self._keymaps = (keymap, keymap.in_flight())
        self.keymap = keymap
        self._client = client
        self._clock = clock
        self._lock = threading.Lock()
        self._closure: GateClosure | None = STARTING
        self._down: set[str] = set()
        self._exact = False
        self.promises_releases = False
        """The terminal says that it reports releases. Only a release or a repeat proves it."""
        self._armed = False
        self._driving = True
        self._proposal = 0
        self._opening_until = -math.inf
        self._hold = HoldToConfirm(keymap)
        self._shown_key, self._shown_at = "", -math.inf
        self.ping = TerminalPing()
        self.split_keys = 0
        """Keys that arrived in pieces and did nothing, so far."""
        self.bursts = 0
        """Reads of several different characters that did nothing, so far."""

    @property
    def flies(self) -> bool:
        """The keys are those of what flies."""
        return self.keymap is self._keymaps[True]

    @property
    def closure(self) -> GateClosure | None:
        """Why the gate is not open; None when it is."""
        return self._closure

    def update(self, *, armed: bool, driving: bool, flies: bool = False, proposal: int = 0) -> None:
        """Set what the newest snapshot reports; it decides what some keys mean (arm or disarm, stop or not, climb).

        `proposal`: number of that which is shown; 0: none is.
        """
        self._armed, self._driving, self._proposal = armed, driving, proposal
        if self.keymap is not self._keymaps[flies]:
            with self._lock:
                self.keymap = self._hold.keymap = self._keymaps[flies]
                self._hold.cancel()

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle the keys of one read, in the input thread."""
        with self._lock:
            self.split_keys += batch.count(SPLIT)
            read = self._hold.handle_read(
                self._drop_stray_repeats(batch),
                armed=self._armed,
                allowed=self._closure is None,
                now=self._clock(),
                subject=self._proposal,
                also=() if self._closure is None else self._closure.agent_keys,
            )
            if self._opens_screen(batch):
                self._opening_until = self._clock() + OPENING_TIMEOUT
                self._set_closure(OTHER_SCREEN)
            elif self._is_burst(batch):
                self.bursts += 1
                read = msgspec.structs.replace(read, passing=[*self._stops_of(read.passing), BURST])
            counting = [press for press in read.passing if self._counts(press)]
            intents = self.keymap.build_intents(counting, armed=self._armed, driving=self._driving)
            passing = [self.allow(intent) for intent in intents if self._passes(intent)]
            if read.confirmed is not None:
                passing.append(read.confirmed)
            if passing:
                self._client.send(*passing)

    def allow(self, intent: AnyIntent) -> AnyIntent:
        """Return an intent, or the choice of the style hold in place of that of another one."""
        if isinstance(intent, SetStyle) and (why := style_refusal("another one", self._find_proxy())):
            return SetStyle(style=Style.HOLD, why=why)
        return intent

    def handle_split_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle the stop keys among the keys of a split escape sequence, and no others."""
        stops = [press for press in self._stops_of(batch) if not press.release]
        if stops:
            self.handle_keys(stops)

    def _stops_of(self, batch: Sequence[KeyEvent]) -> list[KeyEvent]:
        """Return the stop keys and the releases of a read."""
        actions = [(press, self.keymap.get_action(press.key)) for press in batch]
        return [
            press
            for press, action in actions
            if press.release or (action is not None and isinstance(action.intent, (Stop, EmergencyStop)))
        ]

    def _is_burst(self, batch: Sequence[KeyEvent]) -> bool:
        """Return whether a read has so many characters that none of them drives or commands; on Drive only."""
        if self._closure is not None and self._closure.level is not GateLevel.COMMANDS:
            return False
        pressed = {press.key for press in batch if not (press.release or press.repeat) and is_character(press.key)}
        return len(pressed) >= BURST_KEYS

    def is_repeat(self, key: str) -> bool:
        """Return whether the event loop need not see a key, which has been handled: it saw this drive key just now."""
        with self._lock:
            action, now = self.keymap.get_action(key), self._clock()
            drives = self._closure is None and action is not None and isinstance(action.intent, DriveKeyDown)
            if drives and key == self._shown_key and now - self._shown_at < SHOW_PERIOD:
                return True
            self._shown_key, self._shown_at = key if drives else "", now
            return False

    def cancel_hold(self) -> None:
        """End the hold of a key that confirms an action; it must be released before it counts again."""
        with self._lock:
            self._hold.cancel()

    def takes_text(self) -> bool:
        """Return whether a text field has the keys."""
        closure = self._closure
        return closure is not None and closure.level is GateLevel.TEXT

    @property
    def hold(self) -> HoldProgress | None:
        """Progress of the key that is held to confirm an action."""
        with self._lock:
            return self._hold.progress(self._clock())

    def handle_release_claim(self) -> None:
        """Note that the terminal says that it reports releases: shown until the first one proves it."""
        self.promises_releases = True

    def handle_release_support(self) -> None:
        """Note that the terminal reports repeats and releases."""
        with self._lock:
            if not self._exact:
                self._exact = True
                self._client.send(ReportKeyReleases())

    def handle_plain_key(self) -> None:
        """Note that a key came without the protocol that reports releases: timers end it."""
        with self._lock:
            if self._exact:
                self._exact = False
                self._client.send(ReportKeyReleases(reports=False))

    def close(self, reason: str) -> None:
        """Close at once, from any thread. The event loop opens again when its own conditions hold."""
        self.set_closure(GateClosure(reason))

    def set_closure(self, closure: GateClosure | None) -> None:
        """Open (None) or close. Closing means neutral at once, and a key held meanwhile does not count afterwards."""
        with self._lock:
            commands = closure is None or closure.level is GateLevel.COMMANDS
            opening = commands and self._clock() < self._opening_until
            self._set_closure(OTHER_SCREEN if opening else closure)

    def screen_opened(self) -> None:
        """Note that a screen is on top of Drive: from now on the event loop knows whether keys drive."""
        with self._lock:
            self._opening_until = -math.inf

    def _set_closure(self, closure: GateClosure | None) -> None:
        if closure == self._closure:
            return
        before, self._closure = self._closure, closure
        if closure is None:
            self._client.send(SetKeyGate(open=True))
            return
        self._down.clear()
        self._hold.cancel()
        # The gate first: it makes the station record which keys are held, and the stop clears them.
        self._client.send(SetKeyGate(open=False, reason=closure.reason, permits=bool(closure.agent_keys)))
        if before is None or before.reason != closure.reason:
            self._client.send(Stop(closure.reason))

    def handle_pong(self) -> None:
        """Note the answer to a ping."""
        self.ping.handle_answer(self._clock())

    def _drop_stray_repeats(self, batch: Sequence[KeyEvent]) -> list[KeyEvent]:
        """Drop repeats of keys that are not down: kitty sends some after the focus is lost."""
        live: list[KeyEvent] = []
        for press in batch:
            if press.release:
                self._down.discard(press.key)
                self._shown_key = ""
            elif not press.repeat:
                self._down.add(press.key)
            elif press.key not in self._down:
                continue
            live.append(press)
        return live

    def _opens_screen(self, batch: Sequence[KeyEvent]) -> bool:
        """Return whether a key of this read opens a screen on top of Drive: then none of them is a command."""
        if self._closure is not None and self._closure.level is not GateLevel.COMMANDS:
            return False
        pressed = [press.key for press in batch if not press.release]
        actions = (self.keymap.get_action(key) for key in pressed)
        return PALETTE_KEY in pressed or any(action is not None and action.id in OPENING for action in actions)

    def _counts(self, press: KeyEvent) -> bool:
        """Return whether a key means anything to the station: on other screens those that drive, stop, or permit."""
        level = GateLevel.OPEN if self._closure is None else self._closure.level
        if level in (GateLevel.OPEN, GateLevel.COMMANDS):
            return True
        action = self.keymap.get_action(press.key)
        if action is not None and isinstance(action.intent, DeclineProposal):
            return self._closure is not None and press.key in self._closure.agent_keys
        if action is None or not isinstance(action.intent, (DriveKeyDown, Stop, EmergencyStop)):
            return False
        return not (level is GateLevel.TEXT and isinstance(action.intent, Stop) and is_character(press.key))

    def _passes(self, intent: AnyIntent) -> bool:
        """Return whether to send it. Drive keys always pass: the station must know them to ignore them later, too."""
        always = (Stop, EmergencyStop, DriveKeyDown, DriveKeyUp, DeclineProposal)
        if self._closure is None or isinstance(intent, always):
            return True
        return self._closure.level is GateLevel.COMMANDS
