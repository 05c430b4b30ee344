"""Run tests in a forked child: collected tests, or files with the project imported anew."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

import pytest

TIME_MAX = 5.0
"""s of CPU for a test, for mutants that loop forever. A busy machine does not kill a mutant."""
WAIT_MAX = 60
"""s for a test, for mutants that wait forever."""
OPTIONS = (
    "-o", "addopts=--import-mode=importlib", "-qq", "-s", "--no-header", "--no-summary", "--timeout=0",
    "-p", "no:cacheprovider", "-p", "no:xdist", "--assert=plain",
)  # fmt: skip
KILLED, SURVIVED, BROKEN = 10, 11, 12
"""Exit codes. A child that ends by a signal has exceeded the time limit, or the mutant has crashed Python."""


class Watch:
    """A pytest plugin that limits the time of each test and ends the process at the first failure."""

    def __init__(self, folder: Path) -> None:
        """Write the name of the test that fails to a file in `folder`."""
        self._folder = folder

    def pytest_runtest_logstart(self) -> None:
        """Start the time limits of a test; SIGPROF or SIGALRM ends the process."""
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, TIME_MAX)
        signal.alarm(WAIT_MAX)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> None:
        """End the process at a failed assertion: its report would cost more than the test."""
        if call.excinfo is not None and call.excinfo.errisinstance(AssertionError):
            self.end(item.nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """End the process at the first failure."""
        if report.failed:
            self.end(report.nodeid)

    def end(self, test: str) -> NoReturn:
        """End the process: `test` has killed the mutant."""
        (self._folder / "killer").write_text(test)
        os._exit(KILLED)


class Examples:
    """A pytest plugin that makes hypothesis draw the same examples in each run and not shrink failures."""

    def pytest_collection(self) -> None:
        """Replace the hypothesis profile of tests/conftest.py."""
        from hypothesis import HealthCheck, Phase, settings  # pytest has to import it first, to rewrite its asserts

        settings.register_profile(
            "mutation",
            deadline=None,
            derandomize=True,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=[HealthCheck.too_slow],
        )
        settings.load_profile("mutation")


def fork(run: Callable[[Path], None], folder: Path) -> int:
    """Fork a child that calls `run` without output, with `folder` for its files; return its process id."""
    child = os.fork()
    if child == 0:
        try:
            os.setpgid(0, 0)
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            os.environ["PYTEST_DEBUG_TEMPROOT"] = str(folder)
            run(folder)
            os._exit(SURVIVED)
        finally:
            os._exit(BROKEN)
    return child


def run_items(items: Sequence[pytest.Item], plugin: object) -> None:
    """Run collected tests."""
    items[0].config.pluginmanager.register(plugin)
    for item, following in zip(items, [*items[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)


def run_files(files: Sequence[str], watch: Watch) -> None:
    """Collect and run test files one after the other. A file that cannot be imported counts as a failed test.

    So does one whose import ends the program: the unchanged module has been imported in the same way before.
    """
    for file in files:
        code = pytest.main([*OPTIONS, file], plugins=[watch, Examples()])
        if code in (pytest.ExitCode.INTERRUPTED, pytest.ExitCode.INTERNAL_ERROR):
            watch.end(file)
        if code is not pytest.ExitCode.OK:
            raise RuntimeError(f"{file}: pytest ended with {code}")
