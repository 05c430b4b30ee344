"""ACTIONS: everything that an operator can do with a key or in the command palette.

A new action is a row here. One that the station carries out has an intent (groundstation/intents).
"""

from __future__ import annotations

import msgspec

from groundstation.intents.agents import DeclineProposal, PermitProposal
from groundstation.intents.driving import ClearEmergencyStop, DriveKeyDown, EmergencyStop, SetStyle, StepLimits, Stop
from groundstation.intents.session import GiveUpKeys, StartSimulator
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import (
    Arm,
    CutMotors,
    Disarm,
    GiveControl,
    KeepControl,
    ReleaseControl,
    RequestControl,
    SelectNextVehicle,
    SetMode,
    TakeOff,
)
from groundstation.intents.vehicle_intent import HOLD_TIME, VehicleIntent
from groundstation.screens import SCREENS

FASTER, SLOWER = 0.1, -0.1
"""Change of a limit by one press of a speed key, in the full range: two presses that undo each other leave no trace."""


class OperatorAction(msgspec.Struct, frozen=True):
    """Something an operator can ask for with a key or in the command palette."""

    id: str
    label: str
    """One or two words for the footer."""
    help: str
    group: str
    """"drive", "stop", "speed", "view", "vehicle" or "app"."""
    intent: AnyIntent | None = None
    """Sent to the station; None where the screen acts itself. The key's name is added to a DriveKeyDown."""
    keys: tuple[str, ...] = ()
    """Keys in every key map, by Textual's names ("i", "comma", "up", "ctrl+q"). KEYMAPS (input/keymap.py) adds more."""
    confirm: bool = False
    """The key must be held for `hold_time`; then `intent` is sent, with that time in its field `held` if it has one."""
    keeps: bool = False
    """With `confirm`: `intent` is sent again with each repeat of the key, and EndPermission when it is released."""
    when_armed: AnyIntent | None = None
    """Sent in place of `intent`, without confirmation, while the vehicle is armed."""
    steady: bool = False
    """Its keys do not stop a vehicle that is driven. All others that are not drive keys do."""

    @property
    def hold_time(self) -> float:
        """S for which its key must be held, with `confirm`."""
        return self.intent.hold_time if isinstance(self.intent, VehicleIntent) else HOLD_TIME


def _drive(name: str, label: str, text: str, throttle: int, steering: int, *keys: str) -> OperatorAction:
    intent = DriveKeyDown(key="", throttle=throttle, steering=steering)
    return OperatorAction(f"drive.{name}", label, text, "drive", intent, keys)


def _fly(name: str, label: str, text: str, side: int, climb: int) -> OperatorAction:
    intent = DriveKeyDown(key="", throttle=0, steering=0, side=side, climb=climb)
    return OperatorAction(f"drive.{name}", label, text, "drive", intent)


def _speed(name: str, label: str, text: str, throttle: float, steering: float) -> OperatorAction:
    limits = StepLimits(throttle=throttle, steering=steering)
    return OperatorAction(f"speed.{name}", label, text, "speed", limits, steady=True)


