"""Agents with the SDK's own client, a real screen in tmux and the simulator: wheels turn only while a key is held."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from groundstation.station_socket.connect import running_stations
from tests.e2e.programs import LET_GO, Vehicle
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.test_stop_matrix import FALLS_WITHIN, NEUTRAL_WITHIN
from tests.e2e.tmux_marks import IN_TMUX
from tests.groundstation.held_key import event_times
from tests.ports import free_port
from tests.waits import PATIENCE, Patience, Waits, wait_until

__all__ = ["tmux"]

pytestmark = [*IN_TMUX, pytest.mark.xdist_group("agents")]

DRIVE = {"throttle": 60, "seconds": 9, "max_meters": 50}
RELEASED, RELEASES = "the key was released", "a released key"
TRIES = 6
"""Times that one way is tried: the screen of a late machine freezes, which ends what runs and takes the key."""
TRY = 10.0
"""s for a held key to turn the wheels; then it is pressed anew."""


class Agent:
    """An MCP client in a process of its own, that calls tools."""

    def __init__(self, folder: Path, *calls: tuple[str, dict[str, Any]]) -> None:
        """It ends after these calls. Without any, it waits for those of `ask`: a start takes 4 s of CPU."""
        self._out = folder / f"agent{time.monotonic_ns()}.out"
        asked = self._out.with_suffix(".calls")
        asked.write_text(json.dumps([(*call, 1) for call in calls]))
        with self._out.open("wb") as out:
            command = [sys.executable, "-m", "tests.e2e.agent", str(asked)]
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=out, stderr=out, text=True)
        self._earlier = 0
        """Answers before the newest call of `ask`."""
        assert self.process.stdin is not None
        self._asks = self.process.stdin
        if calls:
            self._asks.close()

    @property
    def answers(self) -> list[Any]:
        """The answers so far; after `ask` those to it."""
        return [json.loads(line) for line in self._out.read_text().splitlines() if line.startswith("{")][
            self._earlier :
        ]

    def ask(self, tool: str, arguments: dict[str, Any], times: int = 1) -> None:
        """Call a tool, so many times at once."""
        self._earlier += len(self.answers)
        self._asks.write(json.dumps((tool, arguments, times)) + "\n")
        self._asks.flush()

    @property
    def said(self) -> str:
        """All that it has printed."""
        return self._out.read_text()

    def end(self) -> None:
        """End it in any state."""
        self.process.kill()
        self.process.wait()
        with suppress(BrokenPipeError):
            self._asks.close()


def kill_screen(terminal: Tmux) -> None:
    """Kill the screen's process: the child of the shell in the window."""
    shell = terminal._run("display-message", "-p", "#{pane_pid}").strip()
    children = Path(f"/proc/{shell}/task/{shell}/children").read_text().split()
    os.kill(int(children[0] if children else shell), signal.SIGKILL)


class Way(NamedTuple):
    """What ends a proposal that runs, and where it is permitted."""

    act: Callable[[Tmux, Agent], object]
    told: str = ""
    """What the agent is told, if it can be."""
    opens: str = "F1"
    """Key of the screen."""
    key: str = "p"
    """The one that permits there."""


WAYS: dict[str, Way] = {
    "a released key": Way(lambda terminal, agent: None, RELEASED),
    "a stop key": Way(lambda terminal, agent: terminal.press("Space"), "something else"),
    "another key": Way(lambda terminal, agent: terminal.press("k"), "something else"),
    "a released key on Log": Way(lambda terminal, agent: None, RELEASED, "F6"),
    "a key of Map": Way(lambda terminal, agent: terminal.press("+"), "", "F2", "Z"),
    "the key that declines": Way(lambda terminal, agent: terminal.press("P")),
    "SIGSTOP of the agent": Way(lambda terminal, agent: agent.process.send_signal(signal.SIGSTOP)),
    "kill -9 of the agent": Way(lambda terminal, agent: agent.process.kill()),
    "kill -9 of the screen": Way(lambda terminal, agent: kill_screen(terminal)),
}
"""The last one ends the station, too."""


def test_wheels_turn_while_the_key_is_held_and_stop(tmux: Callable[..., Tmux], tmp_path: Path) -> None:
    port = free_port()
    vehicle = Vehicle(tmp_path, port)
    terminal = tmux(80, 24, f"udpin:127.0.0.1:{port}")
    agents: list[Agent] = []
    try:
        terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
        wait_until(running_stations, "the station listens")
        for name in WAYS:
            see_it_stop(terminal, vehicle, tmp_path, agents, name)
    finally:
        for agent in agents:
            agent.end()
        vehicle.end()


def see_it_stop(terminal: Tmux, vehicle: Vehicle, folder: Path, agents: list[Agent], name: str) -> None:
    """Let an agent drive and end it in one way; anew where the screen of a late machine has ended it before."""
    for number in range(TRIES):
        terminal.press("F1")
        if "ARMED" not in (screen := terminal.screen()) or "DISARMED" in screen:
            terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
        terminal.press(WAYS[name].opens)
        reason, asks = f"look behind chair {number} by {name}", f"agent asks: hold {WAYS[name].key} to let it"
        if not agents or agents[-1].process.poll() is not None:
            agents.append(Agent(folder))
        agents[-1].ask("drive", {**DRIVE, "reason": reason})
        if it_is_shown(terminal, agents[-1], reason, asks) and it_stops(terminal, vehicle, agents[-1], name):
            return
        agents[-1].end()
        wait_until(lambda: not vehicle.turning(), f"{name}: neutral")
        terminal.pause(LET_GO)
    said = [agent.said for agent in agents[-TRIES:]]
    raise AssertionError(f"{name}: {TRIES} times something else: {said}\n{terminal.screen()}")


def it_is_shown(terminal: Tmux, agent: Agent, *texts: str) -> bool:
    """Wait until the screen asks for the proposal; return False if it has ended before."""
    terminal.until(
        lambda screen: all(text in screen for text in texts) or bool(agent.answers) or agent.process.poll() is not None,
        PATIENCE,
    )
    return not agent.answers and agent.process.poll() is None


def it_stops(terminal: Tmux, vehicle: Vehicle, agent: Agent, name: str) -> bool:
    """Hold the key until the wheels turn at full demand, end it in one way, and see them stop in time.

    Returns False if something else has ended it.
    """
    act, told, _, key = WAYS[name]
    assert not vehicle.turning()
    with terminal.held(key, event_times(60.0)) as release:
        patience = Patience(TRY, *running_stations())
        wait_until(lambda: vehicle.at_full() or agent.answers or patience.ended, name)
        if agent.answers or not vehicle.at_full():
            return False
        waits = Waits(vehicle.process.pid, *running_stations())
        act(terminal, agent)
        at = release() if name.startswith(RELEASES) else time.monotonic()
        wait_until(vehicle.stands, f"{name}: standing")
    falls, stops = vehicle.falls_and_stops_after(at)
    assert falls <= FALLS_WITHIN + waits.total(), name
    assert stops <= NEUTRAL_WITHIN + waits.total(), name
    if name.endswith(("agent", "screen")):
        agent.end()
        return True
    wait_until(lambda: agent.answers, lambda: agent.said)
    return told in agent.answers[0]["error"]
