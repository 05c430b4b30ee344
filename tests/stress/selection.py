"""Keep the tests that a late machine can break, of all that pytest may collect; a plugin of pytest."""

from __future__ import annotations

from pathlib import Path

import pytest

MARKERS = ("e2e", "interop", "tmux")
"""Of tests that start real programs."""
FOLDERS = ("tests/e2e/", "tests/interop/", "tests/groundstation/verbs/")
"""Of tests that start real programs, or use real sockets."""


def is_selected(item: pytest.Item) -> bool:
    """Return whether a test depends on how soon the machine runs a program or a socket."""
    return item.nodeid.startswith(FOLDERS) or any(map(item.get_closest_marker, MARKERS))


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Skip files that have no such test, because each worker would import them all."""
    if not collection_path.match("test_*.py"):
        return None
    if str(collection_path.relative_to(config.rootpath)).startswith(FOLDERS):
        return None
    text = collection_path.read_text()
    return None if any(f"mark.{marker}" in text for marker in MARKERS) else True


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
    """Print failures in the process that has the terminal, which is no worker of pytest-xdist."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(FailurePrinter(config))
