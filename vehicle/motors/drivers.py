"""The table of motor drivers, and opening a driver by its name."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from importlib import import_module
from typing import TYPE_CHECKING, Any

import msgspec

from vehicle.motors import MotorError, Motors, MotorSettingsError, UnknownDriverError

if TYPE_CHECKING:
    from vehicle.motors.settings import CommonMotorSettings

# msgspec and the settings are imported when a driver is opened: --help reads only the table, and starts faster.


class DriverEntry(msgspec.Struct, frozen=True):
    """One driver: where its class is, and what help and `mavhelm vehicle init` show."""

    path: str
    """The class as "module:Class". The module is imported with the settings of the driver, on any computer: it imports
    its library only when it opens the hardware."""
    title: str = ""
    """The hardware, for --help and the heading in the file of `mavhelm vehicle init`."""
    example: Mapping[str, Any] = msgspec.field(default_factory=dict)
    """Settings without a default, as `mavhelm vehicle init` shows them."""
    profile: Mapping[str, Any] = msgspec.field(default_factory=dict)
    """Settings that a known car has already: such a driver needs no settings in the file."""
    params: Mapping[str, float] = msgspec.field(default_factory=dict)
    """Parameters of a known car that replace the defaults. Values set by the user take precedence."""


DRIVERS: dict[str, DriverEntry] = {
    "simulated": DriverEntry("vehicle.motors.simulated:SimulatedMotors", "no hardware, for the simulator and tests"),
    "gpio": DriverEntry(
        "vehicle.motors.gpio:GpioMotors",
        "H-bridges on GPIO pins, with software PWM",
        example={
            "bridges": [
                {"wiring": "two-inputs", "forward": 5, "backward": 6, "enable": 12},
                {"wiring": "phase-enable", "enable": 13, "phase": 16},
            ]
        },
    ),
    # The car of the Circuit Cellar articles, parts 1 and 2: left motor, right motor, BCM pins. The program of the
    # articles drove with 60 % duty and turned on the spot with 40 %, which is 66.7 % of 60 %.
    "article-car": DriverEntry(
        "vehicle.motors.gpio:GpioMotors",
        "the car of the Circuit Cellar articles, with its settings",
        profile={
            "bridges": [
                {"wiring": "two-inputs", "forward": 10, "backward": 9},
                {"wiring": "two-inputs", "forward": 8, "backward": 7},
            ],
            "frequency": 2000.0,
        },
        params={"MOT1_MAX": 60, "MOT2_MAX": 60, "MOT_PIVOT_MAX": 66.7},
    ),
    "pca9685": DriverEntry(
        "vehicle.motors.pca9685:Pca9685Motors",
        "ESCs and servos on a PCA9685 board (I2C)",
        example={"channels": [{"channel": 0}, {"channel": 1}]},
    ),
    "sysfs-pwm": DriverEntry(
        "vehicle.motors.sysfs_pwm:SysfsPwmMotors",
        "H-bridges, ESCs and servos on the hardware PWM of the Raspberry Pi",
        example={
            "outputs": [
                {"drives": "bridge", "device": "fe20c000.pwm", "channel": 0, "direction": 5},
                {"drives": "servo", "device": "fe20c000.pwm", "channel": 1},
            ]
        },
    ),
    "roboclaw": DriverEntry(
        "vehicle.motors.roboclaw:RoboClawMotors",
        "Basicmicro RoboClaw over UART or USB; M1 is the left motor, M2 the right one",
        example={"port": "/dev/serial0"},
    ),
    "sabertooth": DriverEntry(
        "vehicle.motors.sabertooth:SabertoothMotors",
        "Dimension Engineering Sabertooth over UART; motor 1 is the left one, motor 2 the right one",
        example={"port": "/dev/serial0"},
    ),
}
"""Name of a driver -> all that the vehicle, `mavhelm vehicle init`, `mavhelm vehicle schema` and --help need of it."""


def profile_settings(name: str) -> Mapping[str, Any]:
    """Return the settings that the driver `name` starts with; empty for any but a known car."""
    return DRIVERS[name].profile if name in DRIVERS else {}


def profile_params(name: str) -> Mapping[str, float]:
    """Return the parameters that replace the defaults with the driver `name`; empty for any but a known car."""
    return DRIVERS[name].params if name in DRIVERS else {}


def open_motors(name: str, settings: Mapping[str, Any] | None = None) -> Motors:
    """Open the motors of the driver `name`: a name of DRIVERS, or "module:Class".

    `settings` is the driver's own table together with CommonMotorSettings (vehicle/motors/settings.py).
    Raises UnknownDriverError or MotorSettingsError for user errors, and MotorError if the driver cannot start; nothing
    stays open then.
    """
    driver, own, common = _parse_settings(name, settings)
    with ExitStack() as opened:
        pins = common.open_safety_pins()  # first: the enable pin removes the power before the driver touches anything
        if pins is not None:
            opened.callback(pins.close)
        motors = _require_methods(name, _build(name, driver, own))
        opened.callback(motors.close)
        wrapped: Motors = common.wrap(motors, pins)
        opened.pop_all()
    return wrapped


def settings_type(name: str) -> type | None:
    """Return the msgspec.Struct of a driver's own settings, None without any. Raises UnknownDriverError."""
    kind: type | None = getattr(load_driver_class(name), "Settings", None)
    return kind


