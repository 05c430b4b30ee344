"""`.ci/again`: what fails alone, too, fails CI."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

AGAIN = Path(__file__).parents[1] / ".ci" / "again"
TESTS = """\
import pytest

@pytest.mark.parametrize("name", ["a@b"])
def test_good(name):
    pass

def test_bad():
    assert False
"""


@pytest.mark.parametrize(
    ("failed", "code", "said"),
    [
        (["test_it.py::test_good[a@b]@a group"], 0, "1 passed"),
        (["test_it.py::test_good[a@b]", "test_it.py::test_bad"], 1, "1 failed, 1 passed"),
        ([f"test_it.py::test_{n}" for n in range(21)], 1, "21 tests have failed"),
        ([], 1, "0 tests have failed"),
    ],
)
def test_a_few_failed_tests_are_run_again(tmp_path: Path, failed: list[str], code: int, said: str) -> None:
    (tmp_path / "test_it.py").write_text(TESTS)
    for folder, names in ((".pytest_cache", failed[:1]), (".pytest_cache/computing", failed[1:])):
        cache = tmp_path / folder / "v" / "cache"
        cache.mkdir(parents=True)
        (cache / "lastfailed").write_text(json.dumps(dict.fromkeys(names, True)))
    done = subprocess.run([sys.executable, str(AGAIN)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, said in done.stdout) == (code, True), done.stdout
