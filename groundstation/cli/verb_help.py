"""The verbs of `groundstation`, for --help. groundstation/verbs/table.py has what they do."""

from __future__ import annotations

VERB_HELP = {
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
}
"""Verb without a vehicle -> what it does."""

RESERVED = frozenset({**VERB_HELP, **LOCAL_HELP})
"""What cannot be the name of an endpoint."""


def verb_help() -> str:
    """Return the verbs as lines for --help."""
    return "\n".join(f"  groundstation {name:<9} {text}" for name, text in {**VERB_HELP, **LOCAL_HELP}.items())
