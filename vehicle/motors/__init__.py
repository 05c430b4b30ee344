"""What turns the wheels: the Motors protocol, the table of drivers and the checks each makes; no driver itself.

To add a driver, write a class that fits `Motors`, add one line to DRIVERS, and test it with
tests/vehicle/motors/contract.py.
A driver of your own needs no line: name it "module:Class".
A driver that has settings names their type `Settings` (a msgspec.Struct) and is made with one: `Class(settings)`.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from vehicle.motors.settings import CommonMotorSettings

DRIVERS: dict[str, str] = {
    "simulated": "vehicle.motors.simulated:SimulatedMotors",
    "gpio": "vehicle.motors.gpio:GpioMotors",
    "article-car": "vehicle.motors.gpio:GpioMotors",
    "pca9685": "vehicle.motors.pca9685:Pca9685Motors",
    "sysfs-pwm": "vehicle.motors.sysfs_pwm:SysfsPwmMotors",
    "roboclaw": "vehicle.motors.roboclaw:RoboClawMotors",
    "sabertooth": "vehicle.motors.sabertooth:SabertoothMotors",
}
"""Name -> "module:Class". Imported only when asked for: a driver's library is installed only where its hardware is."""

PROFILES: dict[str, dict[str, Any]] = {
    "article-car": {
        "bridges": [
            {"wiring": "two-inputs", "forward": 10, "backward": 9},
            {"wiring": "two-inputs", "forward": 8, "backward": 7},
        ],
        "frequency": 2000.0,
    },
}
"""Name of a driver -> settings it begins with. A known car is a driver, its settings and its parameters, no code.

article-car is the car of the Circuit Cellar articles, parts 1 and 2: left motor, right motor, BCM pins.
"""

PROFILE_PARAMS: dict[str, dict[str, float]] = {
    "article-car": {"MOT1_MAX": 60, "MOT2_MAX": 60, "MOT_PIVOT_MAX": 66.7},
}
"""Name of a driver -> parameters that a known car has instead of the defaults; whoever sets one wins.

The program of the article's car drove with 60 % duty and turned on the spot with 40 %, 66.7 % of that.
"""


class MotorError(Exception):
    """A motor driver cannot do what was asked. The text is one clear line."""


class StopPressedError(MotorError):
    """The emergency stop beside the motors is open, or was since they were enabled: no fault, but a stop that stays."""


class UnknownDriverError(MotorError):
    """There is no such driver: the user's mistake, not a fault of the hardware."""


class MotorSettingsError(UnknownDriverError):
    """There is no such setting, or no such value for it: the user's mistake too."""


class Motors(Protocol):
    """All motors of one vehicle, as one thing, so that they are stopped together.

    The rules, which the shared contract test checks:
    silent when made (neutral and disabled); `enable` starts from neutral whatever was set before; what is set while
    disabled turns nothing; a refused `set` changes no motor; `close` is neutral, then disabled, and may come twice.
    """

    @property
    def count(self) -> int:
        """How many motors; the length of `throttles`."""

    def enable(self) -> None:
        """Let the motors turn, from neutral. Raises MotorError."""

    def disable(self) -> None:
        """Take the power away at once, from any state. Raises MotorError."""

    def set(self, throttles: Sequence[float]) -> None:
        """Each motor's throttle, -1 (full reverse) to 1 (full ahead).

        Raises MotorError where the count is wrong, a value is not a number or outside, or the hardware does not answer.
        """

    def close(self) -> None:
        """Neutral, then disabled, then let go of the hardware."""


def estop_reader(motors: Motors) -> Callable[[], str | None]:
    """What asks the emergency stop beside `motors`: why it stops them, or None while closed; may raise MotorError.

    It is asked each control cycle, with and without power. A driver has one if it has a method `stop_pressed`.
    """
    asked: Callable[[], str | None] = getattr(motors, "stop_pressed", _never)
    return asked


def _never() -> None:
    """There is no such stop."""


def arming_check(motors: Motors) -> Callable[[], None]:
    """What raises MotorError as long as `motors` must not be armed, as where a controller's timeout is not certain.

    It is asked without power, at the start and after each failure. A driver has one if it has a method `prove`.
    """
    asked: Callable[[], None] = getattr(motors, "prove", _nothing)
    return asked


def _nothing() -> None:
    """There is nothing to prove."""


def check_throttles(throttles: Sequence[float], count: int) -> tuple[float, ...]:
    """`throttles` as a tuple, once it is certain that every one may go to a motor. Raises MotorError.

    Every driver calls it first in `set`: the last gate of the rover already holds the limits, but a driver must be
    safe with any caller.
    """
    if len(throttles) != count:
        raise MotorError(f"{len(throttles)} throttles for {count} motors")
    for throttle in throttles:
        if not -1.0 <= throttle <= 1.0:  # also false for NaN
            raise MotorError(f"throttle {throttle} is outside -1..1")
    return tuple(throttles)


