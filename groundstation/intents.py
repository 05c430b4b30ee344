"""What an operator can ask for: the intents sent to the station process, and the table of actions that make them.

A new operator action is an intent class here with its row in ACTIONS, and its handler in station/intent_handler.py.
Intents are msgspec structs because keys are read in the screen's process and handled in the station process.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, TypeAlias, Union

import msgspec

from groundstation.screens import SCREENS
from groundstation.views import AnyRequest

LEASE_TIMEOUT = 0.3
"""s without a renewal after which the screen counts as frozen: three renewals at its 10 Hz, and longer than its longest
drawing (0.1 s). A frozen screen then means neutral well within 0.5 s."""

HOLD_TIME = 1.0
"""s for which the key of an action with `confirm` must be held (input/hold_to_confirm.py); the station checks it."""

STOP_KEY = "stop key"
"""The reason of a Stop that the operator requested with a key; other reasons mean that the screen cannot drive now."""

FASTER, SLOWER = 1.1, 0.9
"""Factors of one press of a speed key, those of teleop_twist_keyboard."""


class Intent(msgspec.Struct, frozen=True, tag=True):
    """Base class of all intents."""

    is_input: ClassVar[bool] = True
    """The operator did something. False for what the screen sends on its own."""

    valid_when_late: ClassVar[bool] = False
    """Handled even when older than ipc.MAX_INTENT_AGE: the intent only ever stops, or reports a state."""


class DriveKeyDown(Intent, frozen=True):
    """A drive key went down, or repeats; -1, 0 or +1 for each axis."""

    key: str
    throttle: int
    steering: int
    repeat: bool = False
    """The terminal reports an auto-repeat (only terminals that report key releases do)."""


class DriveKeyUp(Intent, frozen=True):
    """A drive key went up. Only some terminals report it; elsewhere the sticks return to neutral by a timer."""

    valid_when_late = True
    key: str


class Stop(Intent, frozen=True):
    """Neutral at once; also ends latched driving. A stop key puts a vehicle in an autonomous mode into HOLD as well."""

    valid_when_late = True
    reason: str = STOP_KEY


class EmergencyStop(Intent, frozen=True):
    """Motors off at once and locked: a command, repeated until acknowledged."""

    valid_when_late = True


class ClearEmergencyStop(Intent, frozen=True):
    """Release the emergency stop; arming is a separate step."""

    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""


class ScaleLimits(Intent, frozen=True):
    """Scale the limits of the sticks; never moves the vehicle. Factors above 0, e.g. 1.1."""

    throttle: float = 1.0
    steering: float = 1.0


class SetStyle(Intent, frozen=True):
    """Set the drive style: "hold", "latch" or "step"; "next" selects the one after the current style."""

    style: str


class ReportKeyReleases(Intent, frozen=True):
    """The terminal has proved that it reports key releases: no timers are needed any more."""

    is_input = False
    valid_when_late = True


class SetKeyGate(Intent, frozen=True):
    """Open or close the key gate. It is closed under another screen, without focus and without a terminal."""

    is_input = False
    valid_when_late = True
    open: bool
    reason: str = ""


class RenewLease(Intent, frozen=True):
    """The screen's event loop runs. Without renewals the station sends neutral, then nothing."""

    is_input = False


class Arm(Intent, frozen=True):
    """Arm the vehicle, after changing to MANUAL if it is in HOLD."""

    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""


class Disarm(Intent, frozen=True):
    """Disarm the vehicle."""

    valid_when_late = True


class SetMode(Intent, frozen=True):
    """Change the mode; `mode` is a name of dialects.modes.Mode."""

    mode: str


class RequestControl(Intent, frozen=True):
    """Request to be the ground station in control (MAV_CMD_REQUEST_OPERATOR_CONTROL)."""


class ReleaseControl(Intent, frozen=True):
    """Release control of the selected vehicle: neutral, then it is free for others."""

    valid_when_late = True
    all: bool = False
    """Of every vehicle that we control."""


class GiveControl(Intent, frozen=True):
    """Give control to the ground station that asks for it; without such a request nothing happens."""


class KeepControl(Intent, frozen=True):
    """Refuse the request of another ground station for control."""


class SelectVehicle(Intent, frozen=True):
    """Select the vehicle with this system id."""

    system: int


class SelectNextVehicle(Intent, frozen=True):
    """Select the vehicle with the next higher system id; after the last comes the first."""


class StartSimulator(Intent, frozen=True):
    """Start a simulated rover as a child of the station process and let it connect to us."""


class Watch(Intent, frozen=True):
    """Send these views from now on, and no others: what the screen on top needs beside the snapshot."""

    is_input = False
    valid_when_late = True
    requests: tuple[AnyRequest, ...] = ()


class FetchParams(Intent, frozen=True):
    """Fetch all parameters of the selected vehicle."""

    request: int
    """Number by which views report how it stands; chosen by the screen, rising from 1."""


class WriteParams(Intent, frozen=True):
    """Set parameters of the selected vehicle, one after the other; stops at the first that is not set."""

    request: int
    """Number by which views report how it stands; chosen by the screen, rising from 1."""
    system: int
    """The vehicle that the operator saw: another one that is selected meanwhile must not get them."""
    changes: tuple[tuple[str, float], ...]
    """Names and values."""


class CancelRequest(Intent, frozen=True):
    """Cancel a request; what was set or sent before stays."""

    request: int


