from __future__ import annotations

import pytest

from vehicle.motors import DRIVERS, MotorError, Motors, UnknownDriverError, checked, open_motors
from vehicle.motors.simulated import SimulatedMotors


@pytest.mark.parametrize("name", DRIVERS)
def test_every_driver_of_the_table_opens(name: str) -> None:
    motors: Motors = open_motors(name)
    assert motors.count >= 1
    motors.close()


def test_a_driver_of_your_own_is_named_by_module_and_class() -> None:
    assert isinstance(open_motors("vehicle.motors.simulated:SimulatedMotors"), SimulatedMotors)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("simulatd", "did you mean 'simulated'"),
        ("", "known: simulated"),
        ("zebra", "or your own as module:Class"),
        ("no_such_module:Car", "No module named 'no_such_module'"),
        ("vehicle.motors.simulated:Car", "module vehicle.motors.simulated has no 'Car'"),
        ("vehicle.motors.simulated:", "unknown motor driver"),
        (":Car", "unknown motor driver"),
        ("decimal:Decimal", "it lacks count, enable, disable, set, close"),
    ],
)
def test_a_name_that_leads_nowhere_is_said_in_one_line(name: str, says: str) -> None:
    with pytest.raises(UnknownDriverError) as caught:
        open_motors(name)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_checked_gives_what_it_was_given() -> None:
    assert checked([1.0, -1.0, 0.0], 3) == (1.0, -1.0, 0.0)
    with pytest.raises(MotorError, match="2 throttles for 3 motors"):
        checked([0.0, 0.0], 3)
