"""The shape of the source: rooms that can be read at a glance, and no class name for two things."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("groundstation", "link", "vehicle")
"""Not dialects: its modules are generated, and pymavlink names their classes."""
MOST = 17
"""Modules flat in one room."""
LARGER = {"vehicle/commands", "link/transport"}
"""Rooms that may have more: a module for each command of MAVLink, or for each kind of endpoint, all alike."""
CLASS = re.compile(r"^class ([A-Za-z]\w*)", re.MULTILINE)
SHARED = {"Fence", "Position", "Rover"}
"""The client's view of what the vehicle has, by the same name on purpose: `groundstation.rover` is a public API."""


def find_modules() -> list[Path]:
    """Return every module below PACKAGES, relative to the project."""
    return [path.relative_to(ROOT) for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


def test_no_room_has_more_than_17_modules() -> None:
    rooms = Counter(path.parent.as_posix() for path in find_modules() if path.name != "__init__.py")
    assert {room for room, modules in rooms.items() if modules > MOST} == LARGER


def test_every_room_says_what_it_holds() -> None:
    rooms = {path.parent for path in find_modules()}
    silent = [str(room) for room in rooms if not (ROOT / room / "__init__.py").read_text("utf-8").startswith('"""')]
    assert not silent


def test_no_class_name_stands_for_two_things() -> None:
    modules = defaultdict(list)
    for path in find_modules():
        for name in set(CLASS.findall((ROOT / path).read_text("utf-8"))):
            modules[name].append(str(path))
    shared = {name: paths for name, paths in modules.items() if len(paths) > 1}
    assert shared.keys() == SHARED, {name: paths for name, paths in shared.items() if name not in SHARED}
