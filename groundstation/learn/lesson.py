"""Lesson: what a lesson file holds. groundstation/learn/lesson_file.py reads it and checks what types cannot say."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Annotated

import msgspec

from groundstation.sitl.simulators import SimulatorRow

MOST_WORDS = 120
"""Of the text of a lesson: more is not read beside a rover that can be driven."""
MOST_TASK_WORDS = 45
"""Of one task or hint: it must fit into six lines of 80 columns with the one before it."""
WHY_LINES = 3
CODE_SIZE = (38, 12)
"""Columns and rows of code that fit into the pane."""

KEY = re.compile(r"`([^`]+)`")
"""A key in a text: that of an action (`drive.forward`), or one as it is typed (`TAB`)."""

ACTION = re.compile(r"[a-z_]+\.[a-z_]+")


class Checked(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A condition of the table CONDITIONS with its value."""

    check: str
    """Its name."""
    value: float = 0.0
    """How far, how fast, how long; its unit is in the table."""
    name: str = ""
    """Of what: a message, a parameter, a screen, or a part of a text."""


class Hint(Checked, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What is said after a wrong deed: the check is true of what was seen."""

    text: str


class Step(Checked, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One task. It is done when its check is true of what happened since the step before it."""

    task: str
    hints: tuple[Hint, ...] = ()


Percent = Annotated[float, msgspec.Meta(ge=0, le=100)]
Milliseconds = Annotated[float, msgspec.Meta(ge=0, le=60_000)]


class LessonSimulator(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A simulated rover of the lesson; docs/simulator.md has the meanings."""

    system: Annotated[int, msgspec.Meta(ge=1, le=255)] = 1
    loss: Percent = 0
    delay: Milliseconds = 0
    jitter: Milliseconds = 0
    cut: Annotated[float, msgspec.Meta(ge=0, le=3600)] = 0
    battery: Annotated[float, msgspec.Meta(ge=0, le=1)] = 1
    params: dict[str, float] = {}

    @property
    def options(self) -> tuple[str, ...]:
        """Its options of `mavhelm vehicle --sim`."""
        faults = {"--loss": self.loss, "--delay": self.delay, "--jitter": self.jitter, "--cut": self.cut}
        given = [f"{name}={value:g}" for name, value in faults.items() if value]
        given += [f"--sim-battery={self.battery:g}"] if self.battery < 1 else []
        given += [f"--param={name}={value:g}" for name, value in self.params.items()]
        return ("--system", str(self.system), "--sim-seed", str(self.system), *given)


class Lesson(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One lesson."""

    title: str
    text: str
    code: str = ""
    """Lines that are shown as they are, below the text."""
    why: tuple[str, ...]
    """Three lines that are shown when it is done."""
    screen: str = "drive"
    """Id of the screen that is shown first."""
    requires: tuple[str, ...] = ()
    """Names of REQUIREMENTS."""
    simulators: tuple[LessonSimulator, ...] = (LessonSimulator(),)
    steps: tuple[Step, ...]

    @property
    def simulator_row(self) -> SimulatorRow:
        """The simulators as one choice to start."""
        return SimulatorRow("lesson", "", self.title, "", tuple(each.options for each in self.simulators))


def is_action(key: str) -> bool:
    """Return whether a key in a text is named by an action."""
    return ACTION.fullmatch(key) is not None


def print_keys(text: str, key_of: Callable[[str], str]) -> str:
    """Return a text with each key as it is printed; `key_of` gives that of an action."""
    return KEY.sub(lambda found: f"[{key_of(found[1]) if is_action(found[1]) else found[1]}]", text)
