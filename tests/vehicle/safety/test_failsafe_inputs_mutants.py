"""Failsafe conditions: which facts make each, and from when it counts."""

from __future__ import annotations

import pytest

from dialects.axes import Axes, build_manual_control
from dialects.enums import Failsafe
from dialects.messages import RoverOperatorPresence
from dialects.modes import Mode
from link.core import Peer, Received
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, said
from tests.vehicle.field import Field
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.readings import ComputerReadings
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.failsafe_inputs import FailsafeInputs, active_conditions
from vehicle.safety.pi_monitor import PiMonitor
from vehicle.statustext import StatusTextQueue

START = 100.0
NOTHING = Failsafe(0)
TIMES = {"MAN_TIMEOUT": 0.5, "FS_TIMEOUT": 1.5, "FS_GCS_TIMEOUT": 5.0, "OPR_TIMEOUT": 10.0}


class Scene:
    """An armed vehicle in MANUAL with a driver in control, at START."""

    def __init__(self, **params: float) -> None:
        self.params = Params(TIMES | params)
        texts = StatusTextQueue()
        self.control = Control(self.params, texts, system=1, boot=0.0)
        self.control.set_owner(DRIVER, START)
        self.battery = BatteryMonitor(self.params)
        self.computer = PiMonitor(self.params, texts)
        self.sequence = 0

    def stick(self, axes: Axes, now: float) -> None:
        self.sequence += 1
        message = build_manual_control(axes, 1)
        received = Received(message, DRIVER, 190, self.sequence, Peer(0, "gcs"), introduced=True)
        self.control.update_liveness(received, now)
        assert self.control.handle_manual_control(received, message, now)

    def presence(self, now: float, age_ms: int = 0) -> None:
        message = RoverOperatorPresence(1, 1, 0, 0, 1, 1, age_ms, 1)
        received = Received(message, DRIVER, 190, 0, Peer(0, "gcs"), introduced=True)
        self.control.handle_operator_presence(received, message, now)

    def found(
        self,
        now: float,
        *,
        driven: bool = True,
        latched: Failsafe = NOTHING,
        alone: bool = False,
        armed_at: float = START,
        hazards: dict[Failsafe, float] | None = None,
    ) -> dict[Failsafe, float]:
        return active_conditions(
            FailsafeInputs(
                self.params, self.control, self.battery, self.computer, driven, latched, armed_at, hazards or {}, alone
            ),
            now,
        )


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


def test_a_lost_demand_counts_in_a_mode_that_obeys_it_and_where_it_has_ended_that_mode() -> None:
    scene = Scene()
    scene.stick(AHEAD, START)
    lost = {Failsafe.MANUAL_LOSS: START + 0.5}
    assert scene.found(START + 2.0, driven=False) == {}
    assert scene.found(START + 2.0, driven=False, latched=Failsafe.MANUAL_LOSS) == lost
    assert scene.found(START + 2.0, driven=False, latched=Failsafe.GCS_LOSS) == {}
    assert scene.found(START + 2.0, driven=True, latched=Failsafe.GCS_LOSS) == lost


@pytest.mark.parametrize(
    ("setting", "alone", "lost"), [(0, False, False), (0, True, False), (1, False, True), (1, True, True),
                                   (2, False, True), (2, True, False)]
)  # fmt: skip
def test_a_silent_ground_station_counts_as_it_is_set(setting: float, alone: bool, lost: bool) -> None:
    scene = Scene(FS_GCS_ENABLE=setting)
    assert scene.found(START + 5.0, alone=alone) == {}
    expected = {Failsafe.GCS_LOSS: START + 5.0} if lost else {}
    assert scene.found(START + 5.1, alone=alone) == pytest.approx(expected)
    assert scene.found(START + 9.0, alone=alone) == pytest.approx(expected)


def test_an_operator_who_gives_no_sign_counts_only_while_a_fresh_demand_asks_for_motion() -> None:
    scene = Scene()
    now = START + 2.0
    scene.stick(AHEAD, now)
    assert scene.found(now) == {}
    scene.presence(now, age_ms=9_999)
    assert scene.found(now) == {}
    scene.presence(now, age_ms=10_001)
    assert scene.found(now) == {Failsafe.OPERATOR: now}
    assert scene.found(now, driven=False) == {}
    assert scene.found(now, driven=False, latched=Failsafe.OPERATOR) == {Failsafe.OPERATOR: now}
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


def test_hazards_are_conditions_too() -> None:
    hazards = {Failsafe.TILT: START + 1.0}
    assert Scene().found(START + 2.0, hazards=hazards) == hazards


@pytest.mark.parametrize("mode", [Mode.MANUAL, Mode.GUIDED])
def test_only_auto_goes_on_without_a_ground_station_where_the_setting_is_2(mode: Mode) -> None:
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
