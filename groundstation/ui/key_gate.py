"""Between the keys and the station: which intents may pass now. Called by the input thread and the loop alike."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

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
from groundstation.snapshot import Snapshot
from groundstation.ui.tty_ping import TerminalPing


class StationConnection(Protocol):
    """The station as the screen sees it; groundstation.client.StationClient is one."""

    def send(self, *intents: AnyIntent) -> None:
        """Hand over intents; from any thread, never blocks."""

    def receive(self) -> Snapshot | None:
        """The newest snapshot that waits."""

    def fileno(self) -> int:
        """Readable when a snapshot waits."""

    @property
    def alive(self) -> bool:
        """The station is there."""


class GateLevel(Enum):
    """How far the gate is open."""

    OPEN = auto()
    """Keys drive."""
    COMMANDS = auto()
    """Keys command (disarm, mode) but do not drive: the vehicle's screen is there, its driver perhaps not."""
    STOPS = auto()
    """Only what stops: something else is on top and keys are text or answers there."""


@dataclass(frozen=True, slots=True)
class GateClosure:
    """Why the gate is not open."""

    reason: str
    level: GateLevel = GateLevel.COMMANDS


STARTING = GateClosure("starting")


class KeyGate:
    """Turns the keys of one read into intents and sends them at once, as far as the gate is open.

    The station holds the same gate (`SetKeyGate` travels on the same pipe, in order) and is the one that keeps the sticks
    neutral; here is decided what else keys may ask for.
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
        self.ping = TerminalPing()

    @property
    def closure(self) -> GateClosure | None:
        """Why the gate is not open; None when it is."""
        return self._closure

    def update(self, *, armed: bool, driving: bool) -> None:
        """What the newest snapshot says; it decides what one key means (arm or disarm, nothing or stop)."""
        self._armed, self._driving = armed, driving

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """The keys of one read. In the input thread."""
        with self._lock:
            intents = self.keymap.build_intents(
                self._drop_stray_repeats(batch), armed=self._armed, driving=self._driving
            )
            passing = [intent for intent in intents if self._passes(intent)]
            if passing:
                self._client.send(*passing)

    def handle_release_support(self) -> None:
        """The terminal tells repeats and releases."""
        with self._lock:
            if not self._exact:
                self._exact = True
                self._client.send(ReportKeyReleases())

    def close(self, reason: str) -> None:
        """Close at once, from any thread. The loop opens again when its own conditions hold."""
        self.set_closure(GateClosure(reason))

    def set_closure(self, shut: GateClosure | None) -> None:
        """Open (None) or close. Closing is neutral at once, and a key held over it does not count afterwards."""
        with self._lock:
            if shut == self._closure:
                return
            self._closure = shut
            if shut is None:
                self._client.send(SetKeyGate(open=True))
                return
            self._down.clear()
            # The gate first: it makes the station remember which keys are held, and the stop forgets them.
            self._client.send(SetKeyGate(open=False, reason=shut.reason), Stop(shut.reason))

    def handle_pong(self) -> None:
        """The terminal answered."""
        self.ping.handle_answer(self._clock())

    def _drop_stray_repeats(self, batch: Sequence[KeyEvent]) -> list[KeyEvent]:
        """Without repeats of keys that are not down: kitty sends some after the focus is lost."""
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
        """Drive keys always pass: the station knows of the closed gate, and a key pressed now must not drive later."""
        if self._closure is None or isinstance(intent, (Stop, EmergencyStop, DriveKeyDown, DriveKeyUp)):
            return True
        return self._closure.level is GateLevel.COMMANDS
