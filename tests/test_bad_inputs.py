"""The table of bad inputs in docs/reliability.md is complete, and each of its tests exists."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from tests.rows import each_row
from tests.test_docs import functions

ROOT = Path(__file__).parents[1]
TABLE = ROOT / "docs/reliability.md"


def rows() -> Iterator[tuple[int, str]]:
    """Return number and last cell of each row; a row without a number continues the one before."""
    number = ""
    for line in TABLE.read_text().splitlines():
        found = re.match(r"\| (\d*) ?\|.*\| ([^|]*) \|$", line)
        number = (found[1] or number) if found else ""
        if found and number:
            yield int(number), found[2]


def collected(path: Path) -> set[str]:
    """Return the tests that pytest collects from a file, as it takes them after the path."""
    names = {each for each in functions(path) if each.rpartition("::")[2].startswith("test_")}
    return names if path.name.startswith("test_") else set()


def test_every_bad_input_has_a_row() -> None:
    assert {number for number, _ in rows()} == set(range(1, 84))


@each_row(("number", "cell"), list(rows()))
def test_it_has_a_test(number: int, cell: str) -> None:
    named = re.findall(r"`(tests/[^`]+)`", cell)
    assert named, f"{number} has no test"
    for each in named:
        path, _, test = each.partition("::")
        tests = collected(ROOT / path)
        assert (test in tests) if test else tests, f"{number}: {each} is not collected"
