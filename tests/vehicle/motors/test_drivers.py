from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

import msgspec
import pytest

from vehicle.motors import MotorError, Motors, MotorSettingsError, UnknownDriverError, check_throttles
from vehicle.motors.drivers import DRIVERS, open_motors, safe_stop, settings_type
from vehicle.motors.simulated import SimulatedMotors


@pytest.mark.parametrize("name", DRIVERS)
def test_every_line_of_the_table_leads_to_a_driver(name: str) -> None:
    module, _, class_name = DRIVERS[name].path.partition(":")
    driver = getattr(import_module(module), class_name)
    for verb in ("enable", "disable", "set", "close"):
        assert callable(getattr(driver, verb))
    if name != "simulated":
        assert issubclass(driver.Settings, msgspec.Struct)
        assert driver.Settings.__struct_config__.forbid_unknown_fields
        assert msgspec.json.schema(driver.Settings)


def test_the_simulated_motors_open_without_settings() -> None:
    motors: Motors = open_motors("simulated")
    assert motors.count == 2
    motors.close()


class OwnSettings(msgspec.Struct, forbid_unknown_fields=True):
    count: int


class OwnMotors(SimulatedMotors):
    """What somebody else might write."""

    Settings = OwnSettings

    def __init__(self, settings: OwnSettings) -> None:
        super().__init__(settings.count)


class BrokenMotors(SimulatedMotors):
    def disable(self) -> None:
        raise MotorError("the relay is welded")

    def close(self) -> None:
        raise ValueError("two\nlines")


def test_a_driver_of_your_own_gets_its_settings() -> None:
    assert open_motors(f"{__name__}:OwnMotors", {"count": 3}).count == 3
    with pytest.raises(MotorSettingsError, match="motor settings: count: Expected `int`, got `str`"):
        open_motors(f"{__name__}:OwnMotors", {"count": "three"})
    with pytest.raises(MotorSettingsError, match=r"needs settings, at least count: .* `mavhelm vehicle init` writes"):
        open_motors(f"{__name__}:OwnMotors")


def test_settings_are_judged_before_the_hardware_is_touched() -> None:
    with pytest.raises(MotorSettingsError, match="unknown field `prot`"):
        open_motors("roboclaw", {"prot": "/dev/nowhere"})
    with pytest.raises(UnknownDriverError, match="did you mean 'roboclaw'"):
        open_motors("robotclaw", {"port": "/dev/nowhere"})
    assert settings_type("simulated") is None


def test_safe_stop_never_raises_and_says_what_went_wrong() -> None:
    assert safe_stop("simulated") == []
    assert safe_stop(f"{__name__}:BrokenMotors") == [
        f"{__name__}:BrokenMotors: the relay is welded",
        f"{__name__}:BrokenMotors: ValueError: two lines",
    ]
    assert safe_stop("simulatd") == ["simulatd: unknown motor driver 'simulatd'; did you mean 'simulated'?"]
    assert len(safe_stop("no_such_module:Car")) == 1
    assert len(safe_stop("roboclaw", {"port": "/dev/nowhere"})) == 1


def test_a_driver_of_your_own_is_named_by_module_and_class() -> None:
    assert isinstance(open_motors("vehicle.motors.simulated:SimulatedMotors"), SimulatedMotors)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("simulatd", "did you mean 'simulated'"),
        ("", "known: simulated"),
        ("zebra", "or your own as module:Class"),
        ("no_such_module:Car", "No module named 'no_such_module'; install it beside vehicle, or add its folder to "),
        ("..up:Car", "cannot be loaded: TypeError: the 'package' argument is required"),
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


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("def (", "cannot be loaded: SyntaxError: invalid syntax"),
        ("raise RuntimeError('no\\nluck')", "cannot be loaded: RuntimeError: no luck"),
        ("import no_such_library", "cannot be loaded: ModuleNotFoundError: No module named 'no_such_library'"),
    ],
)
def test_a_fault_in_a_module_of_your_own_is_said_in_one_line(
    source: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "faulty_car.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "faulty_car", raising=False)
    with pytest.raises(UnknownDriverError) as caught:
        open_motors("faulty_car:Car")
    assert str(caught.value).startswith(f"motor driver 'faulty_car:Car' {says}")
    assert "\n" not in str(caught.value)
    assert "PYTHONPATH" not in str(caught.value)


class Broken:
    def __init__(self) -> None:
        raise ValueError("no\nhardware")


def test_an_own_driver_that_does_not_start_is_told_in_one_line() -> None:
    with pytest.raises(MotorError) as caught:
        open_motors(f"{__name__}:Broken")
    assert str(caught.value) == f"driver '{__name__}:Broken' does not start: ValueError: no hardware"


def test_checked_gives_what_it_was_given() -> None:
    assert check_throttles([1.0, -1.0, 0.0], 3) == (1.0, -1.0, 0.0)
    with pytest.raises(MotorError, match="2 throttles for 3 motors"):
        check_throttles([0.0, 0.0], 3)
