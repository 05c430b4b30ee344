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


class BaselineError(Exception):
    """The child has ended without a result; the message is one line."""


def measure(items: Sequence[pytest.Item], paths: set[str]) -> Baseline:
    """Run the tests in a child, under coverage of the modules at `paths`. Raises BaselineError."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as name:
        folder = Path(name)
        _, status = os.waitpid(fork(lambda at: _measure_to(at, items, paths), folder), 0)
        if not (folder / "baseline").exists():
            raise BaselineError(f"the child that runs the tests {_describe_end(folder, status)}")
        baseline: Baseline = pickle.loads((folder / "baseline").read_bytes())
        return baseline


def _measure_to(folder: Path, items: Sequence[pytest.Item], paths: set[str]) -> None:
    """Write the results to a file in `folder`, or the exception that ended the run."""
    try:
        result = pickle.dumps(_run_under_coverage(items, paths))
    except BaseException as error:
        (folder / "exception").write_text(" ".join(f"{type(error).__name__}: {error}".split()))
        raise
    (folder / "baseline").write_bytes(result)


def _describe_end(folder: Path, status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    if (folder / "exception").exists():
        return f"raised {(folder / 'exception').read_text()}"
    return f"was ended by signal {-code}" if code < 0 else f"exited with code {code}"


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
