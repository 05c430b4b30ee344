"""Frames as text files that can be read in a diff. GOLDEN=write pytest ... writes them anew; then read the diff."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from difflib import unified_diff
from pathlib import Path

GOLDEN = Path(__file__).parent / "golden"


def read(name: str) -> str:
    """Return a golden frame."""
    return (GOLDEN / f"{name}.txt").read_text("utf-8")


def check(shown: Mapping[str, str]) -> None:
    """Compare frames with the golden ones of their names, and show all that differ; or write them."""
    if os.environ.get("GOLDEN") == "write":
        GOLDEN.mkdir(exist_ok=True)
        for name, text in shown.items():
            (GOLDEN / f"{name}.txt").write_text(text, "utf-8")
    changed = [
        "\n".join(unified_diff(read(name).splitlines(), text.splitlines(), name, "shown", lineterm=""))
        for name, text in shown.items()
        if text != read(name)
    ]
    assert changed == [], "\n".join(changed)


def check_sizes(sizes: Iterable[tuple[str, tuple[int, int]]]) -> None:
    """Check that golden frames fit their terminals, and that those for ASCII are ASCII."""
    wrong = []
    for name, (width, height) in sizes:
        text = read(name)
        lines = text.splitlines()
        fits = len(lines) <= height and max(map(len, lines)) <= width
        wrong += [] if fits and (text.isascii() or not name.startswith("ascii")) else [name]
    assert wrong == [], wrong
