"""The result of a round, as pytest writes it to a JUnit file."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import msgspec

FAULTS = ("failure", "error")
"""Elements of a test case that has not passed."""


class Round(msgspec.Struct, frozen=True):
    """What one round has shown."""

    passed: tuple[str, ...]
    failed: tuple[str, ...]
    skipped: tuple[str, ...]

    @property
    def summary(self) -> str:
        """The counts in words."""
        return f"{len(self.passed)} passed, {len(self.failed)} failed, {len(self.skipped)} skipped"


def read_round(junit: Path) -> Round:
    """Return the result in a JUnit file; a test that fails and has an error when it ends has failed once.

    Raises OSError and ElementTree.ParseError.
    """
    passed: list[str] = []
    failed: list[str] = []
    skipped: list[str] = []
    for case in ElementTree.parse(junit).iter("testcase"):
        name = f"{case.get('classname')}::{case.get('name')}"
        if any(case.find(fault) is not None for fault in FAULTS):
            failed.append(name)
        elif case.find("skipped") is not None:
            skipped.append(name)
        else:
            passed.append(name)
    return Round(*(tuple(dict.fromkeys(names)) for names in (passed, failed, skipped)))


def count_failures(rounds: list[Round]) -> dict[str, int]:
    """Return how often each test has failed, the most frequent first."""
    counts: dict[str, int] = {}
    for each in rounds:
        for name in each.failed:
            counts[name] = counts.get(name, 0) + 1
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))
