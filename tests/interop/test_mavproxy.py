"""MAVProxy, as its user types: it connects, reads and sets parameters, arms, changes modes and drives."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.interop import mavproxy as mavproxy_program
from tests.interop.conftest import HOME, Rover
from tests.interop.conversation import Conversation
from tests.interop.mavproxy import plan_file
from vehicle.params import TABLE

pytestmark = [pytest.mark.interop, mavproxy_program.needed]


@pytest.fixture
def mavproxy(rover: Rover, tmp_path: Path) -> Iterator[Conversation]:
    """MAVProxy, connected."""
    with mavproxy_program.started(rover.port, tmp_path) as program:
        yield program


def test_it_connects_reads_all_parameters_and_sets_one(mavproxy: Conversation) -> None:
    mavproxy.hear("Detected vehicle 1:1", 15)
    connected = time.monotonic()
    mavproxy.hear(rf"Received {len(TABLE)} parameters \(ftp\)", 5)
    assert time.monotonic() - connected < 3
    mavproxy.say("param set SPEED_MAX 1.4")
    mavproxy.ask("param fetch SPEED_MAX", r"SPEED_MAX = 1\.4")
    mavproxy.say("param set SPEED_MAX 5000")
    mavproxy.hear("SPEED_MAX not changed")
    assert not re.search("fail|error|traceback|unknown", mavproxy.transcript, re.IGNORECASE), mavproxy.transcript


def test_it_arms_changes_modes_and_drives(mavproxy: Conversation, rover: Rover) -> None:
    mavproxy.hear("Received .* parameters", 15)
    mavproxy.say("mode HOLD")
    mavproxy.hear("DO_SET_MODE: ACCEPTED")
    mavproxy.hear("Mode HOLD")
    mavproxy.say("mode MANUAL")
    mavproxy.hear("DO_SET_MODE: ACCEPTED")
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    mavproxy.hear("ARMED")
    mavproxy.say("rc 3 1500")  # neutral first
    mavproxy.say("rc 3 1600")
    rover.drives()
    left, right = rover.vehicle.outputs()[-1].throttles
    assert left == right > 0
    mavproxy.say("rc 3 1500")
    rover.stands()
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")


def test_it_lists_files_logs_and_plans(mavproxy: Conversation) -> None:
    mavproxy.hear("Received .* parameters", 15)
    mavproxy.say("ftp list")
    mavproxy.hear("D logs")
    mavproxy.hear("parameter.json.xz")
    mavproxy.say("log list")
    mavproxy.hear("No logs|Log ")
    mavproxy.say("wp list")
    mavproxy.hear("Requesting 0 waypoints")
    mavproxy.say("ping")
    mavproxy.hear("ping response")


def test_link_shows_no_loss(mavproxy: Conversation) -> None:
    """It takes each message that its dialect lacks for a lost one, so none comes that it has not asked for."""
    mavproxy.hear("Received .* parameters", 15)
    mavproxy.say("ftp list")
    mavproxy.hear("Total size")
    mavproxy.say("mode HOLD")
    mavproxy.hear("DO_SET_MODE: ACCEPTED")
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    deadline = time.monotonic() + 10
    packets = 0
    while packets < 200:
        assert time.monotonic() < deadline
        mavproxy.say("link")
        told = mavproxy.hear(r"link 1 OK \((\d+) packets, .* (\d+) lost, ([\d.]+)% loss")
        packets = int(told[1])
        assert (told[2], told[3]) == ("0", "0.0")


def test_a_mission_inside_a_fence(mavproxy: Conversation, rover: Rover, tmp_path: Path) -> None:
    points = [(HOME[0], HOME[1]), (HOME[0] + 0.00003, HOME[1])]
    corners = [(HOME[0] + north, HOME[1] + east) for north, east in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    (tmp_path / "mission.txt").write_text(plan_file(16, 0, points))
    (tmp_path / "fence.txt").write_text(plan_file(5001, 4, corners))
    mavproxy.hear("Received .* parameters", 15)
    mavproxy.say("wp load mission.txt")
    mavproxy.hear("TYPE_MISSION: ACCEPTED")
    mavproxy.say("wp list")
    mavproxy.hear("Saved 2 waypoints")
    mavproxy.say("fence load fence.txt")
    mavproxy.hear("TYPE_FENCE: ACCEPTED")
    mavproxy.say("fence list")
    mavproxy.hear("Saved 4 fence items")
    mavproxy.say("fence enable")
    mavproxy.hear("DO_FENCE_ENABLE: ACCEPTED")
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    mavproxy.say("mode AUTO")
    mavproxy.hear("DO_SET_MODE: ACCEPTED")
    rover.drives()
    mavproxy.hear("mission complete", 20)
    rover.stands()
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")
