"""MAVProxy, as its user types: it connects, reads and sets parameters, arms, changes modes and drives."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.groundstation.replay.logs import indexed
from tests.interop import mavproxy as mavproxy_program
from tests.interop.conftest import HOME, Rover
from tests.interop.conversation import Conversation
from tests.interop.mavproxy import plan_file
from tests.waits import Waits
from vehicle.params import TABLE

pytestmark = [pytest.mark.interop, mavproxy_program.needed]

WAYPOINT, RALLY_POINT, POLYGON_CORNER, RETURN_POINT = 16, 5100, 5001, 5000
"""MAV_CMD"""


@pytest.fixture
def mavproxy(rover: Rover, tmp_path: Path) -> Iterator[Conversation]:
    """MAVProxy, connected."""
    with mavproxy_program.started(rover.port, tmp_path) as program:
        yield program


LARGEST_RECORD = 8 + 280 + 13
"""Bytes of a record in a log: time, frame, signature."""
QUICK, ATTEMPTS = 3.0, 5
"""s for all parameters; how often it may take longer, because the machine is shared."""


def test_it_connects_reads_all_parameters_and_sets_one(mavproxy: Conversation, rover: Rover) -> None:
    """First MAVProxy's own fetch, then the list that its older versions request."""
    mavproxy.hear("Detected vehicle 1:1")
    assert min(fetches(mavproxy, rover, rf"Received {len(TABLE)} parameters \(ftp\)")) < QUICK
    mavproxy.say("set param_ftp False")
    mavproxy.say("param fetch")
    assert min(fetches(mavproxy, rover, rf"Received {len(TABLE)} parameters\s")) < QUICK
    mavproxy.say("param set SPEED_MAX 1.4")
    mavproxy.ask("param fetch SPEED_MAX", r"SPEED_MAX = 1\.4")
    mavproxy.say("param set SPEED_MAX 5000")
    mavproxy.hear("SPEED_MAX not changed")
    assert_no_error(mavproxy)


def fetches(mavproxy: Conversation, rover: Rover, told: str) -> Iterator[float]:
    """Return the s that MAVProxy takes to fetch all parameters, without the delays of the machine.

    The first fetch is already under way. Ends with a quick one.
    """
    for _ in range(ATTEMPTS):
        waits, begun = Waits(rover.vehicle.process.pid, mavproxy.pid), time.monotonic()
        mavproxy.hear(told)
        took = time.monotonic() - begun - waits.total()
        yield took
        if took < QUICK:
            return
        mavproxy.say("param fetch")


def test_a_session_without_an_error_line_and_without_loss(mavproxy: Conversation, rover: Rover, tmp_path: Path) -> None:
    """Type lists, plans, each mode, the stick, and the way back."""
    (tmp_path / "mission.txt").write_text(plan_file(WAYPOINT, 0, [HOME, (HOME[0] + 0.00003, HOME[1])]))
    (tmp_path / "rally.txt").write_text(plan_file(RALLY_POINT, 0, [HOME, (HOME[0] + 0.00001, HOME[1])]))
    mavproxy.hear("Received .* parameters")
    for line, answer in (
        ("param show SPEED_MAX", r"SPEED_MAX +1\.5"),
        ("param fetch SPEED_MAX", r"SPEED_MAX = 1\.5"),
        ("ftp list", r"D logs[^$]*parameter\.json\.xz"),
        ("log list", "No logs|Log "),
        ("wp list", "Requesting 0 waypoints"),
        ("wp load mission.txt", "TYPE_MISSION: ACCEPTED"),
        ("rally load rally.txt", "TYPE_RALLY: ACCEPTED"),
        ("rally list", "Saved 2 rally items"),
        ("fence list", "Requesting 0 fence items"),
        ("ping", "ping response"),
    ):
        mavproxy.say(line)
        mavproxy.hear(answer)
    mavproxy.ask("status ESTIMATOR_STATUS", r"flags : \d\d")  # the position is known, which some modes need
    mavproxy.say("module load calibration")
    mavproxy.hear("Loaded module calibration")
    mavproxy.say("gyrocal")
    mavproxy.hear("PREFLIGHT_CALIBRATION: IN_PROGRESS")
    mavproxy.hear("PREFLIGHT_CALIBRATION: ACCEPTED")
    mavproxy.hear("Gyro calibrated")
    for mode in ("ACRO", "LOITER", "AUTO", "RTL", "GUIDED", "HOLD", "MANUAL"):
        choose(mavproxy, mode)
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    mavproxy.hear("ARMED")
    mavproxy.say("rc 3 1500")  # neutral first
    mavproxy.say("rc 3 1600")
    rover.drives()
    left, right = next(each.throttles for each in reversed(rover.vehicle.outputs()) if each.turning)
    assert left == right > 0
    mavproxy.say("rc 3 1500")
    rover.stands()
    choose(mavproxy, "SMART_RTL")
    choose(mavproxy, "GUIDED")
    assert_no_loss(mavproxy)
    assert_no_error(mavproxy)
    mavproxy.say("velocity 0.8 0 0")
    rover.drives()
    mavproxy.hear("setpoints lost: stopping")  # sent once
    rover.stands()
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")
    index = indexed((tmp_path / "mav.tlog").read_bytes())  # its log of this session, as a replay reads it
    assert index.frames > 100  # those that are flushed by now
    assert index.damaged == 0
    assert index.tail < LARGEST_RECORD  # one may be cut off


