"""No class name stands for two things: a reader who searches for one finds one."""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("groundstation", "link", "vehicle")
"""Not dialects: its modules are generated, and pymavlink names their classes."""
CLASS = re.compile(r"^class ([A-Za-z]\w*)", re.MULTILINE)
SHARED = {"Fence", "Position", "Rover"}
"""The client's view of what the vehicle has, by the same name on purpose: `groundstation.rover` is a public API."""


def find_shared_names() -> dict[str, list[str]]:
    """Return the public class names that stand in more than one module, with these modules."""
    modules = defaultdict(list)
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            for name in set(CLASS.findall(path.read_text("utf-8"))):
                modules[name].append(str(path.relative_to(ROOT)))
    return {name: paths for name, paths in modules.items() if len(paths) > 1}


def test_no_class_name_stands_for_two_things() -> None:
    found = find_shared_names()
    assert found.keys() == SHARED, {name: paths for name, paths in found.items() if name not in SHARED}
