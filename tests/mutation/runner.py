"""Run the tests against each mutant, in a forked child of the pytest process that collected them."""

from __future__ import annotations

import gc
import os
import shutil
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.mutation.baseline import Baseline, BaselineError, measure
from tests.mutation.child import BROKEN, KILLED, SURVIVED, Watch, fork, run_files, run_items
from tests.mutation.loading import Functions, find_functions, replace_function, replace_module
from tests.mutation.mutants import Mutant, unchanged
from tests.mutation.results import Outcome, Result

BOUNDS = "tests/test_bounds.py"
"""Test file with constants as numbers: it imports much, so that it would seldom have room."""


@dataclass(slots=True)
class Kills:
    """Counts of the mutants that tests and test files killed: one test often kills several mutants of a function."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)

    def add(self, mutant: Mutant, test: str) -> None:
        """Count that `test` killed `mutant`."""
        for where in (mutant.path, f"{mutant.path}::{mutant.function}"):
            self.counts[where, test] += 1
            self.counts[where, test.partition("::")[0]] += 1

    def rank(self, mutant: Mutant, test: str) -> tuple[int, int]:
        """Return a key that sorts the likely killers of `mutant` first."""
        return -self.counts[f"{mutant.path}::{mutant.function}", test], -self.counts[mutant.path, test]


class Runner:
    """A pytest plugin that replaces the test loop."""

    def __init__(
        self, mutants: Sequence[Mutant], jobs: int, limit: float, done: Callable[[Mutant, Result], None]
    ) -> None:
        """Run up to `limit` s of tests against each mutant; `done` is called with its result."""
        self.baseline = Baseline({}, {}, [])
        self._mutants = mutants
        self._jobs = jobs
        self._limit = limit
        self._done = done
        self._kills = Kills()
        self._items: dict[str, pytest.Item] = {}
        self._functions: Functions = {}
        self._running: dict[int, tuple[Mutant, Path]] = {}

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Run the tests on unchanged code, and then against each mutant."""
        self._items = {item.nodeid: item for item in session.items}
        self._functions = find_functions()
        gc.collect()
        gc.freeze()  # a collection in a child would copy the memory of the parent
        try:
            self.baseline = measure(session.items, {mutant.path for mutant in self._mutants})
        except BaselineError as error:
            self.baseline.failed.append(str(error))
            return True
        self.baseline.failed.extend(self._check())
        for mutant in () if self.baseline.failed else self._mutants:
            while len(self._running) >= self._jobs:
                self._finish()
            self._start(mutant)
        while self._running:
            self._finish()
        return True

    def _check(self) -> list[str]:
        """Return the test that fails if an unchanged module is imported anew, if any."""
        mutant = unchanged(self._mutants[0].path)
        folder = Path(tempfile.mkdtemp(prefix="mutant-"))
        _, status = os.waitpid(fork(lambda at: self._run(mutant, self._tests(mutant), at), folder), 0)
        test = _killer(folder, status)
        return [] if test is None else [f"{test}, where vehicle and tests are imported anew"]

    def _start(self, mutant: Mutant) -> None:
        tests = self._tests(mutant)
        if not tests:
            self._done(mutant, Result(Outcome.NOT_COVERED, ""))
            return
        folder = Path(tempfile.mkdtemp(prefix="mutant-"))
        self._running[fork(lambda at: self._run(mutant, tests, at), folder)] = (mutant, folder)

    def _run(self, mutant: Mutant, tests: Sequence[str], folder: Path) -> None:
        if mutant.function and replace_function(mutant, self._functions):
            run_items([self._items[test] for test in tests], Watch(folder))
        else:
            replace_module(mutant)
            run_files(list(dict.fromkeys(test.partition("::")[0] for test in tests)), Watch(folder))

    def _finish(self) -> None:
        child, status = os.wait()
        mutant, folder = self._running.pop(child)
        test = _killer(folder, status)
        if test:
            self._kills.add(mutant, test)
        self._done(mutant, Result(Outcome.SURVIVED if test is None else Outcome.KILLED, test or ""))

    def _tests(self, mutant: Mutant) -> list[str]:
        """Return the tests to run, likely and fast ones first; test files for a change at module level."""
        seconds = self.baseline.seconds
        own = f"/test_{Path(mutant.path).stem}."
        if mutant.function:
            lines = self.baseline.tests_by_line[mutant.path]
            tests = {test for line in mutant.lines for test in lines.get(line, ()) if test}
            # What only a process executes that a test forks is not recorded
            cost = {test: seconds[test] for test in tests or [test for test in seconds if own in test]}
        else:
            cost = defaultdict(float)
            for test, spent in seconds.items():
                cost[test.partition("::")[0]] += spent
        module = not mutant.function

        def rank(test: str) -> tuple[float, ...]:
            return *self._kills.rank(mutant, test), module and own not in test, cost[test]

        chosen, total = [], 0.0
        for test in sorted(cost, key=rank):
            # A test that takes too long leaves room for others; these two files always run for constants
            always = module and (own in test or test == BOUNDS)
            if always or total + cost[test] <= self._limit:
                chosen.append(test)
                total += 0.0 if always else cost[test]
        return chosen


def _killer(folder: Path, status: int) -> str | None:
    """Return the test that failed in a child, None if it passed all; removes `folder`.

    "" stands for the time limit, and for a child that the mutant has ended, as by os._exit(). Raises RuntimeError if
    the child could not run the tests.
    """
    code = os.waitstatus_to_exitcode(status)
    test = (folder / "killer").read_text() if code == KILLED else ""
    shutil.rmtree(folder, ignore_errors=True)
    if code == BROKEN:
        raise RuntimeError("a child could not run the tests")
    return None if code == SURVIVED else test
