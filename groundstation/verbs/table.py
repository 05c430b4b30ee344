"""All verbs. The row of each is in the table of its room: groundstation/verbs/control/table.py and so on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from groundstation.verbs.control.table import VERBS as CONTROL
from groundstation.verbs.files.table import VERBS as FILES
from groundstation.verbs.messages.table import VERBS as MESSAGES
from groundstation.verbs.mission.table import VERBS as MISSION
from groundstation.verbs.ros.table import VERBS as ROS
from groundstation.verbs.setup.table import VERBS as SETUP
from groundstation.verbs.verb import Example, Stage, Verb

VERBS: dict[str, Verb] = {**MESSAGES, **SETUP, **CONTROL, **FILES, **MISSION, **ROS}
"""Verb -> its row. Examples of one stage run in this order."""


def find_examples(stages: Iterable[Stage]) -> Iterator[Example]:
    """Yield the examples of these stages, as one session runs them."""
    for stage in stages:
        for verb in VERBS.values():
            yield from (each for each in verb.examples if each.stage is stage)
