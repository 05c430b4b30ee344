"""Between the keys and the station: which intents may pass now. Called by the input thread and the loop alike."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from groundstation.input.keymap import Keymap, KeyPress
from groundstation.intents import AnyIntent, EmergencyStop, ExactKeys, Gate, Push, Release, Stop
from groundstation.snapshot import Snapshot
from groundstation.ui.tty_ping import Ping


class Client(Protocol):
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


class Door(Enum):
    """How far the gate is open."""

    OPEN = auto()
    """Keys drive."""
    COMMANDS = auto()
    """Keys command (disarm, mode) but do not drive: the vehicle's screen is there, its driver perhaps not."""
    STOPS = auto()
    """Only what stops: something else is on top and keys are text or answers there."""


@dataclass(frozen=True, slots=True)
class Shut:
    """Why the gate is not open."""

    reason: str
    door: Door = Door.COMMANDS


STARTING = Shut("starting")


class KeyGate:
    """Turns the keys of one read into intents and sends them at once, as far as the gate is open.

    The station holds the same gate (`Gate` travels on the same pipe, in order) and is the one that keeps the sticks
    neutral; here is decided what else keys may ask for.
    """

    def __init__(self, client: Client, keymap: Keymap, clock: Callable[[], float]) -> None:
        self.keymap = keymap
        self._client = client
        self._clock = clock
        self._lock = threading.Lock()
        self._shut: Shut | None = STARTING
        self._down: set[str] = set()
        self._exact = False
        self._armed = False
        self._driving = True
        self.ping = Ping()

    @property
    def state(self) -> Shut | None:
        """Why the gate is not open; None when it is."""
        return self._shut

    def observe(self, *, armed: bool, driving: bool) -> None:
        """What the newest snapshot says; it decides what one key means (arm or disarm, nothing or stop)."""
        self._armed, self._driving = armed, driving

    def take(self, batch: Sequence[KeyPress]) -> None:
        """The keys of one read. In the input thread."""
        with self._lock:
            intents = self.keymap.intents(self._live(batch), armed=self._armed, driving=self._driving)
            passing = [intent for intent in intents if self._passes(intent)]
            if passing:
                self._client.send(*passing)

    def exact(self) -> None:
        """The terminal tells repeats and releases."""
        with self._lock:
            if not self._exact:
                self._exact = True
                self._client.send(ExactKeys())

    def shut(self, reason: str) -> None:
        """Close at once, from any thread. The loop opens again when its own conditions hold."""
        self.set(Shut(reason))

    def set(self, shut: Shut | None) -> None:
        """Open (None) or close. Closing is neutral at once, and a key held over it does not count afterwards."""
        with self._lock:
            if shut == self._shut:
                return
            self._shut = shut
            if shut is None:
                self._client.send(Gate(open=True))
                return
            self._down.clear()
            # The gate first: it makes the station remember which keys are held, and the stop forgets them.
            self._client.send(Gate(open=False, reason=shut.reason), Stop(shut.reason))

    def pong(self) -> None:
        """The terminal answered."""
        self.ping.answered(self._clock())

    def _live(self, batch: Sequence[KeyPress]) -> list[KeyPress]:
        """Without repeats of keys that are not down: kitty sends some after the focus is lost."""
        live: list[KeyPress] = []
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
        if self._shut is None or isinstance(intent, (Stop, EmergencyStop, Push, Release)):
            return True
        return self._shut.door is Door.COMMANDS
