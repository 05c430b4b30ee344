"""Failsafe conditions: which facts make each, and from when it counts."""

from __future__ import annotations

import math

import pytest

from dialects.axes import Axes, build_manual_control
from dialects.enums import Failsafe
from dialects.messages import RoverOperatorPresence
from dialects.modes import Mode
from link.core import Peer, Received
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, said
from tests.vehicle.conversations import conversation
from tests.vehicle.field import Field
from tests.vehicle.safety.rig import STANDING, START
from vehicle.drive.control import Control
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params
from vehicle.readings import ComputerReadings, Readings
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.failsafe import BLOCKED_SPEED_MAX, BLOCKED_THROTTLE_MIN, RULES
from vehicle.safety.failsafe_inputs import FailsafeInputs, MotionInputs
from vehicle.safety.pi_monitor import PiMonitor
from vehicle.statustext import StatusTextQueue

TIMES = {"MAN_TIMEOUT": 0.5, "FS_TIMEOUT": 1.5, "FS_GCS_TIMEOUT": 5.0, "OPR_TIMEOUT": 10.0}


class Scene:
    """An armed vehicle in MANUAL with a driver in control, at START."""

    def __init__(self, **params: float) -> None:
        self.params = Params(TIMES | params)
        texts = StatusTextQueue()
        self.control = Control(self.params, texts, system=1, boot=0.0)
        self.control.take(conversation(DRIVER), START)
        self.battery = BatteryMonitor(self.params)
        self.computer = PiMonitor(self.params, texts)
        self.sequence = 0

    def stick(self, axes: Axes, now: float) -> None:
        self.sequence += 1
        message = build_manual_control(axes, 1)
        received = Received(message, DRIVER, 190, self.sequence, Peer(0, "gcs"), introduced=True)
        self.control.hear(received, now)
        assert self.control.handle_manual_control(received, message, now)

    def presence(self, now: float, age_ms: int = 0) -> None:
        message = RoverOperatorPresence(1, 1, 0, 0, 1, 1, age_ms, 1)
        received = Received(message, DRIVER, 190, 0, Peer(0, "gcs"), introduced=True)
        self.control.handle_operator_presence(received, message, now)

    def inputs(self, **facts: object) -> FailsafeInputs:
        """In MANUAL, at rest, armed at START, with `facts` in place."""
        inputs = FailsafeInputs(
            self.params, self.control, self.battery, self.computer, STANDING,
            manual=True, mission_running=False, latched=Failsafe(0), armed_at=START,
        )  # fmt: skip
        return inputs._replace(**facts)  # type: ignore[arg-type]

    def found(self, now: float, **facts: object) -> dict[Failsafe, float]:
        """The conditions that hold, each with its begin."""
        inputs = self.inputs(**facts)
        began = {cause: rule.condition(inputs, now) for cause, rule in RULES.items()}
        return {cause: at for cause, at in began.items() if at is not None}


def test_nothing_is_wrong_without_a_demand_and_shortly_after_one() -> None:
    scene = Scene()
    assert scene.found(START + 4.9) == {}
    scene.stick(AHEAD, START + 4.9)
    assert scene.found(START + 5.4) == {}


def test_a_demand_for_motion_is_lost_when_it_is_too_old() -> None:
    scene = Scene()
    scene.stick(AHEAD, START)
    assert scene.found(START + 0.5) == {}
    assert scene.found(START + 0.51) == {Failsafe.MANUAL_LOSS: START + 0.5}
    assert scene.found(START + 3.0) == {Failsafe.MANUAL_LOSS: START + 0.5}


def test_a_neutral_demand_is_lost_when_hold_is_due() -> None:
    scene = Scene()
    scene.stick(NEUTRAL, START)
    assert scene.found(START + 1.99) == {}
    assert scene.found(START + 2.0) == {Failsafe.MANUAL_LOSS: START + 0.5}


def test_lost_demand_counts_in_a_mode_that_obeys_or_ended_by_it() -> None:
    scene = Scene()
    scene.stick(AHEAD, START)
    lost = {Failsafe.MANUAL_LOSS: START + 0.5}
    assert scene.found(START + 2.0, manual=False) == {}
    assert scene.found(START + 2.0, manual=False, latched=Failsafe.MANUAL_LOSS) == lost
    assert scene.found(START + 2.0, manual=False, latched=Failsafe.GCS_LOSS) == {}
    assert scene.found(START + 2.0, manual=True, latched=Failsafe.GCS_LOSS) == lost


@pytest.mark.parametrize(
    ("setting", "alone", "lost"), [(0, False, False), (0, True, False), (1, False, True), (1, True, True),
                                   (2, False, True), (2, True, False)]
)  # fmt: skip
def test_a_silent_ground_station_counts_as_it_is_set(setting: float, alone: bool, lost: bool) -> None:
    scene = Scene(FS_GCS_ENABLE=setting)
    assert scene.found(START + 5.0, mission_running=alone) == {}
    expected = {Failsafe.GCS_LOSS: START + 5.0} if lost else {}
    assert scene.found(START + 5.1, mission_running=alone) == pytest.approx(expected)
    assert scene.found(START + 9.0, mission_running=alone) == pytest.approx(expected)