_ROWS = (
    _drive("forward", "Forward", "Drive forward while held", 1, 0, "up", "i"),
    _drive("backward", "Backward", "Drive backward while held", -1, 0, "down", "comma"),
    _drive("left", "Left", "Turn left (in place where the vehicle can)", 0, -1, "left", "j"),
    _drive("right", "Right", "Turn right", 0, 1, "right", "l"),
    _drive("forward_left", "Fwd left", "Drive forward and turn left", 1, -1, "u"),
    _drive("forward_right", "Fwd right", "Drive forward and turn right", 1, 1, "o"),
    # Backward curves negate the turn, as in teleop_twist_keyboard: the vehicle goes back on the arc that it would have
    # driven forward, as a car does with its wheels held. A chord of two keys does not: left always turns the nose left.
    _drive("backward_left", "Back left", "Back up to the left, as a car does", -1, 1, "m"),
    _drive("backward_right", "Back right", "Back up to the right, as a car does", -1, -1, "full_stop"),
    _fly("side_left", "Side left", "Copter: fly to the left, without a turn", -1, 0),
    _fly("side_right", "Side right", "Copter: fly to the right, without a turn", 1, 0),
    _fly("climb", "Climb", "Copter: climb while held", 0, 1),
    _fly("descend", "Descend", "Copter: descend while held", 0, -1),
    OperatorAction("drive.override", "Override", "With a drive key: creep on before an obstacle that is not there",
                   "drive", DriveKeyDown(key="", throttle=0, steering=0, override=True), ("b",)),
    OperatorAction("drive.stop", "Stop", "Neutral at once; ends latched driving", "stop", Stop(),
                   ("k", "space", "ctrl+k")),
    OperatorAction("stop.emergency", "EMERGENCY STOP", "Motors off and locked, from every screen", "stop",
                   EmergencyStop(), ("exclamation_mark", "f9")),
    OperatorAction("stop.clear", "Clear e-stop", "Release the emergency stop; arming is a separate step", "stop",
                   ClearEmergencyStop(), ("t",), confirm=True),
    _speed("faster", "Faster", "Raise the speed and turn limits by 10 points; never moves the vehicle", FASTER, FASTER),
    _speed("slower", "Slower", "Lower the speed and turn limits by 10 points", SLOWER, SLOWER),
    _speed("throttle_faster", "Speed +", "Raise the speed limit by 10 points", FASTER, 0.0),
    _speed("throttle_slower", "Speed -", "Lower the speed limit by 10 points", SLOWER, 0.0),
    _speed("steering_faster", "Turn +", "Raise the turn limit by 10 points", 0.0, FASTER),
    _speed("steering_slower", "Turn -", "Lower the turn limit by 10 points", 0.0, SLOWER),
    OperatorAction("view.pane", "View", "Next pane of the Drive screen", "view", keys=("v",), steady=True),
    OperatorAction("view.picture", "Picture", "Drive by the camera: it fills Drive, and keys drive while it is fresh",
                   "view", keys=("f",), steady=True),
    OperatorAction("view.closer", "Closer", "Zoom in on the pane", "view", keys=("pageup",), steady=True),
    OperatorAction("view.wider", "Wider", "Zoom out of the pane", "view", keys=("pagedown",), steady=True),
    OperatorAction("view.lesson", "Lesson", "Next page of the lesson, then hide it, then show it (mavhelm learn)",
                   "view", keys=("ctrl+l",)),
    OperatorAction("drive.gamepad", "Next gamepad", "Choose the next gamepad, of several", "drive"),
    OperatorAction("drive.style", "Style", "Next drive style: hold, latch, step", "drive", SetStyle(style="next"),
                   ("ctrl+y",)),  # not TAB, which chooses panels on the other screens: a latched key goes on by itself
    OperatorAction("vehicle.arm", "Arm", "Arm; when armed, one press disarms", "vehicle", Arm(), ("r",), confirm=True,
                   when_armed=Disarm()),
    OperatorAction("vehicle.disarm", "Disarm", "Motors off at once, armed or not", "vehicle", Disarm()),
    OperatorAction("vehicle.manual", "MANUAL", "Mode MANUAL: the keys drive", "vehicle", SetMode(mode="MANUAL"),
                   ("1",)),
    OperatorAction("vehicle.hold", "HOLD", "Mode HOLD: the vehicle stays stopped", "vehicle", SetMode(mode="HOLD"),
                   ("2",)),
    OperatorAction("vehicle.take_off", "Take off", "Copter: take off to the altitude that is set, and hover", "vehicle",
                   TakeOff(), confirm=True),
    OperatorAction("vehicle.land", "Land", "Copter: land here", "vehicle", SetMode(mode="LAND")),
    OperatorAction("vehicle.home", "Fly home", "Mode RTL: return and, of a copter, land", "vehicle",
                   SetMode(mode="RTL")),
    OperatorAction("stop.cut", "CUT MOTORS", "Copter: motors off in the air, hold for 2 s: IT FALLS", "stop",
                   CutMotors(), confirm=True),
    OperatorAction("vehicle.control", "Take control", "Request control of the vehicle", "vehicle", RequestControl(),
                   ("g",)),
    OperatorAction("vehicle.release", "Release control", "Stop, and release control of the vehicle", "vehicle",
                   ReleaseControl(), ("G",)),
    OperatorAction("vehicle.give", "Give control", "Give control to the ground station that asks for it", "vehicle",
                   GiveControl(), ("Y",)),
    OperatorAction("vehicle.keep", "Keep control", "Refuse the request of another ground station for control",
                   "vehicle", KeepControl(), ("N",)),
    OperatorAction("vehicle.give_up", "Give up keys", "Stop, and give up the keys: a program may drive then",
                   "vehicle", GiveUpKeys(), ("F",)),
    OperatorAction("vehicle.next", "Next vehicle", "Stop this vehicle and select the next one", "vehicle",
                   SelectNextVehicle(), ("n",)),
    OperatorAction("agent.permit", "Permit agent", "Let the proposal of an agent run while this key is held", "vehicle",
                   PermitProposal(), ("p", "Z"), confirm=True, keeps=True),
    OperatorAction("agent.decline", "Decline", "Decline the proposal of an agent", "vehicle", DeclineProposal(),
                   ("P", "K")),
    OperatorAction("app.simulator", "Simulator", "Start a simulated rover", "app", StartSimulator()),
    *(OperatorAction(screen.action, screen.title, screen.help, "app", keys=screen.keys) for screen in SCREENS),
    OperatorAction("app.goto", "Go to", "Menu of the screens; then the digit of one", "app", keys=("ctrl+g",)),
    OperatorAction("app.command", "Command", "Command line: verbs, screens by name", "app", keys=("colon",)),
    OperatorAction("app.mute", "Mute", "Mute what --speak says, or speak again", "app", keys=("quotation_mark",),
                   steady=True),
    OperatorAction("app.next_screen", "Next screen", "Screen to the right in the tab bar", "app",
                   keys=("right_square_bracket",)),
    OperatorAction("app.previous_screen", "Previous screen", "Screen to the left in the tab bar", "app",
                   keys=("left_square_bracket",)),
    OperatorAction("app.quit", "Quit", "Stop the vehicle and quit", "app", keys=("ctrl+q", "ctrl+c")),
)  # fmt: skip

AGENT_ACTIONS = ("agent.permit", "agent.decline")
"""Those whose keys count on each screen that has no use of its own for them."""

ACTIONS: dict[str, OperatorAction] = {action.id: action for action in _ROWS}
"""Every action by id, in the order of the help screen."""
