"""The screen's tests run in one time zone, with all colours, and keep nothing in the home folder."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from textual.screen import Screen

from groundstation.config.settings import ThemeName
from groundstation.ui.look.colours import use_theme
from tests.groundstation.ui import matched_css, parsed_css, settling
from tests.groundstation.ui.programs import Program


@pytest.fixture(autouse=True)
def _utc(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "UTC")
        patch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
        patch.delenv("NO_COLOR", raising=False)
        patch.setenv("COLORTERM", "truecolor")
        time.tzset()
        use_theme(ThemeName.DARK)  # one for the whole process: another test may have chosen another one
        yield
    time.tzset()


@pytest.fixture(autouse=True, scope="session")
def _less_of_textual() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        parsed_css.share(patch)
        matched_css.share(patch)
        settling.share(patch)
        yield


@pytest.fixture
def stock_pilot(monkeypatch: pytest.MonkeyPatch) -> None:
    """Textual's own pauses and painting: beside a station of its own, in real time."""
    settling.restore(monkeypatch)


@pytest.fixture
def painted_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Paint whenever Textual does, also for an app without a terminal."""
    monkeypatch.setattr(Screen, "_compositor_refresh", settling.paint)


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Program]:
    """The screen as a process of its own."""
    with Program.running(tmp_path / "report") as made:
        yield made
