"""Verb: a row of the tables of verbs, with its actions, its examples and its place in `mavhelm --help`."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum, StrEnum

import msgspec

from groundstation.verbs.action import ONLY, VerbAction


class Group(StrEnum):
    """What a person wants: the headings of `mavhelm --help`, in this order."""

    DRIVE = "drive"
    VEHICLE = "vehicle"
    PLANS = "plans"
    DATA = "data"
    LINKS = "links"
    SETUP = "set-up"


class Stage(IntEnum):
    """When an example runs. All together are one session with the simulated rover; within a stage the tables decide."""

    DISARMED = 0
    ARMED = 1
    MOVING = 2
    STOPPED = 3
    """Armed, in HOLD."""
    STOPPING = 4
    IN_CONTROL = 5
    """Disarmed again, and in control: erases and clears."""
    AFTERWARDS = 6
    KEYS = 7
    """Changes the key that signs, so that the vehicles before are not heard any more."""
    OTHER_VEHICLE = 8
    """Needs an autopilot with a compass, a radio control receiver or a file system to write to."""


class Example(msgspec.Struct, frozen=True):
    """A command line for docs/commands.md and for --help."""

    command: str
    note: str
    """What it does."""
    stage: Stage = Stage.DISARMED


class Verb(msgspec.Struct, frozen=True):
    """One verb of `mavhelm`."""

    group: Group
    examples: tuple[Example, ...]
    """At least one for each action. Tests run them, but for those of OTHER_VEHICLE."""
    actions: dict[str, VerbAction]
    """Name -> action; only `ONLY` for a verb that takes no name."""
    summary: str = ""
    """One line for --help that names all actions; not needed for a verb with one."""
    mavproxy: dict[str, str] = msgspec.field(default_factory=dict)
    """Word or two of MAVProxy -> the words behind `mavhelm` that do the same; mavproxy_words.py answers with them."""

    @property
    def help(self) -> str:
        """Return one line that says what it does."""
        return self.summary or self.actions[ONLY].help


def format_examples(examples: Iterable[Example]) -> str:
    """Return examples as lines for --help."""
    rows = list(examples)
    width = max((len(each.command) for each in rows if len(each.command) < 50), default=0)
    return "\n".join(["examples:", *(f"  {each.command:<{width}}  {each.note}" for each in rows)])
