"""FRESH_DIST: the rover never drives farther than that after the newest command was sent, on any link and slope."""

from __future__ import annotations

import heapq
import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import DriveLimit
from dialects.modes import Mode
from tests.examples import examples
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL
from tests.vehicle.drive.test_operator_session import Station
from tests.vehicle.field import Field
from vehicle.sim.body import Slope

PERIOD = 0.05


class FarStation:
    """A station whose demands arrive late or not at all, and which sees the rover as late."""

    def __init__(self, field: Field, *, delay: float = 0.0, loss: float = 0.0, seed: int = 0) -> None:
        self.field = field
        self.delay, self.loss = delay, loss
        self.station = Station(field)
        self.sent_at: float | None = None
        """When the newest demand for motion that the rover has taken was sent."""
        self.farthest = 0.0
        """The most that the rover has driven since then, m."""
        self._random = random.Random(seed)
        self._way: list[tuple[float, int, float, m.Message]] = []
        self._count = itertools.count()
        self._driven = [(field.now, 0.0)]

    def drive(self, seconds: float, axes: Axes | None) -> None:
        """Let time pass with a stick at `axes`, or with a station that sends nothing any more."""
        end, due = self.field.now + seconds, self.field.now
        while self.field.now < end - 1e-9:
            if axes is not None and self.field.now >= due - 1e-9:
                due += PERIOD
                self._send(axes)
            self._deliver()
            self.field.wait(CYCLE)
            self._measure()

    def _send(self, axes: Axes) -> None:
        seen = self._random.uniform(0.0, 0.2)  # ROVER_DRIVE_STATUS comes at 5 Hz
        proof = self.station.build(axes, echo_age=self.delay / 2 + seen)
        if self._random.random() >= self.loss:
            arrives = self.field.now + self.delay / 2
            heapq.heappush(self._way, (arrives, next(self._count), self.field.now, proof))

    def _deliver(self) -> None:
        while self._way and self._way[0][0] <= self.field.now + 1e-9:
            _, _, built, proof = heapq.heappop(self._way)
            before = self.field.rover._control.demand
            self.field.say(proof, address=self.station.address)
            demand = self.field.rover._control.demand
            if demand is not before and demand is not None and demand.requests_motion(0.03):
                self.sent_at = built

    def _measure(self) -> None:
        at, driven = self._driven[-1]
        self._driven.append((self.field.now, driven + abs(self.field.speed) * (self.field.now - at)))
        if self.sent_at is None:
            return
        then = next(way for at, way in reversed(self._driven) if at <= self.sent_at + 1e-9)
        self.farthest = max(self.farthest, self._driven[-1][1] - then)


def started(far: FarStation) -> None:
    """Armed, with a neutral demand shown over a link that is still good."""
    delay, loss, far.delay, far.loss = far.delay, far.loss, 0.0, 0.0
    far.station.send(None)
    far.field.arm()
    far.drive(0.3, NEUTRAL)
    far.delay, far.loss = delay, loss


@pytest.mark.slow
@given(
    seed=st.integers(0, 2**16),
    delay=st.floats(0.0, 1.0),
    loss=st.floats(0.0, 0.3),
    speed=st.floats(0.5, 8.0),
    room=st.floats(0.3, 3.0),
    push=st.floats(-0.25, 0.25),
    throttle=st.sampled_from((1.0, -1.0, 0.6)),
    kind=st.sampled_from((1, 2, 4)),
    limits=st.sampled_from((0.45, 2.0)),
)
@settings(max_examples=examples(30), deadline=None)
def test_the_distance_after_the_last_command_is_kept(
    seed: int, delay: float, loss: float, speed: float, room: float, push: float, throttle: float, kind: int,
    limits: float,
) -> None:  # fmt: skip
    field = Field(seed, slope=Slope(push * speed), SPEED_MAX=speed, FRESH_DIST=room, DRIVE_TYPE=kind, FS_CRASH_CHECK=0,
                  OPR_ECHO_MAX=limits, MAN_TIMEOUT=limits)  # fmt: skip
    far = FarStation(field, delay=delay, loss=loss, seed=seed)
    started(far)
    far.drive(1.0 + 1.5 * far._random.random(), Axes(throttle))
    if delay + 0.35 < limits:
        assert far.sent_at is not None, "no demand was taken"
        assert far.farthest > 0.0, "the rover did not move"
    far.drive(3.0, None)
    assert abs(field.speed) < 0.05
    assert far.farthest <= room, (far.farthest, room)


def test_late_commands_slow_the_rover_down() -> None:
    speeds = []
    for delay in (0.0, 0.1, 0.2):
        field = Field(SPEED_MAX=4.0, FRESH_DIST=2.0)
        far = FarStation(field, delay=delay)
        started(far)
        far.drive(3.0, AHEAD)
        speeds.append(field.speed)
        status = field.newest(m.RoverDriveStatus)
        assert status.limits & DriveLimit.FRESHNESS
        assert 0.5 < status.speed_limit / 100 < 4.0
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[0] > speeds[-1] + 0.3


@pytest.mark.parametrize(("speed", "room", "limited"), [(1.5, 2.0, False), (6.0, 2.0, True), (6.0, 0.0, False)])
def test_a_slow_rover_is_not_limited_and_0_is_off(speed: float, room: float, limited: bool) -> None:
    field = Field(SPEED_MAX=speed, FRESH_DIST=room)
    far = FarStation(field)
    started(far)
    far.drive(3.0, AHEAD)
    assert field.speed > 1.3
    assert bool(field.newest(m.RoverDriveStatus).limits & DriveLimit.FRESHNESS) is limited
    assert bool(field.newest(m.RoverDriveStatus).speed_limit) is limited


def test_setpoints_that_end_are_bound_too() -> None:
    field = Field(SPEED_MAX=3.0, WP_SPEED=3.0, FRESH_DIST=1.5, GUIDED_TIMEOUT=1.0)
    field.begin(Mode.GUIDED)
    field.stream(3.0, 3.0)
    assert field.speed > 1.0
    assert field.newest(m.RoverDriveStatus).limits & DriveLimit.FRESHNESS
    field.twist(3.0)
    start = field.truth
    field.beat(4.0)
    assert 0.3 < field.truth.distance(start) <= 1.5
