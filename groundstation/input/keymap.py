"""The key maps, and what one read of key events means. station/intent_handler.py carries the intents out.

The actions and their usual keys are in groundstation/actions.py. Key names are Textual's ("i", "comma", "ctrl+q").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, StepLimits, Stop
from groundstation.intents.union import AnyIntent


class KeymapError(ValueError):
    """A key map that cannot be used; the message is one line for the user."""


class KeyEvent(msgspec.Struct, frozen=True):
    """One key event of the terminal."""

    key: str
    repeat: bool = False
    """The terminal reports an auto-repeat."""
    release: bool = False


SPLIT = KeyEvent("split_sequence")
"""A key whose escape sequence arrived in pieces. Not bound to any action, and so a stop key while driving."""

BURST = KeyEvent("several_keys")
"""Stands for different characters of one read, which no hand types. Not bound, and so a stop key while driving."""

_COMMON = {key: action.id for action in ACTIONS.values() for key in action.keys}

KEYMAPS: dict[str, dict[str, str]] = {
    "standard": _COMMON
    | {"w": "drive.forward", "a": "drive.left", "s": "drive.backward", "d": "drive.right"}
    | {"plus": "speed.faster", "equals_sign": "speed.faster", "minus": "speed.slower"}
    | {"right_curly_bracket": "speed.steering_faster", "left_curly_bracket": "speed.steering_slower"},
    "teleop": _COMMON
    | {"q": "speed.faster", "z": "speed.slower"}
    | {"w": "speed.throttle_faster", "x": "speed.throttle_slower"}
    | {"e": "speed.steering_faster", "c": "speed.steering_slower"},
}
"""Key name -> action id: the keys of ACTIONS and those of one map. "teleop" has the keys of teleop_twist_keyboard,
which use W, so it has no WASD."""


FLIGHT_ACTIONS = {
    "drive.forward_left": "drive.side_left", "drive.forward_right": "drive.side_right", "view.closer": "drive.climb",
    "view.wider": "drive.descend", "drive.backward_left": "", "drive.backward_right": "", "drive.override": "",
}  # fmt: skip
"""Action of a rover's key -> that of a copter's; "": the key has none and so is a stop key."""
CLIMB_KEYS = {"w": "drive.climb", "s": "drive.descend"}
FLIGHT_KEYS = {"T": "vehicle.take_off", "L": "vehicle.land", "H": "vehicle.home", "X": "stop.cut"}


class Keymap(msgspec.Struct, frozen=True):
    """The key map in use."""

    name: str
    bindings: Mapping[str, str] = msgspec.field(default_factory=dict)

    def in_flight(self) -> Keymap:
        """Return the map with which keys fly: what curves or zooms a rover moves sideways or climbs."""
        keys = {key: FLIGHT_ACTIONS.get(action, action) for key, action in self.bindings.items()}
        keys |= {key: action for key, action in FLIGHT_KEYS.items() if key not in keys}
        if self.name == "standard":
            keys |= CLIMB_KEYS
        return Keymap(self.name, {key: action for key, action in keys.items() if action})

    def get_action(self, key: str) -> OperatorAction | None:
        """Return the action bound to a key, or None."""
        action_id = self.bindings.get(key)
        return ACTIONS[action_id] if action_id else None

    def get_keys(self, action_id: str) -> tuple[str, ...]:
        """Return the keys of an action, in the order of the map."""
        return tuple(key for key, bound in self.bindings.items() if bound == action_id)

    def build_intents(self, batch: Sequence[KeyEvent], *, armed: bool, driving: bool) -> list[AnyIntent]:
        """Return the intents of ONE read of keys. Actions of the screen and those that a held key confirms make none.

        A stop key anywhere in the read wins: then only intents that stop are left, because over a slow line "ik" may
        arrive in one read, and the key that was pressed last must not be overruled by an earlier one. While the vehicle
        is driven (`driving`; pass True when in doubt, a needless Stop is harmless) every key that does not drive is a
        stop key, except those of `steady` actions.
        """
        intents = [intent for press in batch if (intent := self._build_intent(press, armed)) is not None]
        driving = driving or any(isinstance(intent, DriveKeyDown) for intent in intents)
        if any(self._stops(press, driving) for press in batch):
            return _keep_stops(intents)
        return intents

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
        return driving and (action is None or not (action.steady or isinstance(action.intent, DriveKeyDown)))


def _drive_intent(press: KeyEvent, push: DriveKeyDown) -> AnyIntent:
    if press.release:
        return DriveKeyUp(key=press.key)
    return msgspec.structs.replace(push, key=press.key, repeat=press.repeat)


def _keep_stops(intents: Sequence[AnyIntent]) -> list[AnyIntent]:
    """Return what is left of a read with a stop key in it: the emergency stop, then neutral, then what is safe."""
    emergency: list[AnyIntent] = [intent for intent in intents if isinstance(intent, EmergencyStop)]
    moving = (DriveKeyDown, Stop, EmergencyStop, StepLimits, SetStyle)
    rest = [intent for intent in intents if not isinstance(intent, moving)]
    return [*emergency[:1], Stop(), *rest]
