"""Key gate: which intents of keys may pass to the station now. Called by the input thread and the event loop."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from groundstation.input.hold_to_confirm import HoldProgress, HoldToConfirm
from groundstation.input.keymap import KeyEvent, Keymap
from groundstation.intents import (
    AnyIntent,
    DriveKeyDown,
    DriveKeyUp,
    EmergencyStop,
    ReportKeyReleases,
    SetKeyGate,
    Stop,
)
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.ui.tty_ping import TerminalPing


class StationConnection(Protocol):
    """The connection to the station: StationClient in the program.

    A protocol because the tests of the UI put a recorder in its place, without a station process behind it.
    """

    def send(self, *intents: AnyIntent) -> None:
        """Send intents; from any thread, never blocks."""

    def receive(self) -> Snapshot | None:
        """Return the newest snapshot that waits."""

    def fileno(self) -> int:
        """Return a descriptor that is readable when a snapshot waits."""

    @property
    def alive(self) -> bool:
        """The station process runs."""

    @property
    def open(self) -> bool:
        """Something may still arrive: the station or its watchdog runs."""

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
    """Only stops: keys are text for what is on top."""


@dataclass(frozen=True, slots=True)
class GateClosure:
    """Why the gate is not open."""

    reason: str
    level: GateLevel = GateLevel.COMMANDS


STARTING = GateClosure("starting")


class KeyGate:
    """Turns the keys of one read into intents and sends those that pass at once.

    The station has the same gate (`SetKeyGate` travels on the same pipe, in order) and keeps the sticks neutral while
    it is closed; this class decides on all other intents.
    """

    def __init__(self, client: StationConnection, keymap: Keymap, clock: Callable[[], float]) -> None:
        self.keymap = keymap
        self._client = client
        self._clock = clock
        self._lock = threading.Lock()
        self._closure: GateClosure | None = STARTING
        self._down: set[str] = set()
        self._exact = False
        self._armed = False
        self._driving = True
        self._hold = HoldToConfirm(keymap)
        self.ping = TerminalPing()

    @property
    def closure(self) -> GateClosure | None:
        """Why the gate is not open; None when it is."""
        return self._closure

    def update(self, *, armed: bool, driving: bool) -> None:
        """Set what the newest snapshot reports; it decides what some keys mean (arm or disarm, stop or not)."""
        self._armed, self._driving = armed, driving

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle the keys of one read, in the input thread."""
        with self._lock:
            read = self._hold.handle_read(
                self._drop_stray_repeats(batch), armed=self._armed, allowed=self._closure is None, now=self._clock()
            )
            intents = self.keymap.build_intents(read.passing, armed=self._armed, driving=self._driving)
            passing = [intent for intent in intents if self._passes(intent)]
            if read.confirmed is not None:
                passing.append(read.confirmed)
            if passing:
                self._client.send(*passing)

    def cancel_hold(self) -> None:
        """End the hold of a key that confirms an action; it must be released before it counts again."""
        with self._lock:
            self._hold.cancel()

    @property
    def hold(self) -> HoldProgress | None:
        """Progress of the key that is held to confirm an action."""
        with self._lock:
            return self._hold.progress(self._clock())

    def handle_release_support(self) -> None:
        """Note that the terminal reports repeats and releases."""
        with self._lock:
            if not self._exact:
                self._exact = True
                self._client.send(ReportKeyReleases())

    def close(self, reason: str) -> None:
        """Close at once, from any thread. The event loop opens again when its own conditions hold."""
        self.set_closure(GateClosure(reason))

    def set_closure(self, closure: GateClosure | None) -> None:
        """Open (None) or close. Closing means neutral at once, and a key held meanwhile does not count afterwards."""
        with self._lock:
            if closure == self._closure:
                return
            self._closure = closure
            if closure is None:
                self._client.send(SetKeyGate(open=True))
                return
            self._down.clear()
            self._hold.cancel()
            # The gate first: it makes the station record which keys are held, and the stop clears them.
            self._client.send(SetKeyGate(open=False, reason=closure.reason), Stop(closure.reason))

    def handle_pong(self) -> None:
        """Note the answer to a ping."""
        self.ping.handle_answer(self._clock())

    def _drop_stray_repeats(self, batch: Sequence[KeyEvent]) -> list[KeyEvent]:
        """Drop repeats of keys that are not down: kitty sends some after the focus is lost."""
        live: list[KeyEvent] = []
        for press in batch:
            if press.release:
                self._down.discard(press.key)
            elif not press.repeat:
                self._down.add(press.key)
            elif press.key not in self._down:
                continue
            live.append(press)
        return live

    def _passes(self, intent: AnyIntent) -> bool:
        """Return whether to send it. Drive keys always pass: the station must know them to ignore them later, too."""
        if self._closure is None or isinstance(intent, (Stop, EmergencyStop, DriveKeyDown, DriveKeyUp)):
            return True
        return self._closure.level is GateLevel.COMMANDS
