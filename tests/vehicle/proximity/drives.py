"""Random drives among walls: the vehicle's own limits and last gate, the simulator's motion, and its truth.

`python -m tests.vehicle.proximity.drives 10000` runs so many of them, and says how near they came to a wall.
"""

from __future__ import annotations

import math
import random
import sys
import time
from typing import NamedTuple

from dialects.enums import DriveType
from tests.vehicle.bench import CYCLE
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Clearance
from vehicle.navigation.geo import Point
from vehicle.params import Params
from vehicle.proximity.obstacles import Obstacles
from vehicle.sim.chassis import CHASSIS, ChassisDimensions
from vehicle.sim.walls import Segment, SimulatedLidar, Walls

LENGTH, WIDTH = 0.4, 0.4
DURATION = 4.0
SECTORS = 36
MARGIN = 0.15
"""m: half of AVOID_MARGIN; nearer than this the truth is looked at in each cycle."""
FARS = (1.2, 3.0, 8.0, 8.0)
"""m that the sensors see."""
CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.0, timeout=0.45)


class Outcome(NamedTuple):
    """What a drive came to."""

    clearance: float
    """Smallest distance to a wall in the simulator's truth, m."""
    driven: float
    """m."""
    speed: float
    """SPEED_MAX."""


def random_walls(chance: random.Random) -> list[Segment]:
    """A room with the rover in its middle, and a few walls in it that leave the rover its place."""
    size = chance.uniform(2.0, 5.0)
    corners = [Point(size, size), Point(size, -size), Point(-size, -size), Point(-size, size)]
    walls = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    while len(walls) < 8:
        north, east = chance.uniform(-size, size), chance.uniform(-size, size)
        course, length = chance.uniform(0.0, math.tau), chance.uniform(0.05, 2.5)
        wall = Point(north, east), Point(north + length * math.cos(course), east + length * math.sin(course))
        if min(Walls([wall]).scan(Point(0.0, 0.0), 0.0, 8)) > 0.8:
            walls.append(wall)
    return walls


def drive(seed: int, *, avoid: bool = True) -> Outcome:
    """Drive at random for DURATION, with noise, dropouts, and in every third drive a sensor that dies on the way."""
    chance = random.Random(seed)
    kind = chance.choice((DriveType.SKID, DriveType.ACKERMANN, DriveType.MECANUM))
    speed = chance.uniform(0.5, 3.0)
    params = Params({"DRIVE_TYPE": kind, "SPEED_MAX": speed, "AVOID_LOST_SPD": 0.0,
                     "ATC_STR_RAT_FF": 0.35 / speed})  # fmt: skip
    frame = ChassisDimensions(top_speed=speed)
    chassis, rover, obstacles = CHASSIS[kind](frame), Drive(params, 0.0), Obstacles(params, kind)
    walls = Walls(random_walls(chance))
    dropouts, far = chance.uniform(0.0, 0.2), FARS[seed % len(FARS)]
    lidar = SimulatedLidar(walls, seed, sectors=SECTORS, dropouts=dropouts, far=far)
    dies = chance.uniform(1.0, DURATION) if seed % 3 == 0 else math.inf
    look = 0.0
    nearest, driven, until, demand = math.inf, 0.0, 0.0, Demand(0.0, 0.0, 0.0, 255, 0, 0.0)
    for cycle in range(1, round(DURATION / CYCLE)):
        now = cycle * CYCLE
        if now >= until:
            until = now + chance.uniform(0.2, 2.0)
            throttle, steering, aside = (chance.choice((-1.0, 0.0, 1.0, chance.uniform(-1, 1))) for _ in range(3))
            demand = Demand(throttle, steering, now, 255, 0, aside if kind is DriveType.MECANUM else None)
        motion = chassis.motion
        if now < dies:
            obstacles.sense([lidar.read(motion, now)])
        turn = motion.yaw_rate + chance.gauss(0.0, 0.01)
        noise = chance.gauss(0.0, 0.02) if motion.speed else 0.0
        obstacles.move(rover.wheels, motion.speed + noise, turn, now, CYCLE, armed=True)
        rover.update(demand, CLEARED, limited=False, now=now, avoid=obstacles.share if avoid else None)
        chassis.step(rover.outputs.throttles, 1.0, CYCLE)
        driven += math.hypot(motion.speed, motion.sideways) * CYCLE
        if now >= look:
            clearance = walls.clearance(motion, LENGTH, WIDTH)
            nearest = min(nearest, clearance)
            look = now + max(0.0, clearance - MARGIN) / (3.0 * speed)  # until then no corner can be nearer than MARGIN
        if nearest == 0.0:
            break
    return Outcome(nearest, driven, speed)


def main(count: int, first: int = 0) -> None:
    """Run `count` drives and print what they came to."""
    began = time.monotonic()
    outcomes = {seed: drive(seed) for seed in range(first, first + count)}
    touched = [seed for seed, each in outcomes.items() if each.clearance <= 0.0]
    nearest = sorted(each.clearance for each in outcomes.values())
    way = sum(each.driven for each in outcomes.values())
    sys.stdout.write(
        f"{count} drives, {way:.0f} m in {time.monotonic() - began:.0f} s: {len(touched)} contacts {touched[:10]}, "
        f"nearest {nearest[0]:.3f} m, 1 % {nearest[count // 100]:.3f} m, median {nearest[count // 2]:.3f} m\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
