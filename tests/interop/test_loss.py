"""Each client over a network that loses one frame in ten, each way: everything completes, and files are intact.

If a client sends something once and does not wait for an answer, the test does what its user does, and repeats it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import Capability, Command, MissionResult, Result
from link.services.mission import files
from link.services.mission.items import from_message
from tests.e2e.relay import Relay
from tests.interop import mavproxy, mavsdk_process, qgc_plans
from tests.interop.conftest import HOME, Rover
from tests.interop.conversation import Conversation
from tests.interop.qgroundcontrol import QGroundControl
from tests.interop.script import Script, mavparm, mavwp
from tests.waits import PATIENCE, Patience
from vehicle.autonomy.mission.executor import MissionState
from vehicle.params import TABLE

pytestmark = [pytest.mark.interop, pytest.mark.slow]

NORTH, EAST = (round(degrees * 1e7) for degrees in HOME)
WAYPOINT, LONG = 16, 200
END = (HOME[0] + 0.00003, HOME[1])
"""End of the missions that are driven: 3.3 m to the north."""
CLICKS = 10
"""Attempts of QGroundControl's user: three tries of a command are all lost once in 150."""
HASTE = 5.0
"""Factor by which the stand-in retries sooner than QGroundControl, so that the test takes less time."""


def waypoint(number: int, north: int) -> m.MissionItemInt:
    """Return an item, `north` of home in degrees x 1e7."""
    return m.MissionItemInt(1, 1, number, 3, WAYPOINT, 0, 1, 0.0, 0.0, 0.0, 0.0, NORTH + north, EAST, 0.0)


@pytest.fixture
def long_plan(far_rover: Rover) -> bytes:
    """Upload a mission of 200 items over a link without loss; return the file by which the vehicle serves it."""
    items = [waypoint(number, 100 * number) for number in range(LONG)]
    with QGroundControl(far_rover.second_port, system=254) as near:
        near.meet()
        eventually(lambda: written(near, items))
    return files.encode_plan([from_message(item) for item in items])


@pytest.fixture(autouse=True)
def it_was_lossy(relay: Relay) -> Iterator[None]:
    """Check that the network did lose frames."""
    yield
    assert relay.up.lost >= 2
    assert relay.down.lost >= 10


def eventually(attempt: Callable[[], bool]) -> None:
    """Retry until it works, as a user does."""
    patience = Patience()
    while not attempt():
        assert not patience.ended


def test_pymavlink(far_rover: Rover, long_plan: bytes) -> None:
    with Script(far_rover.port) as script:
        link = script.link
        link.param_fetch_all()
        script.insist(lambda: fetch_missing(link), lambda: len(link.params) == len(TABLE))
        script.insist(lambda: set_speed(link), lambda: link.params["SPEED_MAX"] == 1.25)
        eventually(lambda: script.fetch("missions/mission.waypoints") == long_plan)  # mavftp gives up after three tries
        loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
        for number in range(10):
            loader.add_latlonalt(HOME[0] + number * 1e-6, HOME[1], 0)
        assert script.upload(loader) == MissionResult.ACCEPTED
        assert [round((item.x - NORTH) / 10) for item in script.download()] == pytest.approx(list(range(10)), abs=4)
        script.insist(link.arducopter_arm, link.motors_armed)
        script.drive(500, far_rover.vehicle.turning)
        script.stick(0, far_rover.vehicle.stands)
        far_rover.stands()
        eventually(lambda: script.command(Command.MISSION_START) == Result.ACCEPTED)
        far_rover.drives()
        script.until(lambda: link.flightmode == "HOLD")
        far_rover.stands()
        script.insist(link.arducopter_disarm, lambda: not link.motors_armed())


def fetch_missing(link: Any) -> None:
    """Fetch parameters one by one, once the fetch of all is over."""
    for index, parameter in enumerate(TABLE):
        if link.params and parameter.name not in link.params:
            link.param_fetch_one(index)


def set_speed(link: Any) -> None:
    """mavparm accepts any PARAM_VALUE of that name as the answer, so its user reads the value back."""
    mavparm.MAVParmDict().mavset(link, "SPEED_MAX", 1.25, retries=1)
    link.param_fetch_one("SPEED_MAX")


