"""Scripts of keys for `mavhelm drive`: what the keys of the key map do at each moment (lines: key_script_file.py)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec

from dialects.axes import Axes
from groundstation.actions import OperatorAction
from groundstation.input.keymap import KeyEvent, Keymap
from groundstation.input.sticks import Sticks
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, StepLimits, Stop
from groundstation.intents.vehicle import Disarm, SetMode

_PLAYED = (DriveKeyDown, Stop, EmergencyStop, StepLimits, SetStyle, SetMode)
"""What keys of a script may request, beside what `when_armed` of an action does."""


class KeyLine(msgspec.Struct, frozen=True):
    """One line of a script."""

    at: float
    """s from the start."""
    event: KeyEvent
    number: int
    """Its line in the file, from 1."""


def can_play(action: OperatorAction | None) -> bool:
    """Return whether a script may press a key with this action."""
    return (
        action is not None
        and isinstance(action.when_armed or action.intent, (*_PLAYED, Disarm))
        and (not action.confirm or action.when_armed is not None)
    )


class KeyScript:
    """Plays the lines: time in; axes and the intents that are not for the sticks out."""

    def __init__(self, lines: Sequence[KeyLine], keymap: Keymap, sticks: Sticks) -> None:
        self._lines = list(lines)
        self._keymap = keymap
        self._sticks = sticks
        self._sticks.set_reports_releases()
        self._began = 0.0

    def begin(self, now: float) -> None:
        """Begin at time 0 of the script."""
        self._began = now

    @property
    def finished(self) -> bool:
        """No line is left."""
        return not self._lines

    @property
    def due(self) -> float:
        """When the next line is due; infinity if none is left."""
        return self._began + self._lines[0].at if self._lines else math.inf

    def play(self, armed: bool, now: float) -> list[Intent] | None:
        """Play the next line if it is due; return what it requests of the vehicle. None: none is due."""
        if now < self.due:
            return None
        event = self._lines.pop(0).event
        intents = self._keymap.build_intents([event], armed=armed, driving=not self._sticks.axes(now).neutral)
        return [intent for intent in intents if not self._handle(intent, now)]

    def axes(self, now: float) -> Axes:
        """Return the demand now."""
        return self._sticks.axes(now)

    def _handle(self, intent: Intent, now: float) -> bool:
        """Apply an intent to the sticks; return whether it is nothing more than that."""
        match intent:
            case DriveKeyDown():
                self._sticks.press(intent, now)
            case DriveKeyUp():
                self._sticks.release(intent.key)
            case StepLimits():
                self._sticks.step_limits(intent)
            case SetStyle():
                self._sticks.set_style(intent.style)
            case _:
                self._sticks.stop()  # a command takes a while, and lines that are due meanwhile come late
                return isinstance(intent, Stop)
        return True


class SteadyDemand:
    """One demand for a time, then neutral."""

    def __init__(self, axes: Axes, seconds: float) -> None:
        self._axes = axes
        self._seconds = seconds
        self._until = 0.0
        self.finished = False

    def begin(self, now: float) -> None:
        """Begin to drive."""
        self._until = now + self._seconds

    @property
    def due(self) -> float:
        """When it ends."""
        return self._until

    def play(self, armed: bool, now: float) -> list[Intent] | None:
        """End when the time is over."""
        if self.finished or now < self._until:
            return None
        self.finished = True
        return []

    def axes(self, now: float) -> Axes:
        """Return the demand now."""
        return Axes() if now >= self._until else self._axes
