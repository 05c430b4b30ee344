"""Each lesson of `mavhelm learn` is passed by a pupil who knows its text only, with the real programs in a terminal."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from groundstation.learn.progress import Progress
from tests.e2e.pupil import Pupil
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.waits import PATIENCE, wait_until

__all__ = ["tmux"]

pytestmark = IN_TMUX

LESSONS = [*((number, 80, 24) for number in range(1, 9)), (1, 140, 45), (7, 140, 45)]


@pytest.fixture(autouse=True)
def _own_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Progress and recordings of the machine's user stay as they are."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.mark.parametrize(("number", "columns", "lines"), LESSONS)
def test_a_lesson_is_passed_by_its_text_alone(
    tmux: Callable[..., Tmux], tmp_path: Path, number: int, columns: int, lines: int
) -> None:
    terminal = tmux(columns, lines, "learn", str(number))
    pupil = Pupil(terminal, columns)
    last = pupil.learn()
    assert pupil.step(last) == 0
    wait_until(lambda: Progress(tmp_path / "state" / "mavhelm" / "learn.json").done == (str(number),), "it is saved")
    terminal.press("C-q")
    if number == 7:  # the replay has ended; the session has noted that the lesson is done there
        terminal.until(lambda screen: "REPLAY" not in screen and pupil.step(screen) == 0, PATIENCE)
        terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
    assert "EXIT CODE 0" in ended
    assert "Traceback" not in ended
