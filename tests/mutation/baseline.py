"""Baseline run of the tests on unchanged code: executed lines, durations and failures."""

from __future__ import annotations

import os
import pickle
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.mutation.child import fork


@dataclass(frozen=True, slots=True)
class Baseline:
    """Results of the tests on unchanged code."""

    seconds: dict[str, float]
    """Test -> CPU time."""
    tests_by_line: dict[str, dict[int, list[str]]]
    """Path -> line -> tests that execute it."""
    failed: list[str]


def measure(items: Sequence[pytest.Item], paths: set[str]) -> Baseline:
    """Run the tests in a child, under coverage of the modules at `paths`."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        os.waitpid(fork(lambda at: _save(at, _run_under_coverage(items, paths)), Path(folder)), 0)
        baseline: Baseline = pickle.loads((Path(folder) / "baseline").read_bytes())
        return baseline


def _save(folder: Path, baseline: Baseline) -> None:
    (folder / "baseline").write_bytes(pickle.dumps(baseline))


def _run_under_coverage(items: Sequence[pytest.Item], paths: set[str]) -> Baseline:
    import coverage  # only here: it is in the extra `mutation`

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
    return Baseline(seconds, {path: data.contexts_by_lineno(file) for path, file in files.items()}, failures.names)


class _Failures:
    def __init__(self) -> None:
        self.names: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.names.append(report.nodeid)
