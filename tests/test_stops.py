"""The stop matrix in virtual time: station and vehicle joined through pipes that delay, lose and cut.

Here the bounds of docs/safety.md hold to the millisecond. Each test first sees the wheels turn.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects.messages import SetPositionTargetLocalNed
from dialects.modes import Mode
from groundstation.intents.driving import ClearEmergencyStop, DriveKeyDown, EmergencyStop, SetStyle, Stop
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, Disarm, SetMode
from groundstation.station.station import Station
from link.core import Outgoing
from link.transport.memory import LossyPipe
from tests.examples import examples
from tests.world import World
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody, SimulatedHome
from vehicle.sim.chassis import ChassisDimensions, SkidChassis

FALLS_WITHIN = 0.5
NEUTRAL_WITHIN = 1.0
AHEAD_IN_GUIDED = SetPositionTargetLocalNed(0, 1, 1, 8, 1479, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0)
"""1 m/s forward, as a Twist of ROS (body frame; position, acceleration and yaw ignored)."""
REPEAT = 0.04
"""s between the auto-repeats of a held key."""


class Drive:
    """An operator with keys, a station, a link and a simulated rover."""

    def __init__(
        self, *, loss: float = 0.0, delay: float = 0.0, seed: int = 0, style: str = "hold", session: int = 0
    ) -> None:
        """`session`: number of the station's operator session, which bounds the age of its demands; 0 for none."""
        start = 100.0
        self.station = Station(["memory"], now=start, session=session)
        self.motors, self.battery = SimulatedMotors(), Battery(1.0)
        params = self.params = Params({})
        self.rover = Rover(params, now=start)
        body = SimulatedBody(
            lambda: self.motors.outputs,
            chassis=SkidChassis(ChassisDimensions(top_speed=params["SPEED_MAX"], track_width=params["TRACK_WIDTH"])),
            battery=self.battery,
            home=SimulatedHome(),
            seed=None,
        )
        self.world = World(
            self.station,
            ControlLoop(self.rover, self.motors, body),
            up=LossyPipe[bytes](loss=loss, delay=delay, seed=seed),
            down=LossyPipe[bytes](loss=loss, delay=delay, seed=seed + 1),
            now=start,
        )
        self.held: str | None = None
        self.repeat = REPEAT
        self.screen_lives = True
        self.moved: list[tuple[float, float]] = []
        self._key_due = self._lease_due = 0.0
        self.tell(SetStyle(style), SetKeyGate(True))

    @property
    def power(self) -> float:
        """The largest motor output now."""
        return max(map(abs, self.motors.outputs), default=0.0)

    def tell(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.station.handle_intent(intent, self.world.now)
        self.world.settle()

    def run(self, seconds: float) -> None:
        self.world.run(seconds, self._each)

    def until(self, condition: Callable[[], bool], within: float = 10.0) -> float:
        start = self.world.now
        while not condition():
            assert self.world.now - start < within, f"not within {within} s"
            self.run(self.world.step)
        return self.world.now - start

    def _each(self, now: float) -> None:
        if self.screen_lives and now >= self._lease_due:
            self._lease_due = now + 0.1
            self.station.handle_intent(RenewLease(), now)
        if self.screen_lives and self.held and now >= self._key_due:
            self._key_due = now + self.repeat
            self.station.handle_intent(DriveKeyDown(self.held, 1, 0), now)
        self.moved.append((now, self.power))

    def get_going(self) -> None:
        """Arm, press the key once the station shows that, and wait until the wheels turn at the full demand."""
        self.until(lambda: self.station.snapshot(self.world.now, 0).vehicle is not None)
        self.run(2.0)
        self.tell(Arm(held=1.0))
        self.until(lambda: self.rover.state is SafetyState.ARMED)
        # A key that is held from before the station knows that does not count.
        self.until(lambda: any(contact.state.armed for contact in self.station.fleet))
        self.run(1.5)
        self.held = "i"
        self.until(lambda: self.power > 0.5)
        assert self.rover.outputs.enabled

    def assert_stops(
        self, since: float, *, falls: float = FALLS_WITHIN, neutral: float = NEUTRAL_WITHIN, stays: float = 5.0
    ) -> None:
        """Check that from `since` the outputs fall and become neutral in time, and stay neutral for `stays` s."""
        power = self.power
        assert power > 0.5, "the wheels must turn, or there is nothing to stop"
        self.until(lambda: self.power < power, within=falls - (self.world.now - since) + self.world.step)
        self.until(lambda: self.power == 0.0, within=neutral - (self.world.now - since) + self.world.step)
        self.moved.clear()
        self.run(stays)
        assert max(power for _, power in self.moved) == 0.0


def test_key_released() -> None:
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.assert_stops(drive.world.now)


def test_stop_key() -> None:
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.tell(Stop())
    drive.assert_stops(drive.world.now, falls=0.05, neutral=0.5)


def test_latched_drive_goes_on_and_ends_with_the_stop_key() -> None:
    drive = Drive(style="latch")
    drive.get_going()
    drive.held = None
    drive.run(3.0)
    assert drive.power > 0.5
    drive.tell(Stop())
    drive.assert_stops(drive.world.now, falls=0.05, neutral=0.5)


@pytest.mark.parametrize("style", ["hold", "latch"])
def test_frozen_screen(style: str) -> None:
    drive = Drive(style=style)
    drive.get_going()
    drive.screen_lives = False
    drive.assert_stops(drive.world.now)


@pytest.mark.parametrize("style", ["hold", "latch"])
def test_closed_gate(style: str) -> None:
    drive = Drive(style=style)
    drive.get_going()
    drive.tell(SetKeyGate(False, "help is open"))
    drive.assert_stops(drive.world.now, falls=0.05, neutral=0.5)


@pytest.mark.parametrize("style", ["hold", "latch"])
@pytest.mark.parametrize(("away", "gap"), [(0.05, 0.04), (0.5, 0.04), (3.0, 0.04), (0.05, 0.7), (0.5, 0.7), (3.0, 0.7)])
def test_a_key_held_over_another_screen_never_drives(style: str, away: float, gap: float) -> None:
    """Without reported releases. A gap of 0.7 s between repeats is a slow keyboard, or a line that stalls."""
    drive = Drive(style=style)
    drive.get_going()
    drive.tell(SetKeyGate(False, "another screen is open"))
    drive.repeat = gap
    drive.run(away)
    drive.tell(SetKeyGate(True))
    drive.until(lambda: drive.power == 0.0, within=NEUTRAL_WITHIN)
    drive.moved.clear()
    drive.run(5.0)
    assert drive.held
    assert max(power for _, power in drive.moved) == 0.0
    assert drive.station.snapshot(drive.world.now, 0).operator.held_over
    drive.held = None
    drive.run(0.76)
    drive.tell(SetMode("MANUAL"))  # 1.5 s without a demand are HOLD
    drive.run(0.5)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.1)


