"""TOOLS: what an agent can call. A reading tool and a stop run at once; what else changes something is a proposal.

There is none that releases an emergency stop, changes keys, takes or gives control, or names a file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum, auto
from typing import Any

import msgspec

from groundstation.verbs.agents.arguments import Argument, ArgumentKind, build_schema
from groundstation.verbs.common.arguments import LONGEST_HOLD

INSTANT = 15.0
"""s for which the key is held at most until a change is done that takes no time by itself."""
LONGEST_TRIP = 120.0
"""s for which the vehicle may drive by itself in one proposal, while the key is held."""
FARTHEST = 100.0
"""m in one proposal."""


class ToolEffect(Enum):
    """What a tool does."""

    READ = auto()
    STOP = auto()
    """Stopping is always allowed, to everybody."""
    PROPOSE = auto()


Values = Mapping[str, Any]


class Tool(msgspec.Struct, frozen=True):
    """One tool."""

    help: str
    words: Callable[[Values], tuple[str, ...]]
    """Returns the verb that does it, as a command line; empty for what the station answers itself."""
    arguments: tuple[Argument, ...] = ()
    effect: ToolEffect = ToolEffect.READ
    text: Callable[[Values], str] = lambda _: ""
    """Returns what is proposed, for the operator."""
    seconds: float | None = None
    """s for which it may run; None: the agent says how long."""
    lead: float = 0.0
    """s that it takes until it begins, which count besides."""
    travels: bool = False
    """The vehicle drives by itself afterwards, and the permission lasts until it stands."""

    @property
    def all_arguments(self) -> tuple[Argument, ...]:
        """Its own arguments, and those that every tool has."""
        if self.effect is not ToolEffect.PROPOSE:
            return (*self.arguments, VEHICLE, _REASON)
        return (*self.arguments, VEHICLE, REASON, WAIT)

    @property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of its arguments."""
        return build_schema(self.all_arguments)


VEHICLE = Argument("vehicle", "system id of the vehicle; the selected one if it is left out", ArgumentKind.INTEGER,
                   1, 255, needed=False)  # fmt: skip
REASON = Argument("reason", "why, in words for the operator, who reads it before permitting", ArgumentKind.TEXT)
_REASON = msgspec.structs.replace(REASON, needed=False, default="")
WAIT = Argument("wait_seconds", "s to wait for the operator", ArgumentKind.NUMBER, 1, 60, needed=False, default=30.0)
_SECONDS = Argument("seconds", "s for which it may drive at most", ArgumentKind.NUMBER, 1, LONGEST_TRIP)
_METERS = Argument("max_meters", "m that it may cover at most", ArgumentKind.NUMBER, 0.1, FARTHEST)
_LISTEN = Argument("seconds", "s to listen", ArgumentKind.NUMBER, 0.5, 10, needed=False, default=2.0)
_TRAVEL = (_SECONDS, _METERS)


def _name(name: str, text: str, pattern: str = r"[A-Za-z0-9_*?][A-Za-z0-9_.*?]*") -> Argument:
    return Argument(name, text, ArgumentKind.TEXT, pattern=pattern)


def _words(*words: str) -> Callable[[Values], tuple[str, ...]]:
    return lambda _: words


def _percent(name: str, text: str, low: float = -100) -> Argument:
    return Argument(name, f"{text}, %", ArgumentKind.NUMBER, low, 100, needed=False, default=0.0)


def _within(values: Values) -> str:
    return f"up to {values['max_meters']:g} m"


def _drive_text(values: Values) -> str:
    turn = values["steering"]
    side = f", steering {abs(turn):g} % {'right' if turn > 0 else 'left'}" if turn else ""
    ahead = f"{'backward' if values['throttle'] < 0 else 'forward'} at {abs(values['throttle']):g} %"
    return f"drive {ahead if values['throttle'] else 'on the spot'}{side} for {values['seconds']:g} s"


