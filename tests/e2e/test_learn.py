"""Each lesson of `mavhelm learn` is passed by a pupil who knows its text only, with the real programs in a terminal."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from groundstation.learn.progress import Progress
from groundstation.web.launch import missing_package
from tests.e2e.browser_terminal import tab_of
from tests.e2e.chromium import PROGRAM
from tests.e2e.other_terminals import OtherTerminals
from tests.e2e.programs import LET_GO
from tests.e2e.pupil import Mistake, Pupil, Size
from tests.e2e.ros1.marks import NEEDS_ROS
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

__all__ = ["tmux"]

pytestmark = IN_TMUX

SMALL, LARGE = (80, 24), (140, 45)
EVERY_SIZE = "MAVHELM_EVERY_LESSON" in os.environ
"""Each lesson wholly in each size and in a browser; else the size changes with each task, and two are in a browser."""
SIZES = {"in turn": (SMALL, LARGE)} if not EVERY_SIZE else {"80x24": (SMALL,), "140x45": (LARGE,)}
NUMBERS = range(1, 11)
LESSONS = [pytest.param(each, marks=[NEEDS_ROS] if each == 9 else []) for each in NUMBERS]
IN_A_TAB = [each for each in LESSONS if EVERY_SIZE or each.values[0] in (2, 10)]
"""What is driven, found and typed in a browser, and the keys that are given up."""


MISTAKES = {
    6: Mistake(1, "i", "You held a drive key, but the rover is disarmed."),
    7: Mistake(3, "r", "A rover is armed. Press"),
    8: Mistake(5, "r", "The rover is disarmed. Press", held=False),
}
"""Lesson -> what its pupil does wrong on the way."""


@pytest.fixture(autouse=True)
def _own_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Progress and recordings of the machine's user stay as they are."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "run").mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "run"))  # programs find no station of another test


@pytest.fixture
def others(tmp_path: Path) -> Iterator[OtherTerminals]:
    """Return the other terminals of a pupil."""
    opened = OtherTerminals(tmp_path)
    yield opened
    opened.end()


@pytest.mark.parametrize("sizes", SIZES.values(), ids=SIZES)
@pytest.mark.parametrize("number", LESSONS)
def test_a_lesson_is_passed_by_its_text_alone(
    tmux: Callable[..., Tmux], tmp_path: Path, others: OtherTerminals, number: int, sizes: Sequence[Size]
) -> None:
    if number % 2 == 0:
        sizes = sizes[::-1]
    terminal = tmux(*SMALL, "learn", str(number))
    pupil = Pupil(terminal, SMALL[0], others if number > 8 else None, sizes)
    pupil.mistakes = [MISTAKES[number]] if number in MISTAKES else []
    last = pupil.learn()
    assert (pupil.step(last), pupil.mistakes) == (0, []), "a mistake has got its hint, and cost nothing"
    wait_until(lambda: Progress(tmp_path / "state" / "mavhelm" / "learn.json").done == (str(number),), "it is saved")
    terminal.press("C-q")
    if number == 7:  # the replay has ended; the session has noted that the lesson is done there
        terminal.until(lambda screen: "REPLAY" not in screen and pupil.step(screen) == 0, PATIENCE)
        terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
    assert "EXIT CODE 0" in ended
    assert "Traceback" not in ended


@pytest.mark.xdist_group("browser")
@pytest.mark.skipif(missing_package() is not None, reason="the extra [web] is not installed")
@pytest.mark.skipif(PROGRAM is None and "MAVHELM_CI" not in os.environ, reason="chromium is not installed")
@pytest.mark.parametrize("number", IN_A_TAB)
def test_a_lesson_is_passed_in_a_tab_of_a_browser(tmp_path: Path, others: OtherTerminals, number: int) -> None:
    command = [sys.executable, "-m", "groundstation", "learn", str(number), "--web", f"--port={free_port()}"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        try:
            url = re.search(r"http://\S+", server.stderr.readline() + server.stderr.readline())
            assert url is not None
            with tab_of(tmp_path, url[0]) as tab:
                pupil = Pupil(tab, SMALL[0], others if number > 8 else None)
                assert pupil.step(pupil.learn()) == 0
        finally:
            server.terminate()
        assert server.wait(PATIENCE) == 0


WRONG_DEEDS = (("i", "the rover is disarmed"), (",", "That was backward"), ("j", "That was a turn"))
"""A key that the first lesson does not ask for at this time, and what is said."""


def test_wrong_deeds_get_the_hint_that_names_them(tmux: Callable[..., Tmux]) -> None:
    terminal = tmux(*LARGE, "learn", "1")
    pupil = Pupil(terminal, LARGE[0])
    terminal.until(lambda screen: pupil.step(screen) == 1 and "DISARMED" in screen, PATIENCE)
    for key, hint in WRONG_DEEDS:
        terminal.hold_until(key, lambda screen, hint=hint: hint in pupil.marked(screen, "!"), 2 * PATIENCE)  # type: ignore[misc]
        if key == "i":
            terminal.pause(LET_GO)
            terminal.hold_until("r", lambda screen: pupil.step(screen) == 2, 2 * PATIENCE)
            assert not pupil.marked(terminal.screen(), "!"), "the hint goes when the task is done"
        terminal.pause(LET_GO)
    assert pupil.step(pupil.learn()) == 0, "a wrong deed costs nothing"