class Quit(Intent, frozen=True):
    """Send neutral several times and exit."""

    is_input = False
    valid_when_late = True
    disarm: bool = False
    """Disarm before the exit what this station armed; another Quit without it meanwhile leaves that armed."""


if TYPE_CHECKING:
    AnyIntent: TypeAlias = Intent
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyIntent = Union[tuple(Intent.__subclasses__())]  # noqa: UP007
"""Any of the intents above."""


@dataclass(frozen=True, slots=True)
class OperatorAction:
    """Something an operator can ask for with a key or in the command palette."""

    id: str
    label: str
    """One or two words for the footer."""
    help: str
    group: str
    """"drive", "stop", "speed", "vehicle" or "app"."""
    intent: AnyIntent | None = None
    """Sent to the station; None where the screen acts itself. The key's name is added to a DriveKeyDown."""
    keys: tuple[str, ...] = ()
    """Keys in every key map, by Textual's names ("i", "comma", "up", "ctrl+q"). KEYMAPS (input/keymap.py) adds more."""
    confirm: bool = False
    """The key must be held for HOLD_TIME; then `intent` is sent, with that time in its field `held` if it has one."""
    when_armed: AnyIntent | None = None
    """Sent in place of `intent`, without confirmation, while the vehicle is armed."""


def _drive(name: str, label: str, text: str, throttle: int, steering: int, *keys: str) -> OperatorAction:
    intent = DriveKeyDown(key="", throttle=throttle, steering=steering)
    return OperatorAction(f"drive.{name}", label, text, "drive", intent, keys)


def _speed(name: str, label: str, text: str, throttle: float, steering: float) -> OperatorAction:
    return OperatorAction(f"speed.{name}", label, text, "speed", ScaleLimits(throttle=throttle, steering=steering))


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
    OperatorAction("drive.stop", "Stop", "Neutral at once; ends latched driving", "stop", Stop(),
                   ("k", "space", "ctrl+k")),
    OperatorAction("stop.emergency", "EMERGENCY STOP", "Motors off and locked, from every screen", "stop",
                   EmergencyStop(), ("exclamation_mark", "f9")),
    OperatorAction("stop.clear", "Clear e-stop", "Release the emergency stop; arming is a separate step", "stop",
                   ClearEmergencyStop(), ("t",), confirm=True),
    _speed("faster", "Faster", "Raise both limits by 10 %; never moves the vehicle", FASTER, FASTER),
    _speed("slower", "Slower", "Lower both limits by 10 %", SLOWER, SLOWER),
    _speed("throttle_faster", "Throttle +", "Raise the throttle limit by 10 %", FASTER, 1.0),
    _speed("throttle_slower", "Throttle -", "Lower the throttle limit by 10 %", SLOWER, 1.0),
    _speed("steering_faster", "Steering +", "Raise the steering limit by 10 %", 1.0, FASTER),
    _speed("steering_slower", "Steering -", "Lower the steering limit by 10 %", 1.0, SLOWER),
    OperatorAction("drive.style", "Style", "Next drive style: hold, latch, step", "drive", SetStyle(style="next"),
                   ("tab",)),
    OperatorAction("vehicle.arm", "Arm", "Arm; when armed, one press disarms", "vehicle", Arm(), ("r",), confirm=True,
                   when_armed=Disarm()),
    OperatorAction("vehicle.disarm", "Disarm", "Disarm", "vehicle", Disarm()),
    OperatorAction("vehicle.manual", "MANUAL", "Mode MANUAL: the keys drive", "vehicle", SetMode(mode="MANUAL"),
                   ("1",)),
    OperatorAction("vehicle.hold", "HOLD", "Mode HOLD: the vehicle stays stopped", "vehicle", SetMode(mode="HOLD"),
                   ("2",)),
    OperatorAction("vehicle.control", "Take control", "Request control of the vehicle", "vehicle", RequestControl(),
                   ("g",)),
    OperatorAction("vehicle.release", "Release control", "Stop, and release control of the vehicle", "vehicle",
                   ReleaseControl(), ("G",)),
    OperatorAction("vehicle.give", "Give control", "Give control to the ground station that asks for it", "vehicle",
                   GiveControl(), ("Y",)),
    OperatorAction("vehicle.keep", "Keep control", "Refuse the request of another ground station for control",
                   "vehicle", KeepControl(), ("N",)),
    OperatorAction("vehicle.next", "Next vehicle", "Stop this vehicle and select the next one", "vehicle",
                   SelectNextVehicle(), ("n",)),
    OperatorAction("app.simulator", "Simulator", "Start a simulated rover", "app", StartSimulator(), ("f5",)),
    *(OperatorAction(screen.action, screen.title, screen.help, "app", keys=screen.keys) for screen in SCREENS),
    OperatorAction("app.goto", "Go to", "Menu of the screens; then the digit of one", "app", keys=("ctrl+g",)),
    OperatorAction("app.next_screen", "Next screen", "Screen to the right in the tab bar", "app",
                   keys=("right_square_bracket",)),
    OperatorAction("app.previous_screen", "Previous screen", "Screen to the left in the tab bar", "app",
                   keys=("left_square_bracket",)),
    OperatorAction("app.quit", "Quit", "Stop the vehicle and quit", "app", keys=("ctrl+q", "ctrl+c")),
)  # fmt: skip

ACTIONS: dict[str, OperatorAction] = {action.id: action for action in _ROWS}
"""Every action by id, in the order of the help screen."""
