"""Frames of the gamepad as intents and keys: its sticks go to the station, its buttons are further keys.

Called by the thread that reads the frames. Buttons pass the same gate as keys, and reach the screen on top as keys.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from textual import events
from textual.message import Message

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KeyEvent
from groundstation.input.pad import PadFrame
from groundstation.input.pad_mapping import KEY_PREFIX, PadMapping
from groundstation.intents.driving import DrivePad, ReleasePad
from groundstation.intents.union import AnyIntent
from groundstation.ui.keys.key_gate import KeyGate
from groundstation.ui.keys.pad_state import PadState
from groundstation.ui.terminal.key_parser import KeyUp


class PadSource(Protocol):
    """What reads frames: GamepadChild of a gamepad, or TabStick of a browser's tab."""

    touch: bool
    """It is a thumb stick on a touch screen."""

    @property
    def awake(self) -> bool:
        """The screen must follow it at once: it renews its lease as often as while it drives."""

    @property
    def mapping(self) -> PadMapping:
        """What sticks and buttons do."""

    @property
    def frame(self) -> PadFrame:
        """The newest frame; without names while there is no gamepad."""

    def start(self, take: Callable[[PadFrame], None]) -> None:
        """Start to read; `take` is called with each frame, in another thread. Raises OSError."""

    def stop(self) -> None:
        """Read no longer."""

    def choose_next(self) -> None:
        """Let the next gamepad drive, of several."""

    def problem(self, now: float) -> str:
        """Return why no gamepad can drive, "" if nothing is known to be wrong."""


class PadInput:
    """One gamepad behind one key gate. `post` takes messages for the app, `send` intents, from any thread."""

    def __init__(
        self,
        child: PadSource,
        gate: KeyGate,
        send: Callable[[AnyIntent], None],
        post: Callable[[Message], object],
    ) -> None:
        self.child = child
        self._gate, self._send, self._post = gate, send, post
        self._held = self._seen = False
        self._buttons: frozenset[str] = frozenset()

    def start(self) -> None:
        """Start to read. Raises OSError."""
        self.child.start(self.take)

    def state(self, now: float) -> PadState:
        """Return what the Drive screen shows of it."""
        frame = self.child.frame
        return PadState(
            frame,
            self.child.mapping,
            self.child.problem(now),
            lost=self._seen and not frame.names,
            touch=self.child.touch,
        )

    def take(self, frame: PadFrame) -> None:
        """Handle a frame: the sticks first, which may stop."""
        if frame.held:
            self._send(self._demand(frame))
        elif self._held:
            self._send(ReleasePad())
        self._held, self._seen = frame.held, self._seen or bool(frame.names)
        before, self._buttons = self._buttons, frozenset(frame.buttons)
        batch = [KeyEvent(_key(name), release=True) for name in sorted(before - self._buttons)]
        acting = [name for name in frame.buttons if name not in before or not self._is_step(name)]
        batch += [KeyEvent(_key(name), repeat=name in before) for name in acting]
        if batch:
            self._gate.handle_keys(batch)
        for press in batch:
            if press.release:
                self._post(KeyUp(press.key))
            elif not press.repeat:
                self._post(events.Key(press.key, None))

    def _demand(self, frame: PadFrame) -> DrivePad:
        if not self._gate.flies:
            return DrivePad(frame.throttle, frame.steering, frame.read_at, repeat=self._held)
        forward, turn, side, climb = frame.flight
        return DrivePad(forward, turn, frame.read_at, repeat=self._held, side=side, climb=climb)

    def _is_step(self, button: str) -> bool:
        """Return whether a button changes the limits: once a press, because frames repeat it 20 times a second."""
        return ACTIONS[self.child.mapping.buttons[button]].group == "speed"


def _key(name: str) -> str:
    return f"{KEY_PREFIX}{name}"
