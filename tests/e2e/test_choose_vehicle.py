"""Two simulators, one ground station in a real terminal: the other one is chosen on the Links screen and driven."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.e2e.programs import Vehicle
from tests.e2e.test_in_tmux import Tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = IN_TMUX


@pytest.fixture
def port() -> int:
    """Where the ground station listens."""
    return free_port()


@pytest.fixture
def rovers(tmp_path: Path, port: int) -> Iterator[dict[int, Vehicle]]:
    """Rover 1 and rover 2, both in motion as soon as they are driven."""
    made = {}
    for system in (1, 2):
        folder = tmp_path / f"rover{system}"
        folder.mkdir()
        made[system] = Vehicle(folder, port, "--param", f"MAV_SYSID={system}")
    yield made
    for vehicle in made.values():
        vehicle.end()


@pytest.fixture
def terminal(tmp_path: Path, port: int) -> Iterator[Tmux]:
    """The ground station in a terminal of 80x24."""
    made = Tmux(tmp_path, 80, 24, f"udpin:127.0.0.1:{port}")
    yield made
    made.end()


def drive_until_it_turns(terminal: Tmux, vehicle: Vehicle) -> None:
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.drive_until(lambda _: vehicle.at_full())


def row(screen: str, name: str) -> str:
    return next((line for line in screen.splitlines() if line.startswith("│") and f" {name} " in line), "")


def test_the_chosen_vehicle_is_driven_and_the_first_one_stands(terminal: Tmux, rovers: dict[int, Vehicle]) -> None:
    terminal.until(lambda screen: "hold r to arm" in screen and "Vehicle" in screen, PATIENCE)
    first = 1 if "Rover 1 " in terminal.screen().splitlines()[0] else 2
    other = 3 - first
    drive_until_it_turns(terminal, rovers[first])

    terminal.press("F7")
    terminal.until(lambda screen: "ARMED" in row(screen, f"Rover {first}"), PATIENCE, holding="i")
    terminal.until(lambda _: rovers[first].stands(), PATIENCE, holding="i")
    terminal.press(str(other))
    terminal.until(lambda screen: f"ENTER chooses Rover {other}; Rover {first} gets neutral first" in screen, PATIENCE)
    chosen = time.monotonic()
    terminal.press("Enter")
    listed = terminal.until(
        lambda screen: (
            row(screen, f"Rover {other}").startswith("│›●") and f"also armed: {first}" in screen.splitlines()[0]
        ),
        PATIENCE,
    )
    assert f" Rover {other} " in listed.splitlines()[0]
    terminal.until(lambda screen: "firmware 0.1.0" in screen, PATIENCE)

    terminal.press("F1")
    terminal.until(lambda screen: f"hold r to arm Rover {other}" in screen, PATIENCE)
    drive_until_it_turns(terminal, rovers[other])
    assert not rovers[first].moved_since(chosen)
    terminal.until(lambda _: rovers[other].stands(), PATIENCE)

    terminal.press("F7")
    terminal.until(lambda screen: "this one, 255/190, session" in screen, PATIENCE)
    terminal.press("G")
    terminal.until(lambda screen: "no ground station · g requests control" in screen, PATIENCE)
    terminal.press("g")
    terminal.until(lambda screen: "this one, 255/190, session" in screen, PATIENCE)
    terminal.press("!")
    terminal.until(lambda screen: "EMERGENCY STOP" in screen and "E-STOP" in row(screen, f"Rover {other}"), PATIENCE)
    assert "Traceback" not in terminal.screen()