def test_an_absent_operator_counts_only_while_a_demand_moves() -> None:
    scene = Scene()
    now = START + 2.0
    scene.stick(AHEAD, now)
    assert scene.found(now) == {}
    scene.presence(now, age_ms=9_999)
    assert scene.found(now) == {}
    scene.presence(now, age_ms=10_001)
    assert scene.found(now) == {Failsafe.OPERATOR: now}
    assert scene.found(now, manual=False) == {}
    assert scene.found(now, manual=False, latched=Failsafe.OPERATOR) == {Failsafe.OPERATOR: now}
    assert set(scene.found(now + 0.6)) == {Failsafe.MANUAL_LOSS}
    scene.stick(NEUTRAL, now)
    assert scene.found(now) == {}


@pytest.mark.parametrize(("armed_at", "low", "critical"), [(START, 115.0, 108.0), (START + 30.0, 130.0, 130.0)])
def test_a_battery_counts_from_its_begin_or_from_arming(armed_at: float, low: float, critical: float) -> None:
    scene = Scene(FS_GCS_ENABLE=0, BATT_LOW_TIMER=10)
    assert scene.found(START + 40.0) == {}
    scene.battery.update(9.0, START + 5.0)
    expected = {Failsafe.BATTERY_LOW: low, Failsafe.BATTERY_CRITICAL: critical}
    assert scene.found(START + 40.0, armed_at=armed_at) == expected


@pytest.mark.parametrize("setting", [0, 1, 2])
def test_a_hot_pi_counts_where_its_failsafe_is_on(setting: float) -> None:
    scene = Scene(FS_GCS_ENABLE=0, FS_PI_ACT=setting)
    scene.computer.update(ComputerReadings(under_voltage=True), START + 5.0)
    assert scene.found(START + 6.0) == ({Failsafe.OVERHEAT: START + 5.0} if setting else {})
    assert scene.found(START + 6.0, armed_at=START + 5.5) == ({Failsafe.OVERHEAT: START + 5.5} if setting else {})


@pytest.mark.parametrize("mode", [Mode.MANUAL, Mode.GUIDED])
def test_only_auto_goes_on_without_station_where_setting_is_2(mode: Mode) -> None:
    field = Field(FS_GCS_ENABLE=2)
    if mode is Mode.MANUAL:
        field.drive(AHEAD)
    else:
        field.begin(Mode.GUIDED)
        field.goto(100.0, 0.0)
        field.beat(3.0)
    assert field.turning
    field.wait(7.0)
    assert field.mode is Mode.HOLD
    assert not field.turning
    assert said(field, "ground station lost: HOLD")


CRASH_ANGLE = math.radians(45)


def hazards(motion: MotionInputs, crash_angle: float = 45) -> dict[Failsafe, float]:
    """What holds at START because of `motion`."""
    return Scene(CRASH_ANGLE=crash_angle).found(START, motion=motion)


def test_nothing_is_a_hazard_at_rest() -> None:
    assert hazards(STANDING) == {}
    assert hazards(STANDING._replace(needs_position=True)) == {}


def test_position_and_fence() -> None:
    assert hazards(STANDING._replace(needs_position=True, estimate=Estimate())) == {Failsafe.POSITION: START}
    assert hazards(STANDING._replace(estimate=Estimate())) == {}
    assert hazards(STANDING._replace(outside_fence=True)) == {Failsafe.FENCE: START}


@pytest.mark.parametrize(("expires", "lost"), [(START, False), (START - 0.1, True), (START + 0.1, False)])
def test_setpoints_are_lost_after_they_expire(expires: float, lost: bool) -> None:
    found = hazards(STANDING._replace(setpoint_expires=expires))
    assert found == ({Failsafe.GUIDED_LOSS: expires} if lost else {})


@pytest.mark.parametrize("angle", ["roll", "pitch"])
@pytest.mark.parametrize("sign", [1, -1])
def test_tilted_beyond_the_angle_either_way(angle: str, sign: int) -> None:
    def tilted(value: float, crash_angle: float = 45) -> bool:
        readings = Readings(**{angle: sign * value})  # type: ignore[arg-type]
        return Failsafe.TILT in hazards(STANDING._replace(readings=readings), crash_angle)

    assert not tilted(CRASH_ANGLE)
    assert tilted(CRASH_ANGLE + 0.001)
    assert tilted(0.3, 10)
    assert not tilted(3.0, 0)


@pytest.mark.parametrize("wheels", [(0.04, -0.04), (0.0, 0.049)])
def test_blocked_is_throttle_without_a_wheel_that_turns(wheels: tuple[float, ...]) -> None:
    assert (BLOCKED_THROTTLE_MIN, BLOCKED_SPEED_MAX) == (0.2, 0.05)
    still = Readings(wheel_speeds=wheels)
    for throttles in ((0.2, 0.0), (0.0, -0.2), (1.0, 1.0)):
        assert hazards(STANDING._replace(readings=still, throttles=throttles)) == {Failsafe.BLOCKED: START}
    assert hazards(STANDING._replace(readings=still, throttles=(0.19, -0.19))) == {}
    for turning in ((0.05, 0.0), (0.0, -0.05)):
        assert hazards(STANDING._replace(readings=Readings(wheel_speeds=turning), throttles=(1.0, 1.0))) == {}


def test_blocked_without_wheel_speeds_goes_by_the_estimate() -> None:
    full = STANDING._replace(throttles=(1.0, 1.0))
    assert hazards(full) == {}  # no speed is known
    assert hazards(full._replace(estimate=Estimate(speed=0.04))) == {Failsafe.BLOCKED: START}
    assert hazards(full._replace(estimate=Estimate(speed=-0.05))) == {}
    assert hazards(full._replace(estimate=Estimate(speed=0.0, sideways=0.1))) == {}
