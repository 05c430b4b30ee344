"""The table of all verbs and their actions, with their arguments.

To add an action, write its function in a module beside this one and add its row. A new verb also needs its line in
groundstation/cli/verb_help.py.
"""

from __future__ import annotations

import argparse
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Any

from dialects.enums import MissionType
from groundstation.formats.param_file import ParamForm
from groundstation.verbs import calibrate, doctor, ftp, log, mode, motor, param, plan, reboot
from groundstation.verbs.output import Output
from link.services.param.float32 import is_float32

Argument = tuple[str, dict[str, Any]]
"""Name and settings for argparse."""


@dataclass(frozen=True, slots=True)
class VerbAction:
    """One action of a verb."""

    help: str
    run: Callable[[Any, argparse.Namespace, Output], Awaitable[int]]
    """Gets a VerbSession, or a StationSession; returns the exit code."""
    arguments: tuple[Argument, ...] = field(default=())
    station: bool = False
    """`run` gets a StationSession: a whole ground station without a screen. It finds its vehicle itself."""


def number(text: str) -> float:
    """Parse a value that a parameter can have. Raises ArgumentTypeError."""
    try:
        value = float(int(text, 16)) if text.lower().startswith("0x") else float(text)
    except (ValueError, OverflowError):
        value = float("nan")
    if not is_float32(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number that a parameter can have")
    return value


_PATTERNS = ("patterns", {"nargs": "*", "metavar": "PATTERN", "help": "names; * and ? match any characters"})
_FILE = ("file", {"metavar": "FILE"})
_REMOTE = ("remote", {"metavar": "REMOTE", "help": "path on the vehicle, e.g. /logs/00000001.tlog"})
_YES = ("--yes", {"action": "store_true", "help": "overwrite the file"})
_FORMAT = ("--format", {"choices": [form.value for form in ParamForm], "default": ParamForm.MAVPROXY.value,
                        "help": "MAVProxy (default), QGroundControl or Mission Planner"})  # fmt: skip


ONLY = ""
"""Name of the action of a verb that has only one, and takes no name for it."""


def _plan_actions(kind: MissionType) -> dict[str, VerbAction]:
    name = kind.name.lower()
    return {
        "show": VerbAction(f"print the {name}", plan.show(kind)),
        "get": VerbAction(f"download the {name} into a file: .plan, or .waypoints for a mission", plan.get(kind),
                          (_FILE, _YES)),
        "put": VerbAction(f"upload the {name} of a file", plan.put(kind), (_FILE,)),
        "clear": VerbAction(f"clear the {name} on the vehicle", plan.clear(kind)),
    }  # fmt: skip


VERBS: dict[str, dict[str, VerbAction]] = {
    "param": {
        "get": VerbAction("print parameters", param.get, (_PATTERNS,)),
        "set": VerbAction(
            "set one parameter", param.set_value,
            (("name", {"metavar": "NAME"}), ("value", {"metavar": "VALUE", "type": number})),
        ),
        "save": VerbAction(
            "write parameters to a file", param.save,
            (_FILE, _PATTERNS, ("--changed", {"action": "store_true", "help": "only those not at the default"}),
             _FORMAT, _YES),
        ),
        "load": VerbAction(
            "set what differs from a file; stop at the first refusal", param.load,
            (_FILE, ("--dry-run", {"action": "store_true", "help": "only print what would be set"})),
        ),
        "diff": VerbAction("print where a file and the vehicle differ", param.diff, (_FILE,)),
        "store": VerbAction("have the vehicle store all parameters", param.store),
        "reset": VerbAction("have the vehicle reset all parameters to their defaults", param.reset,
                            (("--yes", {"action": "store_true", "help": "do it: there is no undo"}),)),
    },
    **{verb: _plan_actions(kind) for verb, kind in plan.KINDS},
    "modes": {ONLY: VerbAction("print the modes of the vehicle; > marks the current one", mode.list_modes)},
    "mode": {ONLY: VerbAction("change the mode; done when the heartbeat reports it", mode.set_mode,
                              (("name", {"metavar": "MODE"}),))},
    "reboot": {ONLY: VerbAction("restart the vehicle; it refuses while it is armed", reboot.run)},
    "doctor": {ONLY: VerbAction(
        "print why the vehicle cannot be driven, and what to do", doctor.run,
        (("--report", {"metavar": "FILE", "help": "write a report for a bug, without keys and public addresses"}),
         _YES, ("--station", {"type": int, "default": 255, "metavar": "ID",
                              "help": "system id of the ground station that will drive (default: 255)"})),
        station=True,
    )},
    "motor": {ONLY: VerbAction(
        "turn one motor of a disarmed vehicle, wheels off the ground", motor.run,
        (("number", {"type": int, "metavar": "N", "help": "its number, as on the Setup screen"}),
         ("throttle", {"type": motor.percent, "metavar": "PERCENT", "help": "up to 30, negative for backward"}),
         ("--for", {"dest": "seconds", "type": motor.duration, "default": 1.0, "metavar": "S",
                    "help": "how long, up to 2 s (default: 1)"})),
        station=True,
    )},
    "calibrate": {ONLY: VerbAction(
        "calibrate gyros, level or pressure, at rest", calibrate.run,
        (("kind", {"choices": calibrate.CHOICES, "metavar": "KIND", "help": ", ".join(calibrate.CHOICES)}),),
    )},
    "ftp": {
        "ls": VerbAction("list a folder", ftp.ls, (("path", {"nargs": "?", "default": "/", "metavar": "FOLDER"}),)),
        "get": VerbAction("download a file, resume, and compare its checksum", ftp.get,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"}), _YES)),
        "put": VerbAction("upload a file and compare its checksum", ftp.put, (("local", {"metavar": "FILE"}), _REMOTE)),
        "rm": VerbAction("remove a file", ftp.rm, (_REMOTE,)),
        "crc": VerbAction("print the checksum of a file, or compare it with a file here", ftp.crc,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"}))),
    },
    "log": {
        "list": VerbAction("print the logs on the vehicle", log.list_logs),
        "get": VerbAction("download a log, or resume", log.get,
                          (("log", {"metavar": "ID", "help": "number of the log, or latest"}),
                           ("file", {"nargs": "?", "metavar": "FILE"}), _YES)),
    },
}  # fmt: skip
"""Verb -> its actions."""
