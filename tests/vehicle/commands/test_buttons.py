"""Buttons of MANUAL_CONTROL: they act as they are pressed, for who may, and never by being held."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, EVERYTHING, NEUTRAL, OTHER, Bench, said
from vehicle.commands.buttons import FUNCTIONS, STATIONS_MAX
from vehicle.params import BUTTONS, PARAMETERS
from vehicle.safety import states

ARM, DISARM, STOP, HOLD, MANUAL, AUTO, RTL = range(1, 8)


def fitted() -> Bench:
    """A joystick whose buttons 0 to 6 do one thing each, and button 7 nothing."""
    bench = Bench(**{f"BTN{bit}_FUNCTION": float(bit + 1) for bit in range(7)})
    bench.heartbeat()
    return bench


def hold(bench: Bench, *functions: int, system: int = DRIVER, x: int = 0, introduced: bool = True, target: int = 1,
         wait: float = 0.05) -> None:  # fmt: skip
    """One message with these held."""
    bits = sum(1 << function - 1 for function in functions)
    bench.say(m.ManualControl(target, x, 0, 0, 0, bits), system, introduced=introduced)
    bench.wait(wait)


def press(bench: Bench, *functions: int, system: int = DRIVER, x: int = 0) -> None:
    hold(bench, system=system, x=x)
    hold(bench, *functions, system=system, x=x)


def driving() -> Bench:
    bench = fitted()
    press(bench, ARM)
    assert bench.armed
    bench.wait(0.1, NEUTRAL)
    for _ in range(20):
        hold(bench, x=1000)
    assert bench.throttles == (1.0, 1.0)
    return bench


def test_arming_by_a_button_takes_control() -> None:
    bench = fitted()
    press(bench, ARM)
    assert bench.armed
    assert said(bench, f"GCS {DRIVER} is in control")


@pytest.mark.parametrize("function", [DISARM, STOP])
@pytest.mark.parametrize("system", [DRIVER, OTHER])
def test_stops_of_anybody_are_at_once(function: int, system: int) -> None:
    bench = driving()
    hold(bench, system=system)
    hold(bench, function, system=system, wait=0)
    assert not bench.turning
    assert bench.rover.state is (states.SafetyState.SAFE if function == DISARM else states.SafetyState.ESTOP)


def test_hold_ramps_down_and_manual_drives_again_after_neutral() -> None:
    bench = driving()
    press(bench, HOLD, x=1000)
    for _ in range(15):
        hold(bench, HOLD, x=1000)
    assert not bench.turning
    modes = [bench.mode]
    press(bench, MANUAL, x=1000)
    assert [*modes, bench.mode] == [Mode.HOLD, Mode.MANUAL]
    hold(bench, x=1000)
    assert not bench.turning
    hold(bench)
    hold(bench, x=1000)
    assert bench.turning


def test_modes_that_drive_by_themselves_and_why_not() -> None:
    bench = driving()
    press(bench, RTL)
    assert said(bench, f"GCS {DRIVER}: button for RTL refused: position is not known")
    bench.readings = EVERYTHING
    for _ in range(60):
        hold(bench)
    press(bench, RTL)
    assert bench.mode is Mode.RTL
    press(bench, AUTO)
    assert said(bench, "button for AUTO refused: ")


def test_held_is_not_pressed_again() -> None:
    bench = driving()
    press(bench, HOLD)
    bench.set_mode(Mode.MANUAL)
    for _ in range(10):
        hold(bench, HOLD)
    assert bench.mode is Mode.MANUAL


def test_the_first_message_presses_nothing() -> None:
    bench = fitted()
    for _ in range(5):
        hold(bench, ARM)
    assert not bench.armed
    hold(bench)
    hold(bench, ARM)
    assert bench.armed


def test_what_comes_back_after_a_pause_presses_nothing() -> None:
    bench = fitted()
    hold(bench)
    bench.wait(1.0)
    hold(bench, ARM)
    assert not bench.armed


def test_a_station_not_in_control_only_stops() -> None:
    bench = driving()
    press(bench, MANUAL, system=OTHER)
    assert said(bench, f"GCS {OTHER}: button for MANUAL refused: GCS {DRIVER} is in control")
    press(bench, ARM, system=OTHER)
    assert said(bench, "button for arm refused")
    hold(bench, x=1000)
    assert bench.turning


@pytest.mark.parametrize("wrong", [{"introduced": False}, {"target": 2}, {"target": 0}])
def test_for_others_and_of_strangers_they_do_nothing(wrong: dict[str, int]) -> None:
    bench = driving()
    hold(bench, system=OTHER, **wrong)  # type: ignore[arg-type]
    hold(bench, STOP, system=OTHER, **wrong)  # type: ignore[arg-type]
    hold(bench, x=1000)
    assert bench.turning


def test_of_several_at_once_the_stop_wins() -> None:
    bench = driving()
    press(bench, ARM, STOP, MANUAL, system=DRIVER)
    assert bench.rover.state is states.SafetyState.ESTOP
    assert not bench.turning


def test_without_a_function_they_do_nothing() -> None:
    bench = Bench()
    bench.drive()
    for bits in (0, 0xFFFF, 0, 0xFFFF):
        bench.say(m.ManualControl(1, 1000, 0, 0, 0, bits, buttons2=bits))
        bench.wait(0.05)
    assert bench.throttles == (1.0, 1.0)


def test_buttons_end_a_motor_test() -> None:
    bench = fitted()
    hold(bench)
    bench.command(Command.DO_MOTOR_TEST, 1, 0, 20, 3)
    bench.wait(0.2)
    assert bench.turning
    hold(bench, DISARM, wait=0)
    assert not bench.turning


def test_of_very_many_stations_only_so_many_are_remembered() -> None:
    bench = fitted()
    for system in range(1, 200):
        hold(bench, system=system, wait=0)
    assert len(bench.rover._dispatcher.demands.buttons._held) == STATIONS_MAX


def test_every_function_is_in_the_range_of_its_parameter() -> None:
    for bit in range(BUTTONS):
        parameter = PARAMETERS[f"BTN{bit}_FUNCTION"]
        assert (parameter.default, parameter.low, parameter.high) == (0, 0, max(FUNCTIONS))
        assert all(f"{number} {each.label}" in parameter.description for number, each in FUNCTIONS.items())


def test_a_stick_that_is_held_drives_on() -> None:
    bench = driving()
    bench.wait(0.2, AHEAD)
    assert bench.turning
