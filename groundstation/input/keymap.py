"""Which key asks for what: the table of actions, the key maps, and what one read of keys means. Not what keys then do.

ACTIONS is the table behind the footer, the palette, the help screen and the TOML files; a new action is one line there
and, for a default key, one line in a map. Key names are Textual's ("i", "comma", "full_stop", "up", "ctrl+q").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import msgspec

from groundstation.intents import (
    AnyIntent,
    Arm,
    ClearEmergencyStop,
    Disarm,
    DriveKeyDown,
    DriveKeyUp,
    EmergencyStop,
    RequestControl,
    ScaleLimits,
    SelectNextVehicle,
    SetMode,
    SetStyle,
    StartSimulator,
    Stop,
)
from groundstation.screens import SCREENS

CONFIRM_KEY = "y"
"""The second key of an action that needs one. No map may bind it."""

FASTER, SLOWER = 1.1, 0.9
"""Factors of one press of a speed key, those of teleop_twist_keyboard: readers of the article know the feel."""


class KeymapError(ValueError):
    """A key map that cannot be used; the message is one line for the user."""


@dataclass(frozen=True, slots=True)
class OperatorAction:
    """Something an operator can ask for with a key or in the palette."""

    id: str
    label: str
    """One or two words for the footer."""
    help: str
    group: str
    """"drive", "stop", "speed", "vehicle" or "app"."""
    intent: AnyIntent | None = None
    """What goes to the station; None where the screen acts by itself. A Push is filled with the key's name."""
    confirm: bool = False
    """Needs CONFIRM_KEY after it; the screen asks and then sends `intent`."""
    when_armed: AnyIntent | None = None
    """Goes instead of `intent`, in one key, while the vehicle is armed."""


@dataclass(frozen=True, slots=True)
class KeyEvent:
    """One key event of the terminal."""

    key: str
    repeat: bool = False
    """The terminal says that it is an auto-repeat."""
    release: bool = False


def _drive(name: str, label: str, text: str, throttle: int, steering: int) -> OperatorAction:
    return OperatorAction(
        f"drive.{name}", label, text, "drive", DriveKeyDown(key="", throttle=throttle, steering=steering)
    )


def _speed(name: str, label: str, text: str, throttle: float, steering: float) -> OperatorAction:
    return OperatorAction(f"speed.{name}", label, text, "speed", ScaleLimits(throttle=throttle, steering=steering))


_ACTIONS = (
    _drive("forward", "Forward", "Drive forward while held", 1, 0),
    _drive("backward", "Backward", "Drive backward while held", -1, 0),
    _drive("left", "Left", "Turn the nose left (on the spot where the vehicle can)", 0, -1),
    _drive("right", "Right", "Turn the nose right", 0, 1),
    _drive("forward_left", "Fwd left", "Drive a curve forward and left", 1, -1),
    _drive("forward_right", "Fwd right", "Drive a curve forward and right", 1, 1),
    # Backward curves negate the turn, as in teleop_twist_keyboard: the vehicle goes back on the arc that it would have
    # driven forward, as a car does with its wheels held. A chord of two keys does not: left always turns the nose left.
    _drive("backward_left", "Back left", "Back up to the left, as a car does", -1, 1),
    _drive("backward_right", "Back right", "Back up to the right, as a car does", -1, -1),
    OperatorAction("drive.stop", "Stop", "Neutral at once; ends a latched drive", "stop", Stop()),
    OperatorAction("stop.emergency", "EMERGENCY STOP", "Motors off and locked, from every screen", "stop", EmergencyStop()),
    OperatorAction("stop.clear", "Clear e-stop", "Release the emergency stop; arming comes after", "stop",
           ClearEmergencyStop(), confirm=True),
    _speed("faster", "Faster", "Raise both limits by 10 %; never moves the vehicle", FASTER, FASTER),
    _speed("slower", "Slower", "Lower both limits by 10 %", SLOWER, SLOWER),
    _speed("throttle_faster", "Throttle +", "Raise the limit of the throttle by 10 %", FASTER, 1.0),
    _speed("throttle_slower", "Throttle -", "Lower the limit of the throttle by 10 %", SLOWER, 1.0),
    _speed("steering_faster", "Steering +", "Raise the limit of the steering by 10 %", 1.0, FASTER),
    _speed("steering_slower", "Steering -", "Lower the limit of the steering by 10 %", 1.0, SLOWER),
    OperatorAction("drive.style", "Style", "Next drive style: hold, latch, step", "drive", SetStyle(style="next")),
    OperatorAction("vehicle.arm", "Arm", "Arm; when armed, disarm in one key", "vehicle", Arm(), confirm=True,
           when_armed=Disarm()),
    OperatorAction("vehicle.disarm", "Disarm", "Disarm", "vehicle", Disarm()),
    OperatorAction("vehicle.manual", "MANUAL", "Mode MANUAL: the keys drive", "vehicle", SetMode(mode="MANUAL")),
    OperatorAction("vehicle.hold", "HOLD", "Mode HOLD: the vehicle stands", "vehicle", SetMode(mode="HOLD")),
    OperatorAction("vehicle.control", "Take control", "Ask to be the ground station in control", "vehicle", RequestControl()),
    OperatorAction("vehicle.next", "Next vehicle", "Stop this vehicle and look at the next one", "vehicle", SelectNextVehicle()),
    OperatorAction("app.simulator", "Simulator", "Start a simulated rover", "app", StartSimulator()),
    *(OperatorAction(screen.action, screen.title, screen.help, "app") for screen in SCREENS),
    OperatorAction("app.quit", "Quit", "Stop the vehicle and leave", "app"),
)  # fmt: skip

