"""The cursor of a real terminal, which screen readers follow."""

from __future__ import annotations

from pathlib import Path

from tests.e2e.test_in_tmux import Tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.waits import PATIENCE, wait_until

pytestmark = IN_TMUX


def test_the_cursor_is_on_the_focused_row(tmp_path: Path) -> None:
    tmux = Tmux(tmp_path, 80, 24, "--cursor")
    try:
        tmux.until(lambda screen: "rover" in screen and "simulators" in screen, PATIENCE)
        tmux.press("Tab")

        def marked() -> bool:
            column, line, shown = tmux.cursor()
            return shown and tmux.screen().splitlines()[line][column : column + 1] == "›"

        def describe() -> str:
            return f"{tmux.cursor()}\n{tmux.screen()}"

        while "› s rover" not in tmux.screen():
            tmux.press("Tab")
            tmux.until(lambda screen: "›" in "".join(screen.splitlines()[:-2]), PATIENCE)
        wait_until(marked, describe)
        first = tmux.cursor()
        tmux.press("Down")
        wait_until(lambda: tmux.cursor()[1] == first[1] + 1 and marked(), describe)
    finally:
        tmux.end()
