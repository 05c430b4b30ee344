"""The mutants of a line of source, their names, and the check of explanations."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.mutation.mutants import Mutant, build_mutants
from tests.mutation.survivors import Key, key, load_explanations, unexplained_and_stale


def mutants_of(source: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[Mutant]:
    """Return the mutants of `source`, as a module."""
    (folder / "sample.py").write_text(source)
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "sample", raising=False)
    return build_mutants("sample.py")


@pytest.mark.parametrize(
    ("line", "changes"),
    [
        ("a <= b", {"a < b", "not a <= b"}),
        ("a is b", {"a is not b"}),
        ("a and b", {"a or b", "a", "b"}),
        ("not a", {"a"}),
        ("a + b", {"a - b"}),
        ("a ^ b", {"a | b"}),
        ("a - 1", {"a + 1", "a - 2", "a - 0"}),
        ("a if b else 2.0", {"a if not b else 2.0", "a if b else 3.0", "a if b else 1.0"}),
        ("True", {"False"}),
        ("max(a, b)", {"min(a, b)", "a", "b"}),
        ("[x for x in a if x]", {"[x for x in a]"}),
        ("f(a, b=c)", {"f(a)"}),
    ],
)
def test_each_expression_is_changed_in_all_ways(
    line: str, changes: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = mutants_of(f"def g(a, b, c, f):\n    d = {line}\n", tmp_path, monkeypatch)
    assert {each.text for each in found} == {f"d = {line} -> d = {change}" for change in changes}
    assert {each.function for each in found} == {"g"}


def test_statements_with_an_effect_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = 'def g(a):\n    """Text."""\n    a.b = a\n    a.c()\n    d = a\n    return d\n'
    texts = [each.text for each in mutants_of(source, tmp_path, monkeypatch)]
    assert texts == ["a.b = a -> pass", "a.c() -> pass", "return d -> return None"]


def test_members_of_an_enum_become_the_next_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = "from enum import Enum\nE = Enum('E', ['A', 'B'])\nONE, TWO = E\nT = {E.A: E.B}\nU = (ONE,)\n"
    texts = {each.text for each in mutants_of(source, tmp_path, monkeypatch)}
    assert {"T = {E.A: E.B} -> T = {E.B: E.B}", "T = {E.A: E.B} -> T = {E.A: E.A}", "U = (ONE,) -> U = (TWO,)"} <= texts


def test_the_same_text_twice_in_a_function_gets_a_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = mutants_of("def g(a):\n    a.c()\n    a.c()\n", tmp_path, monkeypatch)
    assert [each.text for each in found] == ["a.c() -> pass", "a.c() -> pass (2)"]
    assert [each.line for each in found] == [2, 3]


def test_a_mutant_is_compiled_and_leaves_the_others_as_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = mutants_of("A = 1\n", tmp_path, monkeypatch)
    values = []
    for each in found:
        namespace: dict[str, int] = {}
        exec(each.compile(), namespace)  # the code of this test
        values.append(namespace["A"])
    assert values == [2, 0]


def test_survivors_need_explanation_and_explanations_a_survivor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = mutants_of("A = 1\n", tmp_path, monkeypatch)
    (tmp_path / "survivors.toml").write_text(
        f'[[survivors]]\nmodule = "sample.py"\nfunction = ""\nmutants = ["{second.text}"]\nwhy = "it is a sample"\n'
    )
    explanations = load_explanations(tmp_path / "survivors.toml")
    assert explanations == {key(second): "it is a sample"}
    assert unexplained_and_stale([first, second], [first], explanations) == ([first], [key(second)])
    assert unexplained_and_stale([first, second], [second], explanations) == ([], [])
    assert unexplained_and_stale([], [], explanations) == ([], [])
    assert str(key(first)) == "sample.py: module: A = 1 -> A = 2"
    assert isinstance(key(first), Key)