@pytest.mark.parametrize("style", ["hold", "latch"])
def test_killed_or_frozen_ground_station(style: str) -> None:
    drive = Drive(style=style)
    drive.get_going()
    drive.world.near.frozen = True
    drive.assert_stops(drive.world.now)


@pytest.mark.parametrize("style", ["hold", "latch"])
@pytest.mark.parametrize("seconds", [0.6, 1.2, 1.8, 2.5, 4.0, 10.0, 90.0])
def test_link_cut_and_back(style: str, seconds: float) -> None:
    """However long the cut, nothing moves afterwards until the key was released and, after HOLD, MANUAL selected."""
    drive = Drive(style=style)
    drive.get_going()
    drive.world.cut()
    drive.until(lambda: drive.power == 0.0, within=NEUTRAL_WITHIN)
    drive.moved.clear()
    drive.run(seconds)
    drive.world.cut(False)
    drive.run(5.0)
    assert max(power for _, power in drive.moved) == 0.0


def test_after_a_cut_the_driver_can_go_on() -> None:
    drive = Drive()
    drive.get_going()
    drive.world.cut()
    drive.run(10.0)
    drive.world.cut(False)
    drive.run(2.0)
    drive.held = None
    drive.run(1.0)
    drive.tell(SetMode(Mode.MANUAL.name))
    drive.run(1.0)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.5, within=2.0)


