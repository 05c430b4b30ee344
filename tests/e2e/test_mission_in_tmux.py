"""A mission drawn by cursor keys in a real terminal, uploaded, driven in AUTO by the simulator, changed on the way."""

from __future__ import annotations

import re
from collections.abc import Callable

from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.waits import PATIENCE

__all__ = ["tmux"]

pytestmark = IN_TMUX


def type_a_mode(terminal: Tmux) -> None:
    """Change the mode by the command line, with the word that the vehicle completes."""
    terminal.press(":")
    terminal.until(lambda screen: "TAB completes" in screen, PATIENCE)
    terminal.press(*"mode", "Space", *"HO")
    terminal.until(lambda screen: re.search(r"^ HOLD *\n :mode HO *$", screen, re.MULTILINE) is not None, PATIENCE)
    terminal.press("Tab")
    terminal.until(lambda screen: "mode HOLD" in screen, PATIENCE)
    terminal.press("Enter")
    terminal.until(lambda screen: "mode HOLD: accepted" in screen, PATIENCE)


def test_a_mission_is_drawn_driven_and_changed(tmux: Callable[..., Tmux]) -> None:
    terminal = tmux(140, 45, "--sitl")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    type_a_mode(terminal)
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.press("F2")
    terminal.until(lambda screen: "no mission: a adds an item" in screen, PATIENCE)
    terminal.press(*["Up"] * 5, "a", *["Right"] * 10, "a")
    terminal.until(lambda screen: "2 new, not on the vehicle" in screen, PATIENCE)
    terminal.press("U")
    terminal.until(lambda screen: "upload the mission (2 new) while Rover 1 is ARMED" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: re.search(r"mission +2 items +same", screen) is not None, PATIENCE)
    terminal.press("P")
    terminal.until(lambda screen: "start the mission: Rover 1 drives by itself" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: "follows the mission: SPACE holds it" in screen or "▶" in screen, PATIENCE)
    terminal.until(lambda screen: re.search(r"0 WAYPOINT.*✓", screen) is not None, PATIENCE)

    terminal.press("Space")
    terminal.until(lambda screen: "HOLD  ARMED" in screen and "speed 0.00 m/s" in screen, PATIENCE)
    terminal.press(*["Up"] * 3, "m")
    terminal.until(lambda screen: "1 changed, not on the vehicle" in screen, PATIENCE)
    terminal.press("U")
    terminal.until(lambda screen: "upload the mission (1 changed)" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: re.search(r"mission +2 items +same", screen) is not None, PATIENCE)
    terminal.press("J")
    terminal.until(lambda screen: "jump to item 1 WAYPOINT" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: re.search(r"1 WAYPOINT.*▶", screen) is not None, PATIENCE)
    terminal.press("P")
    terminal.until(lambda screen: "drives by itself" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: "mission complete" in screen and "speed 0.00 m/s" in screen, PATIENCE)
    terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
    assert "Traceback" not in ended
