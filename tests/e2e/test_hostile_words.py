"""A vehicle whose names and texts are markup and escape sequences, on every screen of the real program in tmux."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from dialects import messages as m
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.fakes.lines import on_line
from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle
from tests.fakes.wires import PymavlinkWire
from tests.waits import PATIENCE

__all__ = ["tmux"]

pytestmark = IN_TMUX

HOSTILE = ("[/x]", "[/]", "[red]a", "[@click=q]b", "\x1b[2Jc", "\x1b]0;d\x07e", "-o", "=1+1", "$(id)", "%n")
TEXTS = ("PreArm: [/x]", "[/]", "\x1b[2J\x1b]0;owned\x07text", "[@click=app.quit]b[/]")
LINES = {
    "mode [/x]": "mode [/x]?  y does it",
    "[/x]": "'[/x]' is not a verb",
    "param get [/]": "no parameter matches [/]",
}
"""Lines of the command line, and the answer to each."""
KEYS = ("F2", "F3", "F4", "F5", "F6", "F7", "F8")


def hostile_vehicle() -> ForeignVehicle:
    vehicle = ForeignVehicle()
    vehicle.params.clear()
    vehicle.params |= {name: Param(1, 9) for name in HOSTILE}
    vehicle.modes = [(name, 100 + at, 0) for at, name in enumerate(HOSTILE)]
    vehicle.mode = 100
    vehicle.files.files |= {f"/logs/{name}": b"x" for name in ("[/x].bin", "-rf", ".hidden", "\x1b[2J.bin")}
    return vehicle


def test_every_screen_shows_hostile_words_as_they_are(tmux: Callable[..., Tmux], stack: ExitStack) -> None:
    vehicle = stack.enter_context(on_line(hostile_vehicle(), "udpout", wire=PymavlinkWire()))
    terminal = tmux(100, 30, vehicle.endpoint)
    terminal.until(lambda screen: "DISARMED" in screen, PATIENCE)
    for text in TEXTS:
        vehicle.send(m.StatusText(2, text.encode()))
    for key in KEYS:
        visit(terminal, key)
    terminal.press_until("F4", lambda screen: "[red]a" in screen and "[/x]" in screen)
    for _ in HOSTILE:
        terminal.press("Down")  # each has its name in the title of the panel beside the list
    terminal.until(lambda screen: "[red]a" in screen.replace("│", ""), PATIENCE)
    terminal.press_until("F6", lambda screen: "[@click=app.quit]b[/]" in screen)
    for line, answer in LINES.items():
        run_line(terminal, line, answer)
    screen = terminal.press_until("F1", lambda screen: "DISARMED" in screen)
    assert "EXIT CODE" not in screen


def run_line(terminal: Tmux, line: str, answer: str) -> None:
    """Type a line on Drive, see the answer, below the line or in the log, and leave by a function key."""
    terminal.press_until("F1", lambda screen: "hold r to arm" in screen)
    terminal.press_until(":", lambda screen: "ESC closes" in screen)
    terminal.press(*(each if each != " " else "Space" for each in line))
    terminal.until(lambda screen: f":{line}" in screen.replace(": ", ":"), PATIENCE)
    terminal.press("Enter")
    terminal.until(lambda screen: answer in screen and "ESC closes" not in screen, PATIENCE)
    terminal.press_until("F2", lambda screen: "hold r to arm" not in screen)


def visit(terminal: Tmux, key: str) -> None:
    """Open a screen."""
    before = terminal.screen()
    terminal.press(key)
    terminal.until(lambda screen: screen != before or "EXIT CODE" in screen, PATIENCE)
    assert "EXIT CODE" not in terminal.screen()


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """What is ended with the test."""
    with ExitStack() as stack:
        yield stack