TOOLS: dict[str, Tool] = {
    "status": Tool("State of the vehicle: mode, armed, control, battery, position.", _words("status")),
    "vehicles": Tool("Vehicles that are heard.", _words("vehicles")),
    "control": Tool("Who is in control of the vehicle.", _words("control", "show")),
    "links": Tool("What arrives on each link.", lambda given: ("links", f"--for={given['seconds']}"), (_LISTEN,)),
    "doctor": Tool("Why the vehicle cannot be driven, and what to do.", _words("doctor")),
    "modes": Tool("Modes of the vehicle.", _words("modes")),
    "messages": Tool("Which messages arrive, and their rates.",
                     lambda given: ("messages", f"--for={given['seconds']}"), (_LISTEN,)),
    "watch": Tool("Fields of each message of a kind for some seconds.",
                  lambda given: ("watch", given["message"], f"--timeout={given['seconds']}"),
                  (_name("message", "a message or one of its fields, such as VFR_HUD.groundspeed"), _LISTEN)),
    "get_params": Tool("Parameters whose names fit a pattern; * and ? match any characters.",
                       lambda given: ("param", "get", given["pattern"]), (_name("pattern", "a name or a pattern"),)),
    "mission": Tool("The mission on the vehicle.", _words("mission", "show")),
    "fence": Tool("The fence on the vehicle.", _words("fence", "show")),
    "rally": Tool("The rally points on the vehicle.", _words("rally", "show")),
    "vehicle_logs": Tool("Logs that the vehicle has.", _words("log", "list")),
    "texts": Tool("The newest lines of the log of the ground station, with the texts of the vehicles.", _words()),
    "proposals": Tool("Proposals that wait for the operator or run.", _words()),
    "stop": Tool("Stop: HOLD. It runs at once, and ends what runs.", _words("stop"), effect=ToolEffect.STOP),
    "disarm": Tool("Motors off. It runs at once, and ends what runs.", _words("disarm"), effect=ToolEffect.STOP),
    "emergency_stop": Tool("Motors off and locked until a person releases them; what flies lands. It runs at once.",
                           _words("estop"), effect=ToolEffect.STOP),
    "arm": Tool("Arm the vehicle.", _words("arm"), effect=ToolEffect.PROPOSE, text=lambda _: "arm", seconds=INSTANT),
    "drive": Tool("Drive by hand for a time, then neutral.",
                  lambda given: ("drive", f"--throttle={given['throttle']}", f"--steering={given['steering']}",
                                 f"--for={given['seconds']}"),
                  (_percent("throttle", "negative for backward"), _percent("steering", "positive to the right"),
                   Argument("seconds", "s to drive", ArgumentKind.NUMBER, 0.1, LONGEST_HOLD), _METERS),
                  ToolEffect.PROPOSE, _drive_text, lead=1.0),
    "turn": Tool("Turn on the spot by an angle, then neutral.",
                 lambda given: ("turn", f"--steering={given['demand']}", "--", f"{given['degrees']}"),
                 (Argument("degrees", "positive to the right", ArgumentKind.NUMBER, -360, 360),
                  msgspec.structs.replace(_percent("demand", "of steering", 10), default=40.0)),
                 ToolEffect.PROPOSE, lambda given: f"turn by {given['degrees']:g} degrees", LONGEST_HOLD),
    "set_mode": Tool("Change the mode. A mode that drives by itself ends with HOLD.",
                     lambda given: ("mode", given["mode"]),
                     (_name("mode", "the name of a mode", r"[A-Za-z][A-Za-z0-9_]*"), *_TRAVEL), ToolEffect.PROPOSE,
                     lambda given: f"mode {given['mode']}, {_within(given)}", travels=True),
    "goto": Tool("Drive to a place by itself; then HOLD.",
                 lambda given: ("goto", "--", f"{given['latitude']!r}", f"{given['longitude']!r}"),
                 (Argument("latitude", "degrees", ArgumentKind.NUMBER, -90, 90),
                  Argument("longitude", "degrees", ArgumentKind.NUMBER, -180, 180), *_TRAVEL), ToolEffect.PROPOSE,
                 lambda given: f"go to {given['latitude']:.6f}, {given['longitude']:.6f}, {_within(given)}",
                 travels=True),
    "home": Tool("Drive home by itself; then HOLD.", _words("home"), _TRAVEL, ToolEffect.PROPOSE,
                 lambda given: f"drive home, {_within(given)}", travels=True),
    "start_mission": Tool("Drive the mission on the vehicle, or go on with it; then HOLD.", _words("mission", "start"),
                          _TRAVEL, ToolEffect.PROPOSE, lambda given: f"drive the mission, {_within(given)}",
                           travels=True),
    "set_param": Tool("Set one parameter.", lambda given: ("param", "set", "--", given["name"], f"{given['value']!r}"),
                      (_name("name", "the name of a parameter", r"[A-Za-z0-9_]{1,16}"),
                       Argument("value", "its new value", ArgumentKind.NUMBER, -3.4e38, 3.4e38)),
                      ToolEffect.PROPOSE, lambda given: f"set {given['name']} to {given['value']:g}", INSTANT),
}  # fmt: skip
"""Name -> tool."""
