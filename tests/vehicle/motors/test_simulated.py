from __future__ import annotations

import pytest

from tests.vehicle.motors.contract import Bench, MotorsContract
from vehicle.motors.simulated import SimulatedMotors


class TestSimulatedMotors(MotorsContract):
    @pytest.fixture(params=[1, 2, 4])
    def bench(self, request: pytest.FixtureRequest) -> Bench:
        motors = SimulatedMotors(request.param)
        return Bench(motors, lambda: motors.outputs, lambda: motors.enabled)
