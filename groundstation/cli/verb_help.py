"""Verbs without a vehicle, the other programs of `mavhelm`, and the help of all verbs.

groundstation/verbs/table.py has the verbs that do something with a vehicle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from groundstation.verbs.table import VERBS
from groundstation.verbs.verb import Example, Group, Verb, format_examples

LOCAL_VERBS: dict[str, Verb] = {
    "config": Verb(Group.SETUP, (
        Example("mavhelm config init", "write a file with all settings as comments"),
        Example("mavhelm config show", "what holds, and where it comes from"),
    ), {}, "check, show, init or path of the config file"),
    "attach": Verb(Group.LINKS, (
        Example("mavhelm attach", "the screen again, after SSH has dropped"),
    ), {}, "drive or watch with a station that runs: after an SSH drop, or as a second screen"),
    "serve": Verb(Group.LINKS, (
        Example("mavhelm serve --headless udpin:0.0.0.0:14550", "a station for verbs and `attach`"),
        Example("mavhelm serve --web", "the screens in a browser of this machine"),
    ), {}, "run a station without a screen, for verbs, `mavhelm attach` and browsers"),
    "keys": Verb(Group.SETUP, (
        Example("mavhelm keys", "q ends it"),
    ), {}, "show what this terminal sends for keys"),
    "replay": Verb(Group.DATA, (
        Example("mavhelm replay flight.tlog", "a telemetry log in the screens"),
    ), {}, "show a telemetry log in the screens, with a timeline and search"),
    "video": Verb(Group.LINKS, (
        Example("mavhelm video rtp:5600", "H.264 that a camera sends to port 5600; q ends it"),
        Example("mavhelm video rtsp://192.168.1.20/live --snapshot now.png", "one picture as a file"),
    ), {}, "show a camera in this terminal, with the age of its picture"),
    "learn": Verb(Group.DATA, (
        Example("mavhelm learn", "the first lesson that is not done"),
        Example("mavhelm learn list", "all lessons, and which are done"),
        Example("mavhelm learn 4", "lesson 4"),
    ), {}, "learn to drive, and what MAVLink is, in lessons with simulated rovers"),
    "completion": Verb(Group.SETUP, (
        Example("mavhelm completion fish | source", "until the shell ends"),
    ), {}, "print a script that completes verbs in bash, zsh or fish"),
}  # fmt: skip
"""Verb without a vehicle -> its row; groundstation/cli/main.py runs it."""

PROGRAMS: dict[str, Verb] = {
    "vehicle": Verb(Group.VEHICLE, (), {}, "be a rover: the daemon with motors, or its simulator"),
    "bridge": Verb(Group.LINKS, (), {}, "join links; run the router of a fleet"),
}
"""Other program of `mavhelm` (link/program.py) -> its row."""

EVERY_VERB: Mapping[str, Verb] = {**VERBS, **LOCAL_VERBS, **PROGRAMS}
"""Verb or program -> its row. No endpoint may have such a name."""


def group_verbs() -> Iterator[tuple[Group, list[str]]]:
    """Yield each heading of --help with its verbs and programs."""
    for group in Group:
        yield group, [name for name, verb in EVERY_VERB.items() if verb.group is group]


def verb_help() -> str:
    """Return the verbs as lines for --help-all."""
    return "\n".join(f"  mavhelm {name:<10} {verb.help}" for name, verb in {**VERBS, **LOCAL_VERBS}.items())


def local_examples(verb: str) -> str:
    """Return the examples of a verb without a vehicle as lines for its --help."""
    return format_examples(LOCAL_VERBS[verb].examples)
