"""The explanations of survivors belong to the source as it is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mutation.mutants import build_mutants
from tests.mutation.survivors import Key, find_gone, key, load_explanations
from tests.mutation.test_mutants import mutants_of


def test_every_explanation_names_a_mutant_of_the_source() -> None:
    assert [str(each) for each in find_gone(load_explanations())] == []


def test_explanations_of_changed_and_deleted_code_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = "A = 1\ndef f():\n    return 2 + 2\n"
    known = [key(each) for each in mutants_of(source, tmp_path, monkeypatch)]
    gone = [known[0]._replace(text="A = 5 -> A = 6"), known[-1]._replace(function="g"), Key("deleted.py", "", "1 -> 2")]
    assert find_gone([*known, *gone]) == gone


def test_the_mutants_of_a_function_have_the_same_names_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mutants = mutants_of("A = 1\ndef f():\n    return 2 + 2\ndef g():\n    return 2 + 2\n", tmp_path, monkeypatch)
    for function in ("", "f", "g"):
        alone = [key(each) for each in build_mutants("sample.py", [function])]
        assert alone == [key(each) for each in mutants if each.function == function]
