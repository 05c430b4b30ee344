"""Demand and outputs of vehicles without our dialect, and what a pulse means."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from groundstation.vehicles.readings.foreign_drive import ForeignDrive, drive_params, pulse_fraction

LIMITS = {"MIN": 1100.0, "TRIM": 1500.0, "MAX": 1900.0, "REVERSED": 0.0}
SERVOS = m.ServoOutputRaw(0, 0, 1700, 0, 1300, 0, 0, 0, 0, 0)


def limits(channel: str, **changes: float) -> dict[str, float]:
    return {f"{channel}_{name}": value for name, value in (LIMITS | changes).items()}


@pytest.mark.parametrize(
    ("pulse", "changes", "fraction"),
    [
        (1500, {}, 0.0), (1700, {}, 0.5), (1300, {}, -0.5), (1900, {}, 1.0), (2100, {}, 1.0), (1000, {}, -1.0),
        (1700, {"REVERSED": 1.0}, -0.5), (1100, {"TRIM": 1100.0}, 0.0), (1500, {"TRIM": 1100.0}, 0.5),
        (1000, {"TRIM": 1100.0}, None), (0, {}, None), (65535, {}, None),
    ],
)  # fmt: skip
def test_what_a_pulse_means(pulse: int, changes: dict[str, float], fraction: float | None) -> None:
    assert pulse_fraction(pulse, "SERVO1", limits("SERVO1", **changes)) == fraction


@pytest.mark.parametrize("missing", LIMITS)
def test_a_pulse_means_nothing_while_one_parameter_is_not_known(missing: str) -> None:
    known = limits("SERVO1")
    del known[f"SERVO1_{missing}"]
    assert pulse_fraction(1700, "SERVO1", known) is None


@pytest.mark.parametrize(
    ("functions", "outputs"),
    [
        ({1: 26, 3: 70}, [("steering servo", 0.5), ("throttle servo", -0.5)]),
        ({2: 73, 3: 74}, [("right wheel", -0.5)]),
        ({1: 0, 3: 0, 4: 73, 5: 74}, []),
    ],
)
def test_outputs_without_a_pulse_are_hidden(functions: dict[int, int], outputs: list[tuple[str, float]]) -> None:
    drive = ForeignDrive()
    drive.values = {f"SERVO{channel}_FUNCTION": float(each) for channel, each in functions.items()}
    drive.values |= limits("SERVO1") | limits("SERVO3")
    drive.handle_servos(SERVOS, 10.0)
    assert [(output.name, output.value) for output in drive.outputs(11.0)] == outputs
    assert drive.outputs(20.0) == (), "an old report is not shown as if it were true now"


def test_the_demand_comes_from_the_mapped_channels() -> None:
    drive = ForeignDrive()
    channels = {f"chan{number}_raw": 0 for number in range(1, 19)} | {"chan2_raw": 1700, "chan4_raw": 1300}
    drive.handle_rc(m.RcChannels(time_boot_ms=0, chancount=4, rssi=255, **channels), 10.0)
    assert drive.demand(10.0) is None
    drive.values = {"RCMAP_ROLL": 4.0, "RCMAP_THROTTLE": 2.0} | limits("RC2") | limits("RC4")
    assert drive.demand(10.0) == (0.5, -0.5)
    assert drive.demand(20.0) is None
    drive.values |= {"RCMAP_ROLL": 99.0}
    assert drive.demand(10.0) is None


def test_px4_tells_its_actuators() -> None:
    drive = ForeignDrive()
    drive.handle_actuators(m.ActuatorOutputStatus(0, 2, [0.25, -0.5] + [0.0] * 30), 10.0)
    assert [(output.name, output.value) for output in drive.outputs(10.0)] == [("output 1", 0.25), ("output 2", -0.5)]
    drive.handle_actuators(m.ActuatorOutputStatus(0, 1, [1500.0] + [0.0] * 31), 10.0)
    assert [output.value for output in drive.outputs(10.0)] == [None], "a pulse whose limits are not known"


def test_outputs_of_px4_that_never_move_are_not_shown() -> None:
    drive, still = ForeignDrive(), [900.0] * 29
    drive.handle_actuators(m.ActuatorOutputStatus(0, 16, [1500.0, 1500.0, 900.0, *still]), 10.0)
    drive.handle_actuators(m.ActuatorOutputStatus(0, 16, [1000.0, 1677.0, 900.0, *still]), 10.1)
    assert [output.name for output in drive.outputs(10.1)] == ["output 1", "output 2"]
    drive.handle_actuators(m.ActuatorOutputStatus(0, 16, [1000.0, 1677.0, 1200.0, *still]), 10.2)
    assert [output.name for output in drive.outputs(10.2)] == ["output 1", "output 2", "output 3"]


def test_parameters_that_name_channels_lead_to_those_of_channels() -> None:
    first = set(drive_params(Autopilot.ARDUPILOT, {}))
    assert {"SERVO1_FUNCTION", "RCMAP_ROLL", "SERVO1_MIN", "SERVO3_TRIM"} <= first
    known = {"SERVO2_FUNCTION": 73.0, "SERVO4_FUNCTION": 74.0, "RCMAP_THROTTLE": 2.0}
    assert {"SERVO2_MIN", "SERVO4_REVERSED", "RC2_TRIM"} <= set(drive_params(Autopilot.ARDUPILOT, known))
    assert list(drive_params(Autopilot.PX4, known)) == []
