"""Ten minutes of AUTO in real time with noisy sensors: the distance of the simulator's truth from the lines.

`python -m vehicle --sim` as a process gets laps of a course over UDP from our own MissionClient, and records its true
position (`--sim-truth`), which none of its sensors knows.
"""

from __future__ import annotations

import asyncio
import math
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from dialects import messages as m
from dialects.enums import Command, MissionType
from dialects.modes import Mode
from link.services.mission.items import MissionItem
from tests.benchmarks.figures import Goal, Options, Report, Row, Table, quantile
from tests.benchmarks.programs import free_port, on_pipe, python, scratch
from tests.benchmarks.station import Station, connected
from tests.benchmarks.watch import Watch
from vehicle.navigation.geo import Origin, Point
from vehicle.navigation.guidance import Leg

HOME = Origin(50.0, 8.0)
RELATIVE_ALTITUDE, NO_PLACE = 6, 2
"""MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, MAV_FRAME_MISSION."""
CORNER = 1.5
"""m around a corner that are not measured: the rover may cut the corner (WP_RADIUS) or pivot there."""
LAP_MAX = 300.0
"""s that a lap may take."""


@dataclass(frozen=True, slots=True)
class Course:
    """Laps around corners; the last one is where it starts."""

    corners: tuple[Point, ...]
    laps: int
    before: float
    """s at rest before the start, as long as a driver takes to upload and arm."""

    @property
    def legs(self) -> list[Leg]:
        """Return the straight lines of a lap."""
        return [Leg(one, two) for one, two in pairwise((self.corners[-1], *self.corners))]


FULL = Course((Point(40, 0), Point(40, 25), Point(10, 30), Point(0, 0)), laps=4, before=30.0)
"""127 m a lap: ten minutes at 0.8 m/s."""
QUICK = Course((Point(8, 0), Point(8, 8), Point(0, 0)), laps=1, before=5.0)

GOAL = 0.5
"""m"""


def run(options: Options) -> Report:
    """Measure seed by seed."""
    course = QUICK if options.quick else FULL
    rows = []
    for seed in options.seeds:
        options.say(f"mission: seed {seed}, {course.laps} laps")
        rows.append(_drive(course, seed))
    title = "AUTO in real time: how far the rover really is beside the line, m"
    note = (
        f"The truth of the simulator ten times a second, {CORNER:g} m and more from the corners. "
        "Sensors as in vehicle/sim/noise.py; the GPS alone wanders 0.2 m."
    )
    if options.quick:
        note += " Quick: one short lap, before compass and wheels are learned."
    goals = [Goal(f"beside the line, seed {row['seed']}, max", row["max"], GOAL, "m") for row in rows]
    return Report([Table(title, rows, note)], goals)


def _drive(course: Course, seed: int) -> Row:
    with scratch() as folder, closing(Watch()) as watch:
        truth, port = folder / "truth", free_port()
        words = ["--sim", f"udpin:127.0.0.1:{port}", "--home", f"{HOME.latitude},{HOME.longitude}"]
        vehicle = on_pipe(watch, python("vehicle", *words, "--sim-seed", str(seed), "--sim-truth", str(truth)))
        try:
            vehicle.wait_for("ready", 20)
            asyncio.run(connected(f"udpout:127.0.0.1:{port}", lambda station: _script(station, course)))
        finally:
            vehicle.end()
        return {"seed": seed} | _judged(course, truth)


async def _script(station: Station, course: Course) -> None:
    items = [_way(corner) for corner in course.corners]
    if course.laps > 1:
        items.append(MissionItem(Command.DO_JUMP, NO_PLACE, (0.0, course.laps - 1.0, 0.0, 0.0), 0, 0, 0.0))
    now = asyncio.get_running_loop().time()
    station.missions.upload(items, MissionType.MISSION, now)
    await station.until(lambda: not station.missions.busy, "the mission is uploaded", 20)
    await asyncio.sleep(course.before)
    await station.arm()
    await station.command(Command.MISSION_START)
    await station.until(lambda: _mode(station) == Mode.AUTO, "AUTO", 10)
    await station.until(
        lambda: any("mission complete" in text for text in station.texts),
        "the mission is complete",
        LAP_MAX * course.laps,
    )


def _mode(station: Station) -> int | None:
    beat = station.newest.get(m.Heartbeat.id)
    return beat.custom_mode if isinstance(beat, m.Heartbeat) else None


def _way(place: Point) -> MissionItem:
    latitude, longitude = HOME.to_global(place)
    params = (0.0, 0.0, 0.0, 0.0)
    return MissionItem(
        Command.NAV_WAYPOINT, RELATIVE_ALTITUDE, params, round(latitude * 1e7), round(longitude * 1e7), 0.0
    )


def _judged(course: Course, truth: Path) -> Row:
    """Evaluate the truth file on the straight lines, while the rover moves from start to end."""
    rows = [[float(word) for word in line.split()] for line in truth.read_text().splitlines()]
    moving = [index for index, row in enumerate(rows) if row[4]]
    on_the_way = rows[moving[0] : moving[-1] + 1]
    beside = sorted(
        _beside(course, place)
        for place in (Point(north, east) for _, north, east, *_ in on_the_way)
        if all(corner.distance(place) >= CORNER for corner in course.corners)
    )
    return {
        "minutes": (on_the_way[-1][0] - on_the_way[0][0]) / 60e9,
        "places": len(beside),
        "rms": math.sqrt(sum(each * each for each in beside) / len(beside)),
        "p50": quantile(beside, 0.5),
        "p99": quantile(beside, 0.99),
        "max": beside[-1],
    }


def _beside(course: Course, place: Point) -> float:
    """Return the distance from the nearest straight line, m."""
    return min(_from_leg(leg, place) for leg in course.legs)


def _from_leg(leg: Leg, place: Point) -> float:
    remaining, beside = leg.along_and_cross_track(place)
    if 0.0 <= remaining <= leg.start.distance(leg.end):
        return abs(beside)
    return min(leg.start.distance(place), leg.end.distance(place))
