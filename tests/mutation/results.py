"""Results of a run in a file: a run that goes on, or one after a change of tests, repeats only what it has to."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from functools import cache
from pathlib import Path
from typing import NamedTuple

from tests.mutation.mutants import Mutant
from tests.mutation.survivors import Key, key


class Outcome(Enum):
    """Result of the tests against a mutant."""

    KILLED = 0
    SURVIVED = 1
    NOT_COVERED = 2


class Result(NamedTuple):
    """Outcome of a mutant, and the test that failed ("" for a time limit)."""

    outcome: Outcome
    test: str


class Results:
    """Results of mutants, appended to a file as they come, one line of JSON each."""

    def __init__(self, file: Path | None, tests: Sequence[str]) -> None:
        """Use `file`, which may not exist yet; None keeps nothing. `tests` are files or folders."""
        self._file = file
        self._tests = digest(path for name in tests for path in sorted(_python_files(Path(name))))
        self._known = dict(_read(file)) if file is not None and file.exists() else {}

    def find(self, mutant: Mutant) -> Result | None:
        """Return the result of `mutant`, unless its module has changed, or a test has since it survived."""
        module, tests, result = self._known.get(key(mutant), ("", "", None))
        if result is None or module != _digest_of_module(mutant.path):
            return None
        return result if result.outcome is Outcome.KILLED or tests == self._tests else None

    def add(self, mutant: Mutant, result: Result) -> None:
        """Append the result of `mutant`."""
        if self._file is None:
            return
        line = [*key(mutant), _digest_of_module(mutant.path), self._tests, result.outcome.name, result.test]
        with self._file.open("a") as out:
            out.write(json.dumps(line) + "\n")


def _read(file: Path) -> Iterator[tuple[Key, tuple[str, str, Result]]]:
    for line in file.read_text().splitlines():
        path, function, text, module, tests, outcome, test = json.loads(line)
        yield Key(path, function, text), (module, tests, Result(Outcome[outcome], test))


def _python_files(path: Path) -> Iterable[Path]:
    return path.rglob("*.py") if path.is_dir() else [path]


@cache
def _digest_of_module(path: str) -> str:
    return digest([Path(path)])


def digest(files: Iterable[Path]) -> str:
    """Return a hash of the contents of `files`."""
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]