@pytest.mark.parametrize("reposition", [True, False])
def test_guided_drives_to_a_place(mavproxy: Conversation, rover: Rover, reposition: bool) -> None:
    """MAVProxy sends DO_REPOSITION, or MISSION_ITEM_INT with current 2 as its older versions do."""
    place = (HOME[0] + 0.00004, HOME[1])
    mavproxy.hear("Received .* parameters")
    mavproxy.ask("status ESTIMATOR_STATUS", r"flags : \d\d")  # the position is known
    mavproxy.say(f"set guided_use_reposition {reposition}")
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    go_to = f"guided {place[0]:.7f} {place[1]:.7f} 0"
    if not reposition:  # which changes no mode
        mavproxy.ask(go_to, "TYPE_MISSION: ERROR")
        assert not rover.vehicle.turning()
        choose(mavproxy, "GUIDED")
    mavproxy.ask(go_to, "DO_REPOSITION: ACCEPTED" if reposition else "TYPE_MISSION: ACCEPTED", 5.0)
    rover.drives()
    rover.is_at(place)
    rover.stands()
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")


def test_relays_and_servos_do_as_they_are_told(mavproxy: Conversation, rover: Rover) -> None:
    """Of a simulation, which has relays 0 and 1 and servos 9 and 10; 3 is a motor."""
    mavproxy.hear("Received .* parameters", 15)
    mavproxy.say("relay set 0 1")
    mavproxy.hear("DO_SET_RELAY: ACCEPTED")
    mavproxy.ask("status RELAY_STATUS", r"on : 1, present : 3")
    mavproxy.say("servo set 9 1700")
    mavproxy.hear("DO_SET_SERVO: ACCEPTED")
    mavproxy.ask("status SERVO_OUTPUT_RAW", r"servo9_raw : 1700")
    mavproxy.say("relay repeat 1 1 0.2")
    mavproxy.hear("DO_REPEAT_RELAY: ACCEPTED")
    mavproxy.say("servo repeat 10 1200 1 0.2")
    mavproxy.hear("DO_REPEAT_SERVO: ACCEPTED")
    mavproxy.ask("status SERVO_OUTPUT_RAW", r"servo10_raw : 1500")  # moved, and back at its trim
    mavproxy.say("relay set 0 0")
    mavproxy.hear("DO_SET_RELAY: ACCEPTED")
    mavproxy.ask("status RELAY_STATUS", r"on : 0, present : 3")
    assert_no_loss(mavproxy)
    assert_no_error(mavproxy)
    mavproxy.say("servo set 3 1900")
    mavproxy.hear("DO_SET_SERVO: DENIED")
    assert rover.vehicle.outputs() == []


def choose(mavproxy: Conversation, mode: str) -> None:
    """Change the mode and wait for the change."""
    mavproxy.say(f"mode {mode}")
    mavproxy.hear("DO_SET_MODE: ACCEPTED")
    mavproxy.hear(f"Mode {mode}|{mode}>")


def assert_no_loss(mavproxy: Conversation) -> None:
    """Check that no message was lost: MAVProxy counts messages that its dialect lacks, so none was sent unrequested."""
    mavproxy.say("link")
    told = mavproxy.hear(r"link 1 OK \((\d+) packets, .* (\d+) lost, ([\d.]+)% loss")
    assert int(told[1]) > 100
    assert (told[2], told[3]) == ("0", "0.0")


def assert_no_error(mavproxy: Conversation) -> None:
    """Check that it printed no error since its start; a machine that pauses may delay its stick."""
    said = re.sub(r"Failsafe.*manual control lost", "", mavproxy.transcript)
    assert not re.search("fail|error|traceback|unknown|refused", said, re.IGNORECASE), mavproxy.transcript


def test_a_mission_inside_a_fence(mavproxy: Conversation, rover: Rover, tmp_path: Path) -> None:
    points = [(HOME[0] + north, HOME[1]) for north in (0.00002, 0.00003)]
    corners = [(HOME[0] + north, HOME[1] + east) for north, east in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    (tmp_path / "mission.txt").write_text(plan_file(WAYPOINT, 0, points))
    return_point = f"4\t0\t3\t{RETURN_POINT}\t0\t0\t0\t0\t{HOME[0]:.7f}\t{HOME[1]:.7f}\t0\t1\n"
    (tmp_path / "fence.txt").write_text(plan_file(POLYGON_CORNER, 4, corners) + return_point)
    mavproxy.hear("Received .* parameters")
    mavproxy.say("wp load mission.txt")
    mavproxy.hear("TYPE_MISSION: ACCEPTED")
    mavproxy.say("wp list")
    mavproxy.hear("Saved 2 waypoints")
    mavproxy.say("fence load fence.txt")
    mavproxy.hear("TYPE_FENCE: ACCEPTED")
    mavproxy.say("fence list")
    mavproxy.hear("Saved 5 fence items")
    mavproxy.say("fence enable")
    mavproxy.hear("DO_FENCE_ENABLE: ACCEPTED")
    mavproxy.say("arm throttle")
    mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
    mavproxy.say("wp set 0")
    mavproxy.hear("DO_SET_MISSION_CURRENT: ACCEPTED")
    mavproxy.say("long MISSION_START 0 0")
    mavproxy.hear("MISSION_START: ACCEPTED")
    rover.drives()
    mavproxy.hear("mission complete")
    rover.stands()
    rover.is_at(points[-1])
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")
    assert_no_error(mavproxy)