def safe_stop(name: str, settings: Mapping[str, Any] | None = None) -> list[str]:
    """Stop motors without a running vehicle, for example after the daemon was killed. Never raises.

    Returns one line for each problem. An empty list means that the driver confirmed neutral and disabled motors.
    """
    problems: list[str] = []
    try:
        motors = open_motors(name, settings)
    except Exception as error:  # any error: the caller can only report it
        return [f"{name}: {_error_line(error)}"]
    for step in (motors.disable, motors.close):  # an opened driver is neutral already
        try:
            step()
        except Exception as error:
            problems.append(f"{name}: {_error_line(error)}")
    return problems


def _error_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if isinstance(error, MotorError) else f"{type(error).__name__}: {text}"


def _parse_settings(name: str, settings: Mapping[str, Any] | None) -> tuple[Any, Any, CommonMotorSettings]:
    """Return the driver's class, its own settings (None if it takes none) and the common settings."""
    from msgspec.structs import fields

    from vehicle.motors.settings import convert, split_table

    driver, kind = load_driver_class(name), settings_type(name)
    common, own = split_table({**profile_settings(name), **(settings or {})})
    if kind is not None:
        if not own and (required := [each.encode_name for each in fields(kind) if each.required]):
            raise MotorSettingsError(
                f"motor driver {name!r} needs settings, at least {', '.join(required)}: "
                "[motors] of a file for --config, which `mavhelm vehicle init` writes"
            )
        return driver, convert(own, kind), common
    if own:
        raise MotorSettingsError(f"motor driver {name!r} takes no settings, so {', '.join(own)} cannot be set")
    return driver, None, common


def _build(name: str, driver: Any, own: Any) -> Any:
    """Construct the driver; a class from outside may raise anything. Raises MotorError."""
    try:
        return driver() if own is None else driver(own)
    except MotorError:
        raise
    except Exception as error:
        raise MotorError(f"driver {name!r} does not start: {_error_line(error)}") from error


def _require_methods(name: str, motors: Any) -> Motors:
    missing = [method for method in ("count", "enable", "disable", "set", "close") if not hasattr(motors, method)]
    if missing:
        raise UnknownDriverError(f"motor driver {name!r} is incomplete: it lacks {', '.join(missing)}")
    complete: Motors = motors
    return complete


def load_driver_class(name: str, table: Mapping[str, DriverEntry] = DRIVERS, kind: str = "motor driver") -> Any:
    """Import the class of a driver: `name` is a key of `table`, or "module:Class". Raises UnknownDriverError.

    Error texts call the driver a `kind`.
    """
    path = table[name].path if name in table else name
    module_name, colon, class_name = path.partition(":")
    if not (colon and module_name and class_name):
        raise UnknownDriverError(_unknown(name, table, kind))
    found = getattr(_import(name, module_name, kind), class_name, None)
    if found is None:
        raise UnknownDriverError(f"{kind} {name!r}: module {module_name} has no {class_name!r}")
    return found


def _import(name: str, module: str, kind: str) -> Any:
    """Import the module of a driver; a module from outside may raise anything. Raises UnknownDriverError."""
    try:
        return import_module(module)
    except Exception as error:
        absent = isinstance(error, ModuleNotFoundError) and error.name == module.partition(".")[0]
        hint = "; install it beside vehicle, or add its folder to PYTHONPATH" if absent else ""
        raise UnknownDriverError(f"{kind} {name!r} cannot be loaded: {_error_line(error)}{hint}") from error


def _unknown(name: str, table: Mapping[str, DriverEntry], kind: str) -> str:
    import difflib  # when it is needed: it takes 1 ms of each start

    near = difflib.get_close_matches(name, table, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(table)}; or your own as module:Class"
    return f"unknown {kind} {name!r}; {hint}"
