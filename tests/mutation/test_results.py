"""Results of an earlier run hold as long as the module is the same, and for survivors the tests, too."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mutation import results
from tests.mutation.results import Outcome, Result, Results
from tests.mutation.test_mutants import mutants_of


@pytest.fixture(autouse=True)
def _new_digests() -> None:
    results._digest_of_module.cache_clear()


def test_a_result_holds_until_its_module_or_a_test_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    killed, survived = mutants_of("A = 1\n", tmp_path, monkeypatch)
    file, test = tmp_path / "results", tmp_path / "test_sample.py"
    test.write_text("one = 1\n")
    for mutant, result in ((killed, Result(Outcome.KILLED, "test_a")), (survived, Result(Outcome.SURVIVED, ""))):
        assert Results(file, [str(test)]).find(mutant) is None
        Results(file, [str(test)]).add(mutant, result)
        assert Results(file, [str(tmp_path)]).find(mutant) == (result if mutant is killed else None), "another test"
        assert Results(file, [str(test)]).find(mutant) == result
    test.write_text("two = 2\n")
    assert Results(file, [str(test)]).find(killed) == Result(Outcome.KILLED, "test_a")
    assert Results(file, [str(test)]).find(survived) is None
    (tmp_path / "sample.py").write_text("A = 1  # changed\n")
    results._digest_of_module.cache_clear()
    assert Results(file, [str(test)]).find(killed) is None


def test_the_last_result_counts_and_without_a_file_none_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mutant, _ = mutants_of("A = 1\n", tmp_path, monkeypatch)
    nothing = Results(None, [])
    nothing.add(mutant, Result(Outcome.KILLED, ""))
    assert nothing.find(mutant) is None
    for outcome in (Outcome.SURVIVED, Outcome.NOT_COVERED, Outcome.KILLED):
        Results(tmp_path / "results", []).add(mutant, Result(outcome, ""))
    assert Results(tmp_path / "results", []).find(mutant) == Result(Outcome.KILLED, "")
