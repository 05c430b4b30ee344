"""A test with a table runs each row, and names those that fail."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

from tests.rows import each_row


def test_every_row_is_run_and_all_that_fail_are_named(tmp_path: Path) -> None:
    seen = []

    @each_row(("number", "limit"), [(1, 3), (5, 3), (2, 3), (7, 3)])
    def check(tmp_path: Path, number: int, limit: int) -> None:
        seen.append(number)
        assert number < limit, "too high"

    assert list(inspect.signature(check).parameters) == ["tmp_path"]
    with pytest.raises(AssertionError) as failed:
        check(tmp_path=tmp_path)
    assert seen == [1, 5, 2, 7]
    assert "2 of 4 rows" in str(failed.value)
    assert "\n5, 3: " in str(failed.value)
    assert "too high" in str(failed.value)
    assert "\n7, 3: " in str(failed.value)


def test_tables_multiply_and_an_empty_one_fails() -> None:
    seen = []

    @each_row("one", "ab", ids=str.upper)
    @each_row("other", [1, 2])
    def check(one: str, other: int) -> None:
        seen.append((one, other))

    check()
    assert seen == [("a", 1), ("a", 2), ("b", 1), ("b", 2)]

    @each_row("one", [])
    def never(one: str) -> None:
        raise AssertionError(one)

    with pytest.raises(AssertionError, match="no rows"):
        never()


@each_row("row", [1, 2])
def test_pytest_gives_it_its_fixtures(tmp_path: Path, row: int) -> None:
    assert not (tmp_path / str(row)).exists()
    (tmp_path / str(row)).touch()
    assert len(list(tmp_path.iterdir())) == row
