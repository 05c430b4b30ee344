"""How many functions of ours one event calls, and in how many files: a key, a view, a snapshot, a message.

Counted in virtual time, so it is the same on every machine: a change of a figure is a change of the code.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import NamedTuple

from dialects.messages import Attitude
from groundstation.intents.driving import DriveKeyDown, SetStyle
from groundstation.intents.services import FetchParams
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm
from groundstation.station.station import Station
from groundstation.views.params import ParamPageRequest
from link.core import Received
from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Table
from tests.world import World
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.sim.body import SimulatedBody

ROOT = Path(__file__).parents[2]
PACKAGES = tuple(f"{ROOT}/{name}/" for name in ("dialects", "groundstation", "link", "vehicle"))
ROWS = 30
"""Parameters that a terminal of usual height shows."""
WALL = 1000.0
"""s by which the wall clock is ahead."""
LEASE = 0.1
"""s between two renewals of the screen's lease."""

INTENT, SEND, MOTORS = "key: intent to demand", "key: demand to frames", "key: frames to motors"
KEY_LIMIT, FILES_LIMIT, VIEW_LIMIT = 250, 40, 100


class Walk(NamedTuple):
    """The calls of one event, and the files that they are in."""

    calls: int
    files: frozenset[str]


def run(options: Options) -> Report:
    """Count the calls of each walk."""
    drive = Drive()
    walks = {**_key(drive), **_views(drive)}
    rows: list[Row] = [{"walk": name, "calls": each.calls, "files": len(each.files)} for name, each in walks.items()]
    key = [walks[INTENT], walks[SEND]]
    goals = [
        Goal("key in the station", sum(each.calls for each in key), KEY_LIMIT, "calls"),
        Goal("key in the station", len(key[0].files | key[1].files), FILES_LIMIT, "files"),
        Goal("view of parameters, nothing changed", walks["view of 30 parameters, again"].calls, VIEW_LIMIT, "calls"),
    ]
    return Report([Table("Calls of one event", rows)], goals)


def walk(work: Callable[[], object], names: Counter[str] | None = None) -> Walk:
    """Count the calls of our packages that `work` makes; `names` gets file and function of each."""
    calls, files = 0, set[str]()

    def note(frame: FrameType, event: str, _: object) -> None:
        nonlocal calls
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(PACKAGES):
            calls += 1
            files.add(code.co_filename)
            if names is not None:
                names[f"{code.co_filename.removeprefix(f'{ROOT}/')} {code.co_qualname}"] += 1

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return Walk(calls, frozenset(files))


class Drive:
    """A station and a simulated rover in virtual time. It is armed, its parameters are known, and a key drives it."""

    def __init__(self) -> None:
        self.station = Station(["memory"], session=7, now=100.0)
        motors = self.motors = SimulatedMotors()
        rover = Rover(Params({}), now=100.0)
        self.rover = ControlLoop(rover, motors, SimulatedBody(lambda: motors.outputs))
        self.world = World(self.station, self.rover)
        self._key: str | None = None
        self._due = 0.0
        self.tell(RenewLease(), SetStyle("hold"), SetKeyGate(open=True))
        self.run(3.0)
        self.tell(FetchParams(1))
        self.run(10.0)
        self.tell(Arm(held=1.0))
        self.run(3.0)
        self._key = "i"
        self.run(1.06)  # not just at the end of a second, which statistics of messages have
        if not any(motors.outputs):
            raise BenchmarkError("the wheels did not turn, so these are not the calls of a drive")

    def tell(self, *intents: AnyIntent) -> None:
        """Handle intents now, and send what they cause."""
        for intent in intents:
            self.station.handle_intent(intent, self.world.now)
        self.world.settle()

    def run(self, seconds: float) -> None:
        """Let time pass with a screen that renews its lease and a key that repeats."""
        self.world.run(seconds, self._each)

    def _each(self, now: float) -> None:
        if now >= self._due:
            self._due = now + LEASE
            self.station.renew_lease(now)
            if self._key is not None:
                self.station.handle_intent(DriveKeyDown(self._key, 1, 0), now)


def _key(drive: Drive) -> dict[str, Walk]:
    """Press a key that changes the demand, and follow it to the motors."""
    station, world, now = drive.station, drive.world, drive.world.now
    frames: list[bytes] = []
    before = tuple(drive.motors.outputs)

    def deliver() -> None:
        for frame in frames:
            world.far.receive(frame, "near", now)

    walks = {
        INTENT: walk(lambda: station.handle_intent(DriveKeyDown("u", 1, -1), now)),
        SEND: walk(lambda: frames.extend(world.near.pop_frames(now, "far"))),
        MOTORS: walk(deliver),
    }
    if not frames or tuple(drive.motors.outputs) == before:
        raise BenchmarkError("the key did not reach the motors")
    return walks


def _views(drive: Drive) -> dict[str, Walk]:
    """Take what the screen shows, and the message that comes most often."""
    station, now = drive.station, drive.world.now
    request = ParamPageRequest(rows=ROWS)
    attitude = Attitude(int(now * 1000), 0.1, 0.1, 0.1, 0, 0, 0)
    peer = next(iter(drive.world.near.channel.report(now=now).audience))

    def page() -> object:
        return station.views.build(request, now, now + WALL)

    return {
        "view of 30 parameters": walk(page),
        "view of 30 parameters, again": walk(page),
        "snapshot": walk(lambda: station.snapshot(now, now + WALL)),
        "ATTITUDE": walk(lambda: station.receive(Received(attitude, 1, 1, 0, peer, introduced=True), now)),
    }
