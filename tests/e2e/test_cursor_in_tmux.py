"""The cursor of a real terminal, which screen readers follow."""

from __future__ import annotations

from pathlib import Path

from tests.e2e.test_in_tmux import Tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.waits import PATIENCE, wait_until

pytestmark = IN_TMUX

TO_SIMULATORS = ("Tab", "Tab", "Tab")
"""From "heard now" over "recent" and "serial ports", which may be empty and then show no cursor."""


def test_the_cursor_is_on_the_focused_row(tmp_path: Path) -> None:
    tmux = Tmux(tmp_path, 80, 24, "--cursor")
    try:
        tmux.until(lambda screen: "› ENTER starts a simulated rover" in screen, PATIENCE)
        tmux.press(*TO_SIMULATORS)

        def row() -> tuple[int, str]:
            column, line, shown = tmux.cursor()
            return line, tmux.screen().splitlines()[line][column:] if shown else ""

        def describe() -> str:
            return f"{row()}\n{tmux.screen()}"

        wait_until(lambda: row()[1].startswith("› s rover"), describe)
        first = row()[0]
        tmux.press("Down")
        wait_until(lambda: row()[1].startswith("› c car") and row()[0] == first + 1, describe)
    finally:
        tmux.end()
