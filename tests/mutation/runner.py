"""Runs tests against mutants, each in a forked child, with pytest as it stands after collection."""

from __future__ import annotations

import gc
import importlib.abc
import importlib.machinery
import importlib.util
import os
import pickle
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import accumulate
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

import pytest

from tests.mutation.mutants import Mutant

TIME_MAX = 30
"""s of one test, in a mutant that loops or waits for ever; a hundred times of what the slow ones take."""
FRESH = ("vehicle", "tests.")
"""What is imported anew for a change at module level; everything that may import the changed module."""
OPTIONS = (
    "-o", "addopts=--import-mode=importlib", "-qq", "-s", "--no-header", "--no-summary", "--timeout=0",
    "-p", "no:cacheprovider", "-p", "no:xdist",
)  # fmt: skip


class Outcome(Enum):
    """What became of a mutant."""

    KILLED = 0
    SURVIVED = 1
    NOT_COVERED = 2


@dataclass(frozen=True, slots=True)
class Baseline:
    """The tests without a change."""

    seconds: dict[str, float]
    """Test -> how long it takes."""
    tests_by_line: dict[str, dict[int, list[str]]]
    """Path -> line -> tests that execute it."""
    failed: list[str]


@dataclass(slots=True)
class Kills:
    """Counts which tests and files have killed mutants: a test often kills several mutants of the same function."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)

    def add(self, mutant: Mutant, test: str) -> None:
        """Note that `test` killed `mutant`."""
        for where in (mutant.path, f"{mutant.path}::{mutant.function}"):
            self.counts[where, test] += 1
            self.counts[where, test.partition("::")[0]] += 1

    def rank(self, mutant: Mutant, test: str) -> tuple[int, int]:
        """Return a key that sorts the likely killers of `mutant` first."""
        return -self.counts[f"{mutant.path}::{mutant.function}", test], -self.counts[mutant.path, test]


class Watch:
    """A pytest plugin for a child: a time limit for each test, and the name of the first one that fails."""

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report

    def pytest_runtest_logstart(self) -> None:
        """Begin the time of a test; SIGALRM ends the child."""
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(TIME_MAX)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """End the child at the first failure."""
        if report.failed:
            self._report(report.nodeid)
            os._exit(Outcome.KILLED.value)


class Runner:
    """A pytest plugin that takes the place of pytest's loop over the tests."""

    def __init__(
        self, mutants: Sequence[Mutant], jobs: int, limit: float, done: Callable[[Mutant, Outcome, str], None]
    ) -> None:
        """`limit`: s of tests for each mutant; `done` gets each mutant and the test that killed it."""
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
        """Run the tests without a change, and then against each mutant."""
        self._items = {item.nodeid: item for item in session.items}
        self._functions = find_functions()
        gc.collect()
        gc.freeze()  # a collection in a child would copy the memory of the parent
        self.baseline = _measure(session.items, {mutant.path for mutant in self._mutants})
        if self.baseline.failed:
            return True
        for mutant in self._mutants:
            while len(self._running) >= self._jobs:
                self._wait()
            self._start(mutant)
        while self._running:
            self._wait()
        return True

    def _start(self, mutant: Mutant) -> None:
        tests = self._tests(mutant)
        if not tests:
            self._done(mutant, Outcome.NOT_COVERED, "")
            return
        folder = Path(tempfile.mkdtemp(prefix="mutant-"))
        child = os.fork()
        if child == 0:
            _enter_child(folder)
            plugin = Watch(lambda test: _write(folder / "killer", test))
            if mutant.function:
                replace_function(mutant, self._functions)
                run_items([self._items[test] for test in tests], plugin)
            else:
                run_files(mutant, tests, plugin)
            os._exit(Outcome.SURVIVED.value)
        self._running[child] = (mutant, folder)

    def _wait(self) -> None:
        child, status = os.wait()
        mutant, folder = self._running.pop(child)
        killer = folder / "killer"
        test = killer.read_text() if killer.exists() else ""
        shutil.rmtree(folder, ignore_errors=True)
        survived = os.waitstatus_to_exitcode(status) == Outcome.SURVIVED.value
        if test:
            self._kills.add(mutant, test)
        self._done(mutant, Outcome.SURVIVED if survived else Outcome.KILLED, test)

    def _tests(self, mutant: Mutant) -> list[str]:
        """Return the tests, or for a change at module level the files of tests, in the order to run them in."""
        seconds = self.baseline.seconds
        if mutant.function:
            lines = self.baseline.tests_by_line[mutant.path]
            cost = {test: seconds[test] for line in mutant.lines for test in lines.get(line, ()) if test}
        else:
            cost = defaultdict(float)
            for test, spent in seconds.items():
                cost[test.partition("::")[0]] += spent
        own = f"/test_{Path(mutant.path).stem}"
        order = sorted(cost, key=lambda test: (*self._kills.rank(mutant, test), own not in test, cost[test]))
        totals = accumulate(cost[test] for test in order)
        return [test for test, total in zip(order, totals, strict=True) if total <= self._limit]


