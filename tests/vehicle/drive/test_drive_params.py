"""Parameters that change while a demand stays."""

from __future__ import annotations

from tests.vehicle.bench import AHEAD
from tests.vehicle.pacing import cruise, idle_machine


def test_a_new_parameter_reaches_the_wheels_of_a_steady_demand() -> None:
    driven = cruise(idle_machine())
    assert driven.motors.outputs == (1.0, 1.0)
    driven.rover._params.set("MOT_THR_MAX", 50)
    driven.wait(1.0, AHEAD)
    assert driven.motors.outputs == (0.5, 0.5)
