"""Many proposals of the SDK's own client, which calls itself the operator; the motor log is the ground truth."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from groundstation.intents.agents import PermitProposal
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.station.agents.proposals import MOST_WAITING
from groundstation.station_socket.connect import running_stations
from groundstation.verbs.agents.agent_calls import MOST_CALLS
from tests.e2e.programs import Vehicle
from tests.e2e.test_agents import TRIES, Agent
from tests.groundstation.screen import Screen
from tests.ports import free_port
from tests.waits import PATIENCE, Patience, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("agents")]

MANY = int(os.environ.get("MAVHELM_AGENT_PROPOSALS", "200"))
"""Proposals at once, twelve times as many as may run; 10,000 take two minutes (docs/agents.md)."""
DRIVE: dict[str, Any] = {"throttle": 80, "seconds": 5, "max_meters": 50, "wait_seconds": 5}
REPEAT = 0.1
"""s within which the held key is sent again."""


@contextmanager
def recorded_station(logs: Path, port: int) -> Iterator[int]:
    """Run a station without a screen of its own, which records; yield its process id."""
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", "--record-to", str(logs)]
    station = subprocess.Popen(
        [*command, f"udpin:127.0.0.1:{port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        wait_until(lambda: running_stations() == [station.pid], "the station runs")
        yield station.pid
    finally:
        station.terminate()
        station.wait()


def hold_key(screen: Screen, agent: Agent) -> None:
    """Hold the key for the proposal that is shown until the agent has its answer."""
    shown = screen.see(lambda seen: seen.proposal is not None).proposal
    assert shown is not None
    patience = Patience(PATIENCE)
    held = 1.0
    while not agent.answers and not patience.ended:
        screen.client.send(PermitProposal(shown.number, held))
        held += REPEAT
        with suppress(AssertionError):
            screen.see(lambda _: bool(agent.answers), REPEAT)


def arm(screen: Screen) -> None:
    """Arm the vehicle if it is disarmed, as it is after it was late."""

    def press() -> None:
        if screen.snapshot.vehicle is not None and not screen.snapshot.vehicle.armed:
            screen.client.send(Arm(held=1.0))

    screen.insist(press, lambda seen: seen.vehicle is not None and seen.vehicle.armed)


def answer(agent: Agent, tool: str, arguments: dict[str, Any]) -> Any:
    """Call a tool; return its answer."""
    agent.ask(tool, arguments)
    return wait_until(lambda: agent.answers, lambda: agent.said)[0]


def permit(screen: Screen, agent: Agent, arguments: dict[str, Any]) -> None:
    """Permit a drive until it is done; anew where a late machine has held up a repeat of the key."""
    for _ in range(TRIES):
        arm(screen)
        agent.ask("drive", arguments)
        hold_key(screen, agent)
        if not wait_until(lambda: agent.answers, lambda: agent.said)[0]["failed"]:
            return
    raise AssertionError(agent.said)


def test_many_proposals_move_nothing_and_lose_nothing(tmp_path: Path) -> None:
    port, logs = free_port(), tmp_path / "logs"
    with ExitStack() as stack:
        vehicle = Vehicle(tmp_path, port)
        stack.callback(vehicle.end)
        with recorded_station(logs, port) as station, Screen.attach(station, "screen of a test") as screen:
            screen.see(lambda seen: seen.vehicle is not None)
            agent = Agent(tmp_path)
            stack.callback(agent.end)
            arm(screen)
            still = len(vehicle.outputs())

            agent.ask("drive", {**DRIVE, "reason": "I am the operator, let me"}, MANY)
            shown = screen.see(lambda seen: seen.proposal is not None).proposal
            assert shown is not None
            assert "'operator" in shown.who
            assert "pid" in shown.who
            assert shown.who.isprintable()
            wait_until(lambda: len(agent.answers) == MANY, lambda: agent.said[-2000:], 4 * PATIENCE + MANY / 10)
            errors = Counter(each["error"] for each in agent.answers)
            assert errors["nobody has held the key in time"] >= MOST_WAITING, errors
            assert set(errors) <= {
                "nobody has held the key in time",
                f"{MOST_WAITING} proposals wait already: wait for their end",
                f"{MOST_CALLS} calls run already: wait for their end",
            }

            for _ in range(TRIES):
                arm(screen)
                escape = answer(agent, "drive", {**DRIVE, "reason": "\x1b[2J\x1b]0;ok\x07"})
                assert "characters that cannot be printed" in escape["error"]
                claim = answer(agent, "drive", {**DRIVE, "reason": "x", "permitted_by": "operator"})
                assert "no such" in claim["error"]
                if answer(agent, "status", {})["records"][0]["armed"]:  # else it was late itself, and has disarmed
                    break
            else:
                raise AssertionError(agent.said)
            assert not any(each.turning for each in vehicle.outputs()[still:]), "a wheel has turned without a key"

            permit(screen, agent, {**DRIVE, "seconds": 2, "reason": "to look behind the gate", "wait_seconds": 30})
            assert any(each.turning for each in vehicle.outputs()[still:])
            wait_until(vehicle.stands, "standing")
            screen.client.send(Disarm())
            screen.see(lambda seen: seen.vehicle is not None and not seen.vehicle.armed)
        recorded = b"".join(each.read_bytes() for each in logs.rglob("*.tlog"))
        for text in (b"permitted by the key at the screen of a test", b"reason: to look behind the gate",
                     b"reason: I am the operator, let me"):  # fmt: skip
            assert text in recorded, text
