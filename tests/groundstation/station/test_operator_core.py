"""The operator's core without a screen: it drives and stops a simulated rover by the same code."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from groundstation.intents.agents import PermitProposal
from groundstation.intents.driving import (
    DriveKeyDown,
    DriveKeyUp,
    DrivePad,
    EmergencyStop,
    ReleasePad,
    SetStyle,
    StepLimits,
    Stop,
)
from groundstation.intents.services import FetchParams
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm
from groundstation.station.core_parts import CoreParts
from groundstation.station.driving.permission import Permission
from groundstation.station.intent_handler import MOVES_STICKS
from groundstation.station.operator_core import OperatorCore
from groundstation.vehicles.services import VehicleServices
from tests.world import World
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import PARAMETERS, Params
from vehicle.rover import Rover
from vehicle.sim.body import SimulatedBody


class Program:
    """A program without a screen, which renews the lease itself, and a simulated rover."""

    def __init__(self) -> None:
        self.core = OperatorCore(CoreParts(["memory"], session=7, now=100.0))
        motors = self.motors = SimulatedMotors()
        rover = Rover(Params({}), now=100.0)
        self.world = World(self.core, ControlLoop(rover, motors, SimulatedBody(lambda: motors.outputs)))
        self._due = 0.0
        self.do(RenewLease(), SetStyle("latch"), SetKeyGate(open=True))
        self.run(2.0)

    def do(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.core.handle_intent(intent, self.world.now)
        self.world.settle()

    def run(self, seconds: float) -> None:
        self.world.run(seconds, self._renew)

    def until(self, condition: Callable[[], bool], within: float) -> None:
        start = self.world.now
        while not condition():
            assert self.world.now - start < within
            self.run(self.world.step)

    def _renew(self, now: float) -> None:
        if now >= self._due:
            self._due = now + 0.1
            self.core.handle_intent(RenewLease(), now)

    @property
    def permission(self) -> Permission:
        return self.core.driving.judge(self.world.now)

    @property
    def services(self) -> VehicleServices:
        selected = self.core.fleet.selected
        assert selected is not None
        assert selected.services is not None
        return selected.services


def driving() -> Program:
    program = Program()
    program.do(Arm(held=1.0))
    program.until(lambda: program.permission.reason is None, 5.0)
    program.run(0.5)
    program.do(DriveKeyDown("i", 1, 0))
    program.run(1.0)
    assert all(output > 0 for output in program.motors.outputs), "the wheels turn"
    return program


def test_a_core_without_a_screen_drives_and_stops() -> None:
    program = driving()
    assert program.permission == Permission(None, None, frozenset((1,)))
    program.do(Stop())
    program.until(lambda: not any(program.motors.outputs), 1.0)


def test_a_core_without_a_screen_has_the_emergency_stop() -> None:
    program = driving()
    program.do(EmergencyStop())
    program.until(lambda: not any(program.motors.outputs), 0.5)
    assert program.permission.reason == "emergency stop"


def test_without_its_lease_a_core_goes_neutral() -> None:
    program = driving()
    program.world.run(0.3)
    program.until(lambda: not any(program.motors.outputs), 0.5)
    program.world.run(1.0)
    assert program.permission.screen == "screen not responding"
    assert program.permission.reason == "screen not responding"


def test_a_core_without_a_screen_makes_requests() -> None:
    program = Program()
    program.do(FetchParams(1))
    program.until(lambda: not program.services.book.running, 10.0)
    assert len(program.services.params.client.params) == len(PARAMETERS)


STICKS: tuple[AnyIntent, ...] = (
    DriveKeyDown("i", 1, 0),
    DriveKeyUp("i"),
    DrivePad(1.0, 0.0, 102.0),
    ReleasePad(),
    StepLimits(0.1, 0.1),
    PermitProposal(number=1, held=1.0),
)


def test_each_intent_that_moves_the_sticks_only_is_tried() -> None:
    assert {type(intent) for intent in STICKS} == MOVES_STICKS


@pytest.mark.parametrize("intent", STICKS, ids=lambda intent: type(intent).__name__)
@pytest.mark.parametrize("start", [Program, driving])
def test_what_moves_the_sticks_changes_no_permission(start: Callable[[], Program], intent: AnyIntent) -> None:
    program = start()
    before = program.permission
    program.do(intent)
    assert program.permission == before
