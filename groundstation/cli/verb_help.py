"""The verbs of `groundstation`, for --help. groundstation/verbs/table.py has what they do."""

from __future__ import annotations

VERB_HELP = {
    "status": "print the state of a vehicle",
    "vehicles": "print the vehicles that are heard",
    "links": "print what arrives on each link",
    "arm": "arm a vehicle",
    "disarm": "disarm, repeated until it is so",
    "stop": "change to HOLD, repeated until it is so",
    "estop": "stop the motors and lock them; --clear releases them",
    "control": "show, request, release or give control of a vehicle",
    "goto": "drive to a place",
    "home": "drive home",
    "speed": "set the speed of modes that drive by themselves",
    "messages": "print which messages arrive, and their rates",
    "watch": "print the values of a message, until a condition holds",
    "send": "send a message, once or at a rate",
    "command": "send a MAV_CMD",
    "request": "request one message and print it",
    "rate": "set how often a message comes",
    "ping": "measure round trips to a vehicle",
    "param": "get, set, save, load, diff, store or reset parameters of a vehicle",
    "mission": "show, get, put or clear the mission",
    "fence": "show, get, put or clear the fence",
    "rally": "show, get, put or clear the rally points",
    "modes": "print the modes of the vehicle",
    "mode": "change the mode",
    "reboot": "restart the vehicle",
    "doctor": "print why the vehicle cannot be driven",
    "motor": "turn one motor of a disarmed vehicle",
    "calibrate": "calibrate gyros, level or pressure",
    "ftp": "ls, get, put, rm or crc files on the vehicle",
    "log": "list or get the logs on the vehicle",
}
"""Verb -> what it does with a vehicle."""

LOCAL_HELP = {
    "config": "check, show, init or path of the config file",
    "keys": "show what this terminal sends for keys",
    "completion": "print a script that completes verbs in bash, zsh or fish",
}
"""Verb without a vehicle -> what it does."""

RESERVED = frozenset({**VERB_HELP, **LOCAL_HELP})
"""What cannot be the name of an endpoint."""


def verb_help() -> str:
    """Return the verbs as lines for --help."""
    return "\n".join(f"  groundstation {name:<10} {text}" for name, text in {**VERB_HELP, **LOCAL_HELP}.items())