def _enter_child(folder: Path) -> None:
    """Give the child its own folder for temporary files, and no output."""
    os.setpgid(0, 0)
    for stream in (1, 2):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
    os.environ["PYTEST_DEBUG_TEMPROOT"] = str(folder)


def _write(path: Path, text: str) -> None:
    path.write_text(text)


def run_items(items: Sequence[pytest.Item], plugin: Watch) -> None:
    """Run tests that are collected."""
    items[0].config.pluginmanager.register(plugin)
    for item, following in zip(items, [*items[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)


def run_files(mutant: Mutant, files: Sequence[str], plugin: Watch) -> None:
    """Run files of tests, with the changed module and all that may import it imported anew."""
    for name in [name for name in sys.modules if name.startswith(FRESH) and not name.startswith("tests.mutation")]:
        del sys.modules[name]
    sys.meta_path.insert(0, MutantFinder(mutant))
    for file in files:
        if pytest.main([*OPTIONS, file], plugins=[plugin, Examples()]):
            plugin.pytest_runtest_logreport(pytest.TestReport(file, (file, 0, ""), {}, "failed", None, "setup"))


class MutantFinder(importlib.abc.MetaPathFinder):
    """Finds the changed module in place of the one on disk."""

    def __init__(self, mutant: Mutant) -> None:
        self._mutant = mutant

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return how to load the changed module; None for all others."""
        if fullname != self._mutant.module:
            return None
        file = str(Path(self._mutant.path).resolve())
        return importlib.util.spec_from_file_location(fullname, file, loader=_Loader(self._mutant, file))


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, mutant: Mutant, file: str) -> None:
        super().__init__(mutant.module, file)
        self._code = mutant.compile()

    def get_code(self, fullname: str) -> CodeType:
        return self._code


class Examples:
    """A pytest plugin that makes hypothesis draw the same examples each time, and end at the first that fails."""

    def pytest_collection(self) -> None:
        """Take the place of the profile that tests/conftest.py has loaded."""
        from hypothesis import HealthCheck, Phase, settings

        settings.register_profile(
            "mutation",
            deadline=None,
            derandomize=True,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=[HealthCheck.too_slow],
        )
        settings.load_profile("mutation")


Functions = Mapping[tuple[str, str], list[FunctionType]]
"""File and qualified name -> functions."""


def find_functions() -> Functions:
    """Return all functions that are loaded, wherever they are held: in properties and tables, too."""
    found: defaultdict[tuple[str, str], list[FunctionType]] = defaultdict(list)
    for each in gc.get_objects():
        if isinstance(each, FunctionType):
            found[each.__code__.co_filename, each.__code__.co_qualname].append(each)
    return found


def replace_function(mutant: Mutant, functions: Functions) -> None:
    """Replace the code of the function that `mutant` changes."""
    file = str(Path(mutant.path).resolve())
    changed = {(code.co_qualname, code.co_firstlineno): code for code in _codes(mutant.compile())}
    for found in functions[file, mutant.function]:
        found.__code__ = changed[mutant.function, found.__code__.co_firstlineno]


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def _measure(items: Sequence[pytest.Item], paths: set[str]) -> Baseline:
    """Run the tests without a change in a child, under coverage."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        result = Path(folder) / "baseline"
        child = os.fork()
        if child == 0:
            _enter_child(Path(folder))
            result.write_bytes(pickle.dumps(_run_under_coverage(items, paths)))
            os._exit(0)
        os.waitpid(child, 0)
        baseline: Baseline = pickle.loads(result.read_bytes())
        return baseline


class _Failures:
    def __init__(self) -> None:
        self.names: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.names.append(report.nodeid)


def _run_under_coverage(items: Sequence[pytest.Item], paths: set[str]) -> Baseline:
    import coverage

    files = {path: str(Path(path).resolve()) for path in paths}
    measured = coverage.Coverage(data_file=None, include=list(files.values()), config_file=False)
    failures, seconds = _Failures(), {}
    items[0].config.pluginmanager.register(failures)
    measured.start()
    for item, following in zip(items, [*items[1:], None], strict=True):
        measured.switch_context(item.nodeid)
        began = time.process_time()
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        seconds[item.nodeid] = time.process_time() - began
    measured.stop()
    data = measured.get_data()
    tests = {path: data.contexts_by_lineno(file) for path, file in files.items()}
    return Baseline(seconds, tests, failures.names)