def open_motors(name: str, settings: Mapping[str, Any] | None = None) -> Motors:
    """The motors of the driver `name`: a name from DRIVERS, or "module:Class".

    `settings` is the driver's own table, with what every driver takes beside it (vehicle/motors/settings.py, Around).
    Raises UnknownDriverError or MotorSettingsError for the user's mistakes and MotorError where the driver cannot
    start; then nothing stays open.
    """
    driver, own, around = _understood(name, settings)
    with ExitStack() as opened:
        guard = (
            around.open_safety_pins()
        )  # first: its enable pin takes the power away before the driver touches anything
        if guard is not None:
            opened.callback(guard.close)
        motors = _fitting(name, _made(name, driver, own))
        opened.callback(motors.close)
        wrapped: Motors = around.wrap(motors, guard)
        opened.pop_all()
    return wrapped


def settings_type(name: str) -> type | None:
    """The msgspec.Struct of a driver's own settings; None where it has none. Raises UnknownDriverError."""
    kind: type | None = getattr(load_driver_class(name), "Settings", None)
    return kind


def safe_stop(name: str, settings: Mapping[str, Any] | None = None) -> list[str]:
    """Stop motors that nobody drives any more, as after a killed daemon; never raises. What went wrong, a line each.

    An empty list is the driver's word that the motors are neutral and disabled.
    """
    problems: list[str] = []
    try:
        motors = open_motors(name, settings)
    except Exception as error:  # whatever it is, the caller has nothing better to do than to say it
        return [f"{name}: {_line(error)}"]
    for step in (motors.disable, motors.close):  # opened means neutral already
        try:
            step()
        except Exception as error:
            problems.append(f"{name}: {_line(error)}")
    return problems


def _line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if isinstance(error, MotorError) else f"{type(error).__name__}: {text}"


def _understood(name: str, settings: Mapping[str, Any] | None) -> tuple[Any, Any, CommonMotorSettings]:
    """The driver's class, its own settings or None where it takes none, and what goes around it."""
    from msgspec.structs import fields

    from vehicle.motors.settings import convert, split_table

    driver, kind = load_driver_class(name), settings_type(name)
    around, own = split_table({**PROFILES.get(name, {}), **(settings or {})})
    if kind is not None:
        if not own and (required := [field.encode_name for field in fields(kind) if field.required]):
            raise MotorSettingsError(
                f"motor driver {name!r} needs settings, at least {', '.join(required)}: "
                "[motors] of a file for --config, which `vehicle init` writes"
            )
        return driver, convert(own, kind), around
    if own:
        raise MotorSettingsError(f"motor driver {name!r} takes no settings, so {', '.join(own)} cannot be set")
    return driver, None, around


def _made(name: str, driver: Any, own: Any) -> Any:
    """The motors of a class, which may be anybody's, with any fault in it. Raises MotorError."""
    try:
        return driver() if own is None else driver(own)
    except MotorError:
        raise
    except Exception as error:
        raise MotorError(f"driver {name!r} does not start: {_line(error)}") from error


def _fitting(name: str, motors: Any) -> Motors:
    missing = [verb for verb in ("count", "enable", "disable", "set", "close") if not hasattr(motors, verb)]
    if missing:
        raise UnknownDriverError(f"motor driver {name!r} is none: it lacks {', '.join(missing)}")
    fitting: Motors = motors
    return fitting


def load_driver_class(name: str, table: Mapping[str, str] = DRIVERS, what: str = "motor driver") -> Any:
    """The class of a driver: `name` is one of `table`, or "module:Class". Raises UnknownDriverError.

    `what` it is stands in its texts.
    """
    target = table.get(name, name)
    module_name, colon, class_name = target.partition(":")
    if not (colon and module_name and class_name):
        raise UnknownDriverError(_unknown(name, table, what))
    found = getattr(_module(name, module_name, what), class_name, None)
    if found is None:
        raise UnknownDriverError(f"{what} {name!r}: module {module_name} has no {class_name!r}")
    return found


def _module(name: str, module: str, what: str) -> Any:
    """The module of the driver `name`, which may be somebody's own, with any fault in it. Raises UnknownDriverError."""
    try:
        return import_module(module)
    except MotorError:  # it is ours, and its library is missing
        raise
    except Exception as error:
        absent = isinstance(error, ModuleNotFoundError) and error.name == module.partition(".")[0]
        hint = "; install it beside vehicle, or name its folder in PYTHONPATH" if absent else ""
        raise UnknownDriverError(f"{what} {name!r} cannot be loaded: {_line(error)}{hint}") from error


def _unknown(name: str, table: Mapping[str, str], what: str) -> str:
    near = difflib.get_close_matches(name, table, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(table)}; or your own as module:Class"
    return f"unknown {what} {name!r}; {hint}"
