"""Scripts of keys for `mavhelm drive`: their lines, and what the keys of the key map do at each moment.

# time in s from the start, press or release, key
0.5 press i
2.5 release i
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import msgspec

from dialects.axes import Axes
from groundstation.actions import OperatorAction
from groundstation.formats.errors import FileFormatError, shown
from groundstation.input.keymap import KeyEvent, Keymap, KeymapError
from groundstation.input.keymap_file import parse_key
from groundstation.input.sticks import Sticks
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, StepLimits, Stop
from groundstation.intents.vehicle import Disarm, SetMode
from groundstation.verbs.common.arguments import LONGEST_HOLD

MAX_LINES = 10_000
_PLAYED = (DriveKeyDown, Stop, EmergencyStop, StepLimits, SetStyle, SetMode)
"""What keys of a script may request, beside what `when_armed` of an action does."""


class KeyLine(msgspec.Struct, frozen=True):
    """One line of a script."""

    at: float
    """s from the start."""
    event: KeyEvent
    number: int
    """Its line in the file, from 1."""


def parse_script(text: str, name: str, keymap: Keymap) -> tuple[KeyLine, ...]:
    """Return the lines of a script. Raises FileFormatError with the file `name` and the line."""
    lines: list[KeyLine] = []
    held: dict[str, int] = {}
    for number, words in _words(text):
        if len(lines) >= MAX_LINES:
            raise FileFormatError(f"{name}:{number}: more than {MAX_LINES} lines")
        try:
            line = _parse_line(words, number, keymap)
            _check_order(line, lines, held, keymap)
        except (FileFormatError, KeymapError) as error:
            raise FileFormatError(f"{name}:{number}: {error}") from error
        lines.append(line)
    if not lines:
        raise FileFormatError(f"{name}: no line such as '0.5 press i'")
    return tuple(lines)


def _words(text: str) -> Iterable[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is not empty. # begins a comment, but as the third word."""
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        at = next((index for index, word in enumerate(words) if word.startswith("#") and index != 2), len(words))
        if words[:at]:
            yield number, words[:at]


def _parse_line(words: Sequence[str], number: int, keymap: Keymap) -> KeyLine:
    if len(words) != 3 or words[1] not in ("press", "release"):
        raise FileFormatError(f"{shown(' '.join(words))} is not TIME press|release KEY, e.g. 0.5 press i")
    try:
        at = float(words[0])
    except ValueError:
        at = math.nan
    if not (math.isfinite(at) and at >= 0):
        raise FileFormatError(f"{shown(words[0])} is not a time in s from the start")
    key = parse_key(words[2])
    if not can_play(keymap.in_flight().get_action(key)):
        _check_key(words[2], keymap.get_action(key), keymap)
    return KeyLine(at, KeyEvent(key, release=words[1] == "release"), number)


def can_play(action: OperatorAction | None) -> bool:
    """Return whether a script may press a key with this action."""
    return (
        action is not None
        and isinstance(action.when_armed or action.intent, (*_PLAYED, Disarm))
        and (not action.confirm or action.when_armed is not None)
    )


def _check_key(text: str, action: OperatorAction | None, keymap: Keymap) -> None:
    if action is None:
        raise FileFormatError(f"the key map {keymap.name} has no key {shown(text)}")
    if not can_play(action):
        raise FileFormatError(f"{shown(text)} is {action.label!r}, which a script cannot do")


def _check_order(line: KeyLine, before: Sequence[KeyLine], held: dict[str, int], keymap: Keymap) -> None:
    """Check a line against those before it; `held`: keys that are down, and the lines that pressed them."""
    key, earlier = line.event.key, before[-1].at if before else 0.0
    if line.at < earlier:
        raise FileFormatError(f"{line.at:g} s is before {earlier:g} s of line {before[-1].number}")
    driving = [each for each in held if (action := keymap.get_action(each)) and action.group == "drive"]
    if driving and line.at - earlier > LONGEST_HOLD:
        raise FileFormatError(
            f"{driving[0]} is held for more than {LONGEST_HOLD:g} s without another line; "
            "the vehicle would take it for a key that nobody operates"
        )
    if line.event.release and held.pop(key, None) is None:
        raise FileFormatError(f"{key} is not held")
    if not line.event.release and held.setdefault(key, line.number) != line.number:
        raise FileFormatError(f"{key} is held since line {held[key]}")


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