def test_a_hiccup_needs_the_key_let_go_once() -> None:
    drive = Drive()
    drive.get_going()
    drive.world.cut()
    drive.run(1.0)
    assert drive.power == 0.0
    drive.world.cut(False)
    drive.run(1.0)
    assert drive.power == 0.0
    drive.held = None
    drive.run(1.5)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.5, within=2.0)


@pytest.mark.slow
def test_ten_percent_loss_for_ten_minutes_drives_on() -> None:
    drive = Drive(loss=0.10, delay=0.010, seed=5)
    drive.get_going()
    drive.moved.clear()
    drive.run(600.0)  # demands that become stale too early have ended such a drive only after 400 s
    driving = sum(power > 0.5 for _, power in drive.moved) / len(drive.moved)
    assert driving > 0.99


@settings(max_examples=examples(15))
@given(st.integers(0, 10_000))
@pytest.mark.slow
def test_thirty_percent_loss_never_moves_late(seed: int) -> None:
    drive = Drive(loss=0.30, delay=0.010, seed=seed)
    drive.until(lambda: drive.station.snapshot(drive.world.now, 0).vehicle is not None)
    turned = 0.0
    for _ in range(3):
        drive.tell(Arm(held=1.0))
        drive.run(2.0)
        drive.held = "i"
        drive.run(3.0)
        drive.held = None
        drive.run(0.25 + NEUTRAL_WITHIN + 0.05)
        turned = max(turned, *(power for _, power in drive.moved))
        drive.moved.clear()
        drive.run(1.0)
        assert max(power for _, power in drive.moved) == 0.0
    assert turned > 0.0


def test_emergency_stop_is_at_once_and_stays() -> None:
    drive = Drive()
    drive.get_going()
    drive.tell(EmergencyStop())
    drive.assert_stops(drive.world.now, falls=0.05, neutral=0.05)
    assert drive.rover.state is SafetyState.ESTOP
    drive.tell(Arm(held=1.0))
    drive.run(3.0)
    assert drive.rover.state is SafetyState.ESTOP
    drive.held = None
    drive.tell(ClearEmergencyStop(held=1.0))
    drive.run(2.0)
    drive.get_going()


def test_the_stop_key_stops_a_rover_that_drives_itself() -> None:
    """Neutral sticks do not stop a mission, so the key has to mean HOLD there. A closed gate does not: the mission
    continues."""
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.run(2.0)
    drive.tell(SetMode(Mode.GUIDED.name))
    drive.run(1.0)
    for _ in range(100):
        drive.station._outbox.commands.append(Outgoing(AHEAD_IN_GUIDED))
        drive.run(0.05)
    assert drive.power > 0.2
    drive.tell(SetKeyGate(False, "help is open"), Stop("help is open"))
    drive.station._outbox.commands.append(Outgoing(AHEAD_IN_GUIDED))
    drive.run(0.2)
    assert drive.power > 0.1
    drive.tell(SetKeyGate(True), Stop())
    drive.until(lambda: drive.power == 0.0, within=NEUTRAL_WITHIN)
    drive.run(0.5)
    vehicle = drive.station.snapshot(drive.world.now, 0).vehicle
    assert vehicle is not None
    assert vehicle.mode == Mode.HOLD.name


def test_disarm_is_at_once() -> None:
    drive = Drive()
    drive.get_going()
    drive.tell(Disarm())
    drive.assert_stops(drive.world.now, falls=0.05, neutral=0.05)


@pytest.mark.parametrize("wait", [0.0, 0.05, 0.2])
def test_a_key_pressed_right_after_arming_drives(wait: float) -> None:
    """The vehicle needs a neutral demand first; the station sends it before it lets the first key through."""
    drive = Drive()
    drive.run(2.0)
    drive.tell(Arm(held=1.0))
    drive.until(lambda: drive.station.snapshot(drive.world.now, 0).operator.gate_open)
    drive.run(wait)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.5, within=1.0)


def test_arming_with_a_key_held_does_not_drive_off() -> None:
    drive = Drive()
    drive.run(2.0)
    drive.held = "i"
    drive.run(1.0)
    drive.tell(Arm(held=1.0))
    drive.run(5.0)
    assert drive.rover.state is SafetyState.ARMED
    assert max(power for _, power in drive.moved) == 0.0
    drive.held = None
    drive.run(1.0)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.5)
