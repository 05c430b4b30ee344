"""REQUIREMENTS: what a computer must have for a lesson, and why the lesson is skipped without it."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping

import msgspec


class Requirement(msgspec.Struct, frozen=True):
    """One row."""

    present: Callable[[], bool]
    missing: str
    """Why a lesson is skipped, and what to do."""


REQUIREMENTS: Mapping[str, Requirement] = {
    "ros1": Requirement(
        lambda: all(shutil.which(each) for each in ("roscore", "rostopic")),
        "ROS 1 is not installed: `apt install ros-core`, docs/ros.md",
    ),
}
"""Name in a lesson -> row."""


def find_missing(names: Iterable[str]) -> str:
    """Return why a lesson cannot be done here; "" if it can."""
    return next((REQUIREMENTS[name].missing for name in names if not REQUIREMENTS[name].present()), "")
