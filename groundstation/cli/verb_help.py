"""The verbs of `mavhelm`, for --help. groundstation/verbs/table.py has what they do."""

from __future__ import annotations

VERB_HELP = {
    "status": "print the state of a vehicle",
    "vehicles": "print the vehicles that are heard",
    "links": "print what arrives on each link",
    "arm": "arm a vehicle",
    "disarm": "disarm and wait for confirmation",
    "stop": "change to HOLD and wait for confirmation",
    "estop": "stop the motors and lock them; --clear releases them",
    "control": "show, request, release or give control of a vehicle",
    "goto": "drive to a place",
    "home": "drive home",
    "speed": "set the speed of modes that drive by themselves",
    "drive": "drive by hand, for a time or as a script of keys says",
    "messages": "print which messages arrive, and their rates",
    "watch": "print the values of a message, until a condition holds",
    "send": "send a message, once or at a rate",
    "record": "record what is heard into a telemetry log",
    "command": "send a MAV_CMD",
    "request": "request one message and print it",
    "rate": "set how often a message comes",
    "ping": "measure round trips to a vehicle",
    "param": "get, set, save, load, diff, store or reset parameters of a vehicle",
    "mission": "show, get, put, check or clear the mission; start, pause or jump",
    "fence": "show, get, put, check or clear the fence; on or off",
    "rally": "show, get, put, check or clear the rally points",
    "modes": "print the modes of the vehicle",
    "mode": "change the mode",
    "reboot": "restart the vehicle",
    "doctor": "print why the vehicle cannot be driven",
    "motor": "turn one motor of a disarmed vehicle",
    "calibrate": "calibrate gyros, level, pressure, compass or RC sticks",
    "ftp": "ls, get, put, rm or crc files on the vehicle",
    "log": "list, get or erase the logs on the vehicle",
    "sign": "new, show, install, setup, list, use or forget: keys for MAVLink signing",
    "ros1": "be a node of ROS 1: /command and /cmd_vel drive, telemetry is published",
    "ros2": "be a node of ROS 2: /cmd_vel drives, telemetry is published",
    "export": "write a telemetry log as MCAP, CSV, GPX, KML, JSON lines, or a part of it",
}
"""Verb -> what it does with a vehicle."""

LOCAL_HELP = {
    "config": "check, show, init or path of the config file",
    "attach": "drive or watch with a station that runs: after an SSH drop, or as a second screen",
    "serve": "run a station without a screen, for verbs, `mavhelm attach` and browsers",
    "keys": "show what this terminal sends for keys",
    "replay": "show a telemetry log in the screens, with a timeline and search",
    "completion": "print a script that completes verbs in bash, zsh or fish",
}
"""Verb without a vehicle -> what it does."""

PROGRAM_HELP = {
    "vehicle": "be a rover: the daemon with motors, or its simulator",
    "bridge": "join links; run the router of a fleet",
}
"""Other program of `mavhelm` (link/program.py) -> what it does."""

RESERVED = frozenset({**VERB_HELP, **LOCAL_HELP, **PROGRAM_HELP})
"""What cannot be the name of an endpoint."""


def verb_help() -> str:
    """Return the verbs as lines for --help."""
    return "\n".join(f"  mavhelm {name:<10} {text}" for name, text in {**VERB_HELP, **LOCAL_HELP}.items())
