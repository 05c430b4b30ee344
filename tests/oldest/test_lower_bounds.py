"""Every package has an oldest version, and tests that import it."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from tests.oldest.bounds import TESTS, lower_bounds

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_every_dependency_has_tests_and_a_lower_bound() -> None:
    assert lower_bounds(PROJECT).keys() == TESTS.keys()


def test_every_row_names_tests_that_exist() -> None:
    assert [path for paths in TESTS.values() for path in paths if not (ROOT / path).exists()] == []


def test_an_extra_made_of_others_has_theirs() -> None:
    project = {
        "name": "me",
        "dependencies": ["A_b>=1,<2", "c==3"],
        "optional-dependencies": {"all": ["me[x]"], "pi": ["e~=4.1"], "x": ["d>=0.5; python_version > '3'", "me[pi]"]},
    }
    assert lower_bounds(project) == {"a-b": "1", "c": "3", "d": "0.5", "e": "4.1"}


@pytest.mark.parametrize("line", ["a", "a<2", "a>=1,==1.5"])
def test_a_package_without_one_lower_bound_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match="lower bounds"):
        lower_bounds({"name": "me", "dependencies": [line], "optional-dependencies": {"all": [], "pi": []}})