ACTIONS: dict[str, OperatorAction] = {action.id: action for action in _ACTIONS}
"""Every action by id, in the order of the help screen."""

_EVERYWHERE = {
    "up": "drive.forward", "down": "drive.backward", "left": "drive.left", "right": "drive.right",
    "u": "drive.forward_left", "i": "drive.forward", "o": "drive.forward_right",
    "j": "drive.left", "k": "drive.stop", "l": "drive.right",
    "m": "drive.backward_left", "comma": "drive.backward", "full_stop": "drive.backward_right",
    "space": "drive.stop", "exclamation_mark": "stop.emergency", "f9": "stop.emergency", "t": "stop.clear",
    "r": "vehicle.arm", "1": "vehicle.manual", "2": "vehicle.hold", "g": "vehicle.control", "n": "vehicle.next",
    "tab": "drive.style",
    "f5": "app.simulator", "ctrl+q": "app.quit", "ctrl+c": "app.quit",
} | {key: screen.action for screen in SCREENS for key in screen.keys}  # fmt: skip

KEYMAPS: dict[str, dict[str, str]] = {
    "standard": _EVERYWHERE
    | {"w": "drive.forward", "a": "drive.left", "s": "drive.backward", "d": "drive.right"}
    | {"plus": "speed.faster", "equals_sign": "speed.faster", "minus": "speed.slower"},
    "teleop": _EVERYWHERE
    | {"q": "speed.faster", "z": "speed.slower"}
    | {"w": "speed.throttle_faster", "x": "speed.throttle_slower"}
    | {"e": "speed.steering_faster", "c": "speed.steering_slower"},
}
"""Key name -> action id. "teleop" has the keys of teleop_twist_keyboard, hence no WASD."""


@dataclass(frozen=True, slots=True)
class Keymap:
    """One key map in use."""

    name: str
    bindings: Mapping[str, str] = field(default_factory=dict)

    def get_action(self, key: str) -> OperatorAction | None:
        """What a key asks for."""
        action_id = self.bindings.get(key)
        return ACTIONS[action_id] if action_id else None

    def get_keys(self, action_id: str) -> tuple[str, ...]:
        """The keys of an action, in the order of the map."""
        return tuple(key for key, bound in self.bindings.items() if bound == action_id)

    def build_intents(self, batch: Sequence[KeyEvent], *, armed: bool, driving: bool) -> list[AnyIntent]:
        """What the keys of ONE read ask for. Actions that confirm, and those of the screen itself, give nothing.

        A stop key anywhere in the read wins: then only what stops is left, because over a slow line "ik" may be one
        read and the operator's last word must not be driven over. A key that drives nothing is a stop key while the
        vehicle is driven (`driving`; say True when in doubt, a needless Stop is harmless), speed keys apart.
        """
        wishes = [wish for press in batch if (wish := self._build_intent(press, armed)) is not None]
        driving = driving or any(isinstance(wish, DriveKeyDown) for wish in wishes)
        if any(self._stops(press, driving) for press in batch):
            return _stopping(wishes)
        return wishes

    def _build_intent(self, press: KeyEvent, armed: bool) -> AnyIntent | None:
        action = self.get_action(press.key)
        if action is None:
            return None
        if isinstance(action.intent, DriveKeyDown):
            return _drive_intent(press, action.intent)
        if press.release or (press.repeat and action.group == "vehicle"):  # a held key must not arm and disarm in turn
            return None
        if armed and action.when_armed is not None:
            return action.when_armed
        return None if action.confirm else action.intent

    def _stops(self, press: KeyEvent, driving: bool) -> bool:
        if press.release:
            return False
        action = self.get_action(press.key)
        if action is not None and isinstance(action.intent, (Stop, EmergencyStop)):
            return True
        return driving and (action is None or not isinstance(action.intent, (DriveKeyDown, ScaleLimits)))


def _drive_intent(press: KeyEvent, push: DriveKeyDown) -> AnyIntent:
    if press.release:
        return DriveKeyUp(key=press.key)
    return msgspec.structs.replace(push, key=press.key, repeat=press.repeat)


def _stopping(wishes: Sequence[AnyIntent]) -> list[AnyIntent]:
    """What is left of a read with a stop key in it: the emergency stop first, then neutral, then what is safe."""
    emergency: list[AnyIntent] = [wish for wish in wishes if isinstance(wish, EmergencyStop)]
    rest = [wish for wish in wishes if not isinstance(wish, (DriveKeyDown, Stop, EmergencyStop, ScaleLimits, SetStyle))]
    return [*emergency[:1], Stop(), *rest]
