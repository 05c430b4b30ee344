"""A loaded function takes the code of a mutant, where it can."""

from __future__ import annotations

import sys
from pathlib import Path
from types import FunctionType

import pytest

from tests.mutation.loading import replace_function
from tests.mutation.mutants import Mutant
from tests.mutation.test_mutants import mutants_of

SOURCE = """\
class A(list):
    def __init__(self, size):
        super().__init__(range(size))
        self.size = size
"""


def load(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[dict[str, Mutant], type]:
    """Return the mutants of SOURCE by their texts, and its class."""
    mutants = {each.text: each for each in mutants_of(SOURCE, folder, monkeypatch)}
    namespace: dict[str, type] = {}
    exec(compile(SOURCE, str(folder / "sample.py"), "exec"), namespace)  # the code of this test
    sys.modules.pop("sample", None)
    return mutants, namespace["A"]


def init_of(loaded: type) -> FunctionType:
    """Return the function `__init__` of a class."""
    function = loaded.__dict__["__init__"]
    assert isinstance(function, FunctionType)
    return function


def test_a_function_takes_the_code_of_a_mutant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mutants, loaded = load(tmp_path, monkeypatch)
    mutant = mutants["self.size = size -> pass"]
    assert replace_function(mutant, {(mutant.file, "A.__init__"): [init_of(loaded)]})
    made = loaded(3)
    assert made == [0, 1, 2]
    assert not hasattr(made, "size")


def test_a_function_keeps_its_code_if_its_variables_differ(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mutants, loaded = load(tmp_path, monkeypatch)
    function = init_of(loaded)
    mutant = mutants["super().__init__(range(size)) -> pass"]
    before = function.__code__
    assert not replace_function(mutant, {(mutant.file, "A.__init__"): [function]})
    assert function.__code__ is before
    with pytest.raises(LookupError):
        replace_function(mutant, {})
