"""The screen's tests run in one time zone, because the log shows local times, and with all colours."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.groundstation.ui.programs import Program


@pytest.fixture(autouse=True)
def _utc(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "UTC")
        patch.delenv("NO_COLOR", raising=False)
        patch.setenv("COLORTERM", "truecolor")
        time.tzset()
        yield
    time.tzset()


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Program]:
    """The screen as a process of its own."""
    with Program.running(tmp_path / "report") as made:
        yield made