def test_qgroundcontrol(far_rover: Rover, long_plan: bytes) -> None:
    with QGroundControl(far_rover.port, haste=HASTE, clicks=CLICKS) as ground:
        ground.meet()
        assert ground.request(m.AutopilotVersion).capabilities & Capability.MAVLINK2
        assert {"MANUAL", "HOLD"} <= set(ground.modes())
        meaning = ground.metadata()
        assert set(ground.parameters()) == set(meaning) == {parameter.name for parameter in TABLE}
        assert ground.download("/missions/mission.waypoints") == long_plan
        assert [qgc_plans.count(ground, kind) for kind in (0, 1, 2)] == [LONG, 0, 0]
        items = [waypoint(number, 150 * (number + 1)) for number in range(2)]
        eventually(lambda: written(ground, items))
        assert list(map(from_message, qgc_plans.read(ground, 0))) == list(map(from_message, items))
        assert ground.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
        ground.drive(600, until=far_rover.vehicle.turning)
        ground.joystick(0, until=far_rover.vehicle.stands)
        far_rover.stands()
        eventually(lambda: ground.command(Command.MISSION_START) is Result.ACCEPTED)
        far_rover.drives()
        assert ground.wait(m.MissionCurrent, PATIENCE, lambda current: current.mission_state == MissionState.COMPLETE)
        far_rover.stands()
        far_rover.is_at(END)
        assert ground.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED
        assert ground.repeats > 0


def written(ground: QGroundControl, items: list[m.MissionItemInt]) -> bool:
    """Click once on "upload"."""
    try:
        return qgc_plans.write(ground, 0, items) is MissionResult.ACCEPTED
    except qgc_plans.PlanError:
        return False


@mavproxy.needed
def test_mavproxy(far_rover: Rover, long_plan: bytes, tmp_path: Path) -> None:
    points = [HOME, END]
    (tmp_path / "mission.txt").write_text(mavproxy.plan_file(WAYPOINT, 0, points))
    with mavproxy.started(far_rover.port, tmp_path) as program:
        program.hear(rf"Received {len(TABLE)} parameters \(ftp\)")
        program.ask("param set SPEED_MAX 1.4\nparam fetch SPEED_MAX", r"SPEED_MAX = 1\.4")
        program.ask("ftp get /missions/mission.waypoints got.txt", r"Wrote", 10)
        eventually(
            lambda: (tmp_path / "got.txt").read_bytes() == long_plan
        )  # MAVProxy reports the end before it closes the file
        program.ask("wp load mission.txt", "TYPE_MISSION: ACCEPTED", 2)
        program.ask("wp list", "Saved 2 waypoints", 3)
        program.ask("arm throttle", "(?<!DIS)ARMED")
        eventually(lambda: pushed(program, far_rover))
        program.say("rc 3 1500")
        far_rover.stands()
        program.ask("mode AUTO", "Mode AUTO")
        far_rover.drives()
        program.hear("Mode HOLD")
        far_rover.stands()
        far_rover.is_at(END)
        program.ask("disarm", "DISARMED")


def pushed(program: Conversation, rover: Rover) -> bool:
    """Send neutral, then ahead; MAVProxy repeats only the newest, so the neutral one may get lost."""
    program.say("rc 3 1500")
    program.say("rc 3 1600")
    return rover.soon(rover.vehicle.turning, 1.0)


@mavsdk_process.needed
def test_mavsdk(far_rover: Rover, long_plan: bytes, tmp_path: Path) -> None:
    with mavsdk_process.started(far_rover.port, "lossy", tmp_path) as sdk:
        assert sdk.good("parameters").value == len(TABLE)
        sdk.good("set")
        assert sdk.good("get").value == pytest.approx(1.4)
        assert "SUCCESS" in str(sdk.good("file").value)
        assert (tmp_path / "mission.waypoints").read_bytes() == long_plan
        sdk.good("upload")
        assert sdk.good("download").value is True
        sdk.good("arm")
        far_rover.drives()
        sdk.say()
        far_rover.stands()
        sdk.say()
        far_rover.drives()
        sdk.good("start")
        assert sdk.good("finished").value is True
        far_rover.stands()
        far_rover.is_at(END)
        sdk.good("disarm")
