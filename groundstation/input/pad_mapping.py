"""Gamepad mapping: which button is the dead-man button, which axes are the sticks, which buttons ask for what.

Names of buttons and axes are those of SDL's game controller mapping, the same for every make of gamepad.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

import msgspec

from groundstation.actions import ACTIONS
from groundstation.input.keymap import Keymap
from groundstation.intents.driving import DriveKeyDown
from link.toml.errors import suggest

BUTTONS = {
    "a": "A", "b": "B", "x": "X", "y": "Y", "back": "BACK", "guide": "GUIDE", "start": "START",
    "leftstick": "L3", "rightstick": "R3", "leftshoulder": "LB", "rightshoulder": "RB",
    "dpup": "D-pad up", "dpdown": "D-pad down", "dpleft": "D-pad left", "dpright": "D-pad right",
}  # fmt: skip
"""Name of a button -> as it is shown; the names are those of an Xbox gamepad, by place on others."""

THROTTLES = ("lefty", "righty", "triggers", "-lefty", "-righty", "-triggers")
STEERINGS = ("leftx", "rightx", "-leftx", "-rightx")
"""Axes: up, right and the right trigger are positive; "-" reverses them. The left trigger drives backward."""

FLIGHT_MODES: dict[str, tuple[str, str, str, str]] = {
    "mode 2": ("righty", "leftx", "rightx", "lefty"),
    "mode 1": ("lefty", "leftx", "rightx", "righty"),
}
"""Modes of transmitters for what flies -> the axes of forward, turn, side and climb."""

ANY, OFF = "any", "off"
"""Values of the setting `gamepad` beside a name: the first one that is plugged in, and none."""

KEY_PREFIX = "pad_"
"""Begins the names of buttons among the keys of a key map: "pad_start"."""

DEFAULT_BUTTONS = {
    "b": "drive.stop",
    "back": "stop.emergency",
    "start": "vehicle.arm",
    "x": "vehicle.hold",
    "y": "vehicle.manual",
    "dpup": "speed.faster",
    "dpdown": "speed.slower",
    "rightstick": "view.pane",
}

Share = Annotated[float, msgspec.Meta(ge=0.0, le=0.5)]
Bend = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
_RANGES: dict[str, tuple[Any, str]] = {"dead_zone": (Share, "0 to 0.5"), "expo": (Bend, "0 to 1")}
_CHOICES: dict[str, tuple[str, ...]] = {
    "deadman": tuple(BUTTONS),
    "throttle": THROTTLES,
    "steering": STEERINGS,
    "flight": tuple(FLIGHT_MODES),
}
_NAMES = (*_CHOICES, *_RANGES, *BUTTONS)


class PadMapping(msgspec.Struct, frozen=True):
    """The mapping in use."""

    deadman: str = "rightshoulder"
    """Button that must be held to drive."""
    throttle: str = "lefty"
    steering: str = "rightx"
    flight: str = "mode 2"
    """Which sticks fly what flies."""
    dead_zone: float = 0.12
    """Share of the way of a stick around its centre that counts as centre."""
    expo: float = 0.3
    """0: the demand follows the stick; 1: by its third power, so that small movements are finer."""
    buttons: dict[str, str] = msgspec.field(default_factory=DEFAULT_BUTTONS.copy)
    """Button -> id of an action."""

    @property
    def deadman_name(self) -> str:
        """The dead-man button as it is shown."""
        return BUTTONS[self.deadman]


def find_pad_problems(name: str, value: Any) -> Iterator[str]:
    """Yield what is wrong with one entry of the table [pad]."""
    if name in _CHOICES:
        if value not in _CHOICES[name]:
            yield f"{value!r} is none of {', '.join(_CHOICES[name])}"
    elif name in _RANGES:
        kind, allowed = _RANGES[name]
        try:
            msgspec.convert(value, kind)
        except msgspec.ValidationError:
            yield f"{value!r} is not a number from {allowed}"
    elif name in BUTTONS:
        yield from _action_problems(value)
    else:
        yield f"unknown entry; {suggest(name, _NAMES)}"


def _action_problems(value: Any) -> Iterator[str]:
    if not isinstance(value, str):
        yield f'{value!r} is not the id of an action in "quotes"'
    elif value and value not in ACTIONS:
        yield f"unknown action {value!r}; {suggest(value, ACTIONS)}"
    elif value and isinstance(ACTIONS[value].intent, DriveKeyDown):
        yield f"{value} drives, which only the sticks do while the dead-man button is held"


def find_pad_conflict(table: Mapping[str, Any]) -> str | None:
    """Return what is wrong with entries of [pad] together: the dead-man button can do nothing else."""
    deadman = table.get("deadman", PadMapping().deadman)
    if isinstance(deadman, str) and table.get(deadman):
        return f"{deadman} is the dead-man button and cannot be {table[deadman]} as well"
    return None


def build_mapping(table: Mapping[str, Any]) -> PadMapping:
    """Return the mapping of a table without mistakes; what it does not name is as by default."""
    given = {name: action for name, action in table.items() if name in BUTTONS}
    deadman = str(table.get("deadman", PadMapping().deadman))
    buttons = {name: action for name, action in {**DEFAULT_BUTTONS, **given}.items() if action and name != deadman}
    return msgspec.convert(
        {**{name: table[name] for name in (*_CHOICES, *_RANGES) if name in table}, "buttons": buttons}, PadMapping
    )


def add_buttons(keymap: Keymap, mapping: PadMapping) -> Keymap:
    """Return the key map with the buttons as further keys of their actions."""
    keys = {f"{KEY_PREFIX}{button}": action for button, action in mapping.buttons.items()}
    return Keymap(keymap.name, {**keymap.bindings, **keys})
