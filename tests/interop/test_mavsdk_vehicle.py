"""The verbs of the ground station with a vehicle that is made of MAVSDK's server plugins, over UDP."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from groundstation.intents.plan import DownloadPlan, UploadPlan
from groundstation.views.plan import PlanKind
from tests.groundstation.test_foreign_missions import open_station
from tests.groundstation.ui.map.plans import item
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.interop.mavsdk_process import ROOT, needed
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = [pytest.mark.e2e, needed]

WAYPOINTS = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t47.397742\t8.545594\t488\t1
1\t0\t3\t16\t0\t0\t0\t0\t47.3980\t8.5460\t10\t1
2\t0\t3\t16\t0\t0\t0\t0\t47.3985\t8.5465\t10\t1
"""
VEHICLE = "tests.interop.mavsdk_vehicle"
PARAMS = 300
"""Whole numbers; as many as make several datagrams of a list."""


class Vehicle:
    """The process, and what it reported."""

    def __init__(self, folder: Path) -> None:
        self.endpoint = f"127.0.0.1:{free_port()}"
        self.folder = folder
        self.reports: list[dict[str, Any]] = []
        with (folder / "mavsdk.log").open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", VEHICLE, f"udpout://{self.endpoint}", str(folder), str(PARAMS)],
                env={**os.environ, "PYTHONPATH": str(ROOT)},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                bufsize=0,  # what is in a buffer, select() does not see
            )

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()

    def wait_for(self, what: str) -> Any:
        """Return the value of the next report of this kind."""
        deadline = time.monotonic() + PATIENCE
        while True:
            found = next((report for report in self.reports if report["what"] == what), None)
            if found is not None:
                self.reports.remove(found)
                return found["value"]
            assert self.process.stdout is not None
            ready = select.select([self.process.stdout], [], [], max(0.0, deadline - time.monotonic()))
            assert ready[0], f"no {what!r} within {PATIENCE} s"
            self.reports.append(json.loads(self.process.stdout.readline()))


@pytest.fixture(scope="module")
def vehicle(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Vehicle]:
    made = Vehicle(tmp_path_factory.mktemp("mavsdk"))
    try:
        made.wait_for("ready")
        yield made
    finally:
        made.end()


@pytest.fixture
def verb(vehicle: Vehicle, capsys: pytest.CaptureFixture[str]) -> Callable[..., VerbRun]:
    """Return a function that runs a verb; it must succeed unless `code` says otherwise."""

    def run(*words: str, code: int = 0) -> VerbRun:
        done = run_verb(capsys, *words, "-e", f"udpin:{vehicle.endpoint}", "--wait", str(PATIENCE))
        assert done.code == code, done
        return done

    return run


def test_a_plan_of_the_map_screen(vehicle: Vehicle) -> None:
    with open_station(f"udpin:{vehicle.endpoint}") as station:
        ended = station.ask(UploadPlan(station.number(), 1, 0, (item(16, 5), item(16, 5, 5))))
        assert ended.state == "accepted", ended
        assert len(vehicle.wait_for("mission")) == 2
        station.ask(DownloadPlan(station.number(), 1, 0))
        station.until(lambda: len(station.copies.items.get(PlanKind.MISSION, ())) == 2)
        assert [each.x for each in station.copies.items[PlanKind.MISSION]] == [item(16, 5).x, item(16, 5, 5).x]


pytestmark.append(pytest.mark.xdist_group("mavsdk_vehicle"))


def test_all_its_parameters_are_read(verb: Callable[..., VerbRun]) -> None:
    lines = verb("param", "get", "*").out.splitlines()
    values = dict(line.split() for line in lines)
    assert len(values) == PARAMS + 1
    assert values["SPEED_MAX"] == "1.5"
    assert [int(values[f"TEST_{number:03}"]) for number in range(PARAMS)] == list(range(PARAMS)), "packed bytewise"


def test_its_parameters_are_set_by_their_type(vehicle: Vehicle, verb: Callable[..., VerbRun]) -> None:
    verb("param", "set", "SPEED_MAX", "2.5")
    assert vehicle.wait_for("float") == ["SPEED_MAX", 2.5]
    verb("param", "set", "TEST_007", "70")
    assert vehicle.wait_for("int") == ["TEST_007", 70]
    assert "cannot hold 1.5" in verb("param", "set", "TEST_008", "1.5", code=2).err
    assert "no such parameter" in verb("param", "set", "NOPE", "1", code=4).err
    verb("param", "set", "SPEED_MAX", "1.5")
    verb("param", "set", "TEST_007", "7")


def test_a_mission_travels_there_and_back(vehicle: Vehicle, verb: Callable[..., VerbRun]) -> None:
    """Its item 0 is the first waypoint and no home position, so that of the file stays here."""
    (vehicle.folder / "m.waypoints").write_text(WAYPOINTS)
    verb("mission", "put", str(vehicle.folder / "m.waypoints"))
    assert vehicle.wait_for("mission") == [[16, 473980000, 85460000], [16, 473985000, 85465000]]
    copy = vehicle.folder / "copy.plan"
    verb("mission", "get", str(copy))
    items = json.loads(copy.read_text())["mission"]["items"]
    assert [item["params"][4:6] for item in items] == [[47.398, 8.546], [47.3985, 8.5465]]
    verb("mission", "clear")
    vehicle.wait_for("clear")
    assert "no mission" in verb("mission", "show").err


def test_its_files_are_listed_and_read(vehicle: Vehicle, verb: Callable[..., VerbRun]) -> None:
    assert "hello.txt" in verb("ftp", "ls", "/").out
    verb("ftp", "get", "/hello.txt", str(vehicle.folder / "here.txt"))
    assert (vehicle.folder / "here.txt").read_text() == "from a vehicle of MAVSDK\n"
    verb("ftp", "get", "/none.txt", str(vehicle.folder / "none.txt"), code=4)
    assert not (vehicle.folder / "none.txt").exists()


def test_what_it_lacks_is_named(verb: Callable[..., VerbRun]) -> None:
    """It lists no modes, and its HEARTBEAT names no type whose modes are known."""
    assert "its type is not known" in verb("modes", code=7).err
    assert "lists no modes itself" in verb("mode", "HOLD", code=4).err
