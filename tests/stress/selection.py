"""Keep the tests that a late machine can break, of all that pytest may collect; a plugin of pytest."""

from __future__ import annotations

import functools
import re
from pathlib import Path

import pytest

from tests.order import WAITING_FOLDERS, WAITING_MARKERS, gives_way

REAL_TIME = re.compile(
    r"\b(tests\.waits|tests\.groundstation\.screen|subprocess|threading|time\.monotonic)\b|^ *async def test_",
    re.MULTILINE,
)
"""In the text of a file whose tests start programs or threads, look at a clock, or draw a screen."""
FOLDERS = ("tests/e2e", "tests/interop", *(f"tests/{folder}" for folder in WAITING_FOLDERS))
"""Of tests that start real programs or use real lines by helpers beside them."""


def is_selected(item: pytest.Item) -> bool:
    """Return whether a test depends on how soon the machine runs a program, a thread or a socket."""
    return item.nodeid.startswith(FOLDERS) or not gives_way(item) or _is_in_real_time(item.path)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Skip files that have no such test, because each worker would import them all."""
    if not collection_path.match("test_*.py"):
        return None
    name = collection_path.relative_to(config.rootpath).as_posix()
    markers = any(f"mark.{marker}" in collection_path.read_text() for marker in WAITING_MARKERS)
    return None if markers or name.startswith(FOLDERS) or _is_in_real_time(collection_path) else True


@functools.cache
def _is_in_real_time(path: Path) -> bool:
    """Return whether the text of a file says so."""
    return REAL_TIME.search(path.read_text()) is not None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the other tests of the files that are left."""
    config.hook.pytest_deselected(items=[item for item in items if not is_selected(item)])
    items[:] = [item for item in items if is_selected(item)]


class FailurePrinter:
    """Prints each failure when it happens: a round under load takes long."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Print a failed test with its output."""
        terminal = self._config.pluginmanager.get_plugin("terminalreporter")
        if report.failed and terminal is not None:
            terminal.write_line(
                f"\n==== {report.nodeid} ({report.when}, {report.duration:.1f} s)\n{report.longreprtext}"
            )
            for title, content in report.sections:
                terminal.write_line(f"---- {title}\n{content}")
            terminal.flush()


def pytest_configure(config: pytest.Config) -> None:
    """Print failures in the process that has the terminal, which is not a worker of pytest-xdist."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(FailurePrinter(config))
