"""Every setting of the vehicle in one table: name, default, range, unit, what it does. Saving them is not done here.

Names are ArduRover's where it has the same setting, at most 16 characters, and every value is a float, because only
REAL32 parameters read the same in every ground station.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Parameter:
    """One setting. What a failsafe, an interlock or a limit goes by is `safety`: never changed while armed."""

    name: str
    default: float
    low: float
    high: float
    unit: str
    description: str
    safety: bool = False
    whole: bool = False
    """Only whole numbers."""
    needs_reboot: bool = False
    """Counts only after a restart."""
    read_only: bool = False
    """No ground station sets it: it must fit the hardware, or is pinned by the file of settings."""


MOTORS = 4
"""Motors with parameters of their own: of the kind of drive that has most."""


def _motor(number: int) -> tuple[Parameter, ...]:
    """What fits one motor to its wheel (vehicle/drive/output_scaling.py); in the order of vehicle/drive/mixer.py, `Mixer.motors`."""
    name = f"MOT{number}"
    return (
        Parameter(f"{name}_REVERSED", 0, 0, 1, "", f"Motor {number} is wired or mounted the other way round",
                  safety=True, whole=True),
        Parameter(f"{name}_MIN", 0, 0, 80, "%", f"What motor {number} needs to turn at all; not for a steering servo",
                  safety=True),
        Parameter(f"{name}_MAX", 100, 25, 100, "%", f"Largest output of motor {number}; less on the faster side makes "
                  "a rover run straight", safety=True),
        Parameter(f"{name}_TRIM", 0, -20, 20, "%", f"Added to what motor {number} gets: the centre of a steering "
                  "servo; a motor that drives gets it only while it turns", safety=True),
    )  # fmt: skip


BUTTONS = 16
"""Bits of MANUAL_CONTROL's `buttons`."""

TABLE: tuple[Parameter, ...] = (
    # Identity
    Parameter("MAV_SYSID", 1, 1, 255, "", "System id of this vehicle; after a restart", whole=True, needs_reboot=True),
    Parameter("MAV_GCS_SYSID", 0, 0, 255, "", "Only this ground station may take control; 0: the first that arms",
              safety=True, whole=True),
    Parameter("REBOOT_ENABLE", 0, 0, 2, "", "PREFLIGHT_REBOOT_SHUTDOWN: 0 denied, 1 restarts this program, 2 also "
              "reboots or shuts down the computer on board", whole=True, read_only=True),
    # Manual driving
    Parameter("MAN_TIMEOUT", 0.45, 0.2, 2, "s", "A demand older than this is neutral. 9 frames of 20 Hz; less than "
              "0.5 s, so that the wheels begin to slow by then", safety=True),
    Parameter("MAN_DEADBAND", 3, 0, 20, "%", "Demands smaller than this are neutral", safety=True),
    Parameter("MANUAL_EXPO", 0, 0, 0.9, "", "Softness of throttle, also sideways, near neutral; 0 is linear"),
    Parameter("MANUAL_STR_EXPO", 0, 0, 0.9, "", "Softness of steering near neutral; 0 is linear"),
    Parameter("INITIAL_MODE", 0, 0, 4, "", "Mode after start: 0 MANUAL, 4 HOLD", whole=True),
    Parameter("OPR_TIMEOUT", 10, 2, 60, "s", "Without a key or stick event for so long while moving: stop",
              safety=True),
    Parameter("OPR_ECHO_MAX", 0.45, 0.2, 5, "s", "A demand is refused when the driver has seen nothing newer of the "
              "vehicle than this; raise it on slow radios", safety=True),
    *(Parameter(f"BTN{bit}_FUNCTION", 0, 0, 7, "", f"Button {bit} of MANUAL_CONTROL, as it is pressed: 0 nothing, "
                "1 arm, 2 disarm, 3 emergency stop, 4 HOLD, 5 MANUAL, 6 AUTO, 7 RTL", safety=True, whole=True)
      for bit in range(BUTTONS)),
    # Failsafes
    Parameter("FS_TIMEOUT", 1.5, 0.5, 10, "s", "From manual control lost to HOLD", safety=True),
    Parameter("FS_DISARM_T", 30, 5, 300, "s", "From manual control lost to disarmed", safety=True),
    Parameter("FS_GCS_ENABLE", 1, 0, 2, "", "HOLD when the ground station in control is silent; 2: AUTO goes on",
              safety=True, whole=True),
    Parameter("FS_GCS_TIMEOUT", 5, 2, 120, "s", "Silence after which the ground station in control is lost",
              safety=True),
    Parameter("FS_LOOP_TIMEOUT", 0.2, 0.1, 2, "s", "A control cycle later than this disarms", safety=True),
    Parameter("FS_LOW_ACT", 2, 0, 2, "", "Battery low: 0 slow down only, 2 HOLD as well", safety=True, whole=True),
    Parameter("BATT_LOW_VOLT", 10.5, 0, 100, "V", "Battery low below this; 0: off", safety=True),
    Parameter("BATT_CRT_VOLT", 10.0, 0, 100, "V", "Battery critical below this; 0: off", safety=True),
    Parameter("BATT_LOW_TIMER", 10, 1, 120, "s", "The voltage must be low for so long; motors pull it down",
              safety=True),
    Parameter("FS_PI_ACT", 2, 0, 2, "", "Pi too hot or its supply too weak: 0 say so, 1 slow down, 2 HOLD as well",
              safety=True, whole=True),
    Parameter("FS_PI_TEMP", 85, 0, 110, "degC", "The Pi is too hot above this; a Pi slows itself down at 85; 0: off",
              safety=True),
    Parameter("FS_PI_TIMER", 10, 1, 120, "s", "From slow to HOLD, while the Pi stays too hot or its supply too weak",
              safety=True),
    Parameter("DISARM_DELAY", 300, 0, 3600, "s", "Disarm after so long without a demand; 0: never", safety=True),
    Parameter("GUIDED_TIMEOUT", 1, 0.2, 5, "s", "A velocity setpoint of GUIDED older than this stops", safety=True),
    Parameter("CRASH_ANGLE", 45, 0, 80, "deg", "Tilted more than this for 0.5 s: disarm; 0: off", safety=True),
    Parameter("FS_CRASH_CHECK", 1, 0, 2, "", "Pushing for 2 s without moving: 0 nothing, 1 HOLD, 2 disarm",
              safety=True, whole=True),
    Parameter("FENCE_ENABLE", 0, 0, 1, "", "The fence counts", safety=True, whole=True),
    Parameter("FENCE_TYPE", 6, 0, 6, "", "Sum of 2: circle around home, 4: uploaded areas", safety=True, whole=True),
    Parameter("FENCE_ACTION", 2, 0, 2, "", "Beyond the fence: 0 say so, 1 RTL, 2 HOLD", safety=True, whole=True),
    Parameter("FENCE_RADIUS", 100, 1, 10000, "m", "Of the circle around home", safety=True),
    Parameter("FENCE_MARGIN", 1, 0, 10, "m", "What drives by itself stops so far before the fence", safety=True),
    Parameter("AVOID_ENABLE", 1, 0, 1, "", "What drives by itself stops before the fence (FENCE_MARGIN)",
              safety=True, whole=True),
    # Driving by itself
    Parameter("WP_SPEED", 0.8, 0.1, 30, "m/s", "Usual speed along a path; SPEED_MAX is never exceeded"),
    Parameter("WP_RADIUS", 0.5, 0.1, 20, "m", "A waypoint to drive through is reached at this distance"),
    Parameter("WP_PIVOT_ANGLE", 60, 10, 180, "deg", "Corners sharper than this are turned on the spot"),
    Parameter("WP_PIVOT_RATE", 60, 5, 360, "deg/s", "Turn rate on the spot"),
    Parameter("RTL_SPEED", 0, 0, 30, "m/s", "Speed on the way home; 0: as usual"),
    Parameter("RALLY_LIMIT_KM", 0.5, 0, 100, "km", "RTL goes home where no rally point is so near; 0: any distance"),
    Parameter("RALLY_INCL_HOME", 1, 0, 1, "", "RTL goes home where home is nearer than the rally points", whole=True),
    Parameter("LOIT_RADIUS", 1, 0.3, 20, "m", "LOITER drives back when it is farther away; radius of circles"),
    Parameter("ACRO_TURN_RATE", 180, 10, 720, "deg/s", "Turn rate at full steering in ACRO"),
    Parameter("TURN_RADIUS", 0.55, 0.1, 30, "m", "Turning circle's radius at full steering, of wheels that steer"),
    Parameter("CRUISE_SPEED", 0.75, 0.05, 30, "m/s", "Speed at CRUISE_THROTTLE"),
    Parameter("CRUISE_THROTTLE", 50, 5, 100, "%", "Throttle that gives CRUISE_SPEED"),
    Parameter("ATC_ACCEL_MAX", 1, 0.1, 10, "m/s/s", "Acceleration along a path"),
    Parameter("ATC_DECEL_MAX", 1, 0.1, 10, "m/s/s", "Braking along a path", safety=True),
    Parameter("ATC_STOP_SPEED", 0.1, 0.01, 1, "m/s", "Slower than this it stands", safety=True),
    Parameter("ATC_SPEED_P", 0.2, 0, 2, "", "Throttle for each m/s that is missing"),
    Parameter("ATC_SPEED_I", 0.2, 0, 2, "", "... and for each m that was missed"),
    Parameter("ATC_STR_ANG_P", 2, 0.5, 10, "", "rad/s for each rad off the course"),
    Parameter("ATC_STR_RAT_MAX", 120, 10, 720, "deg/s", "Largest turn rate while driving by itself", safety=True),
    Parameter("ATC_TURN_MAX_G", 0.6, 0.1, 10, "g", "Largest sideways acceleration while driving by itself; "
              "rovers that may tip need less", safety=True),
    Parameter("ATC_STR_RAT_P", 0.1, 0, 2, "", "Steering for each rad/s that is missing"),
    Parameter("ATC_STR_RAT_I", 0.2, 0, 2, "", "... and for each rad that was missed"),
    Parameter("ATC_STR_RAT_FF", 0.23, 0, 3, "", "Steering for each rad/s that is wanted"),
    # Motors
    Parameter("DRIVE_TYPE", 1, 1, 4, "", "1 skid steering, 2 Ackermann, 3 omni, 4 mecanum: "
              "belongs to the hardware, set it where the vehicle starts", whole=True,
              needs_reboot=True, read_only=True),
    Parameter("MOT_SLEWRATE", 250, 10, 1000, "%/s", "Acceleration of each motor", safety=True),
    Parameter("MOT_DECEL", 250, 250, 10000, "%/s", "Deceleration of each motor; 250 is from full to zero in 0.4 s",
              safety=True),
    Parameter("MOT_THR_MAX", 100, 30, 100, "%", "Largest throttle", safety=True),
    Parameter("MOT_STR_THR_MIX", 0.5, 0.2, 1, "", "Skid steering at its limit: more keeps steering, less throttle",
              safety=True),
    Parameter("MOT_TEST_MAX", 30, 0, 30, "%", "Largest throttle of DO_MOTOR_TEST and ACTUATOR_TEST; 0: no tests over "
              "the air", safety=True),
    Parameter("MOT_REV_DELAY", 0, 0, 1, "s", "Pause at zero before a motor reverses", safety=True),
    Parameter("MOT_PIVOT_MAX", 100, 10, 100, "%", "Share of full for turning on the spot; curves are in between",
              safety=True),
    Parameter("MOT_THST_EXPO", 0, -1, 1, "", "Thrust curve of motors that drive; 0 is linear, more is more at half",
              safety=True),
    Parameter("MOT_THST_ASYM", 1, 1, 10, "", "Skid steering: how many times more a motor pushes ahead than back",
              safety=True),
    *(parameter for number in range(1, MOTORS + 1) for parameter in _motor(number)),
    # Logs
    Parameter("LOG_BACKEND_TYPE", 1, 0, 1, "", "Telemetry logs of each drive: 0 none, 1 files", whole=True),
    Parameter("LOG_DISARMED", 0, 0, 1, "", "0: record from arming until 15 s after disarming, 1: always", whole=True),
    Parameter("LOG_MAX_FILES", 500, 2, 500, "", "More logs than this: the oldest is removed", whole=True),
    Parameter("LOG_FILE_MB_FREE", 500, 10, 1000, "MB", "Less than this is free: the oldest logs are removed",
              whole=True),
    # Shape
    Parameter("SPEED_MAX", 1.5, 0.1, 30, "m/s", "Top speed", safety=True),
    Parameter("TRACK_WIDTH", 0.35, 0.05, 5, "m", "Distance between left and right wheels"),
    Parameter("WHEELBASE", 0.3, 0.05, 5, "m", "Distance between front and rear axles"),
)  # fmt: skip

PARAMETERS: dict[str, Parameter] = {parameter.name: parameter for parameter in TABLE}

ORDERED_PAIRS: tuple[tuple[str, str], ...] = tuple((f"MOT{n}_MIN", f"MOT{n}_MAX") for n in range(1, MOTORS + 1))
"""Pairs of which the first must be smaller. Their defaults are their extremes, so that two values that fit each other
may be set one after the other in any order."""


class ParamError(ValueError):
    """An unknown name or a value that is not allowed; the message is one clear line."""


class Params:
    """The settings in force. They live in memory; vehicle/storage/param_store.py keeps what is set."""

    def __init__(
        self,
        values: Mapping[str, float] | None = None,
        *,
        pinned: Collection[str] = (),
        usual: Mapping[str, float] | None = None,
        run: Mapping[str, float] | None = None,
    ) -> None:
        """Defaults, with `values` in their place. Raises ParamError.

        No ground station changes the `pinned`; a reset goes back to what this `run` was given, else to what is `usual`
        for this car.
        """
        self.pinned = frozenset(pinned)
        self.run_values = dict(run or {})
        """What the command line says; it ends with the program."""
        self._usual = dict(usual or {})
        self.generation = 0
        """Grows with each value that is put in force: what was derived from values may be kept until then."""
        self._damage: str | None = None
        self._unannounced: set[str] = set()
        self._values = {parameter.name: float(parameter.default) for parameter in TABLE}
        for name, value in (values or {}).items():
            self.set(name, value)

    @property
    def table(self) -> tuple[Parameter, ...]:
        """TABLE as ground stations see it: what is pinned is read only, and the defaults are this car's."""
        usual, pinned = self._usual, self.pinned
        return tuple(
            replace(each, read_only=each.read_only or each.name in pinned, default=usual.get(each.name, each.default))
            for each in TABLE
        )

    @property
    def damage(self) -> str | None:
        """Why saved values are lost; arming is refused until a parameter is set."""
        return self._damage

    def mark_damaged(self, reason: str | None) -> None:
        """Record why saved values are lost."""
        self._damage = reason

    def clear_damage(self) -> None:
        """Allow arming again: a parameter was set since the saved values were lost."""
        self._damage = None

    def pop_unannounced(self) -> list[str]:
        """Return the names that changed and that no PARAM_VALUE has announced, sorted; the list is empty then."""
        names = sorted(self._unannounced)
        self._unannounced.clear()
        return names

    def set_unannounced(self, names: Iterable[str]) -> None:
        """Announce exactly these changes."""
        self._unannounced = set(names)

    def mark_announced(self, name: str) -> None:
        """Leave out a change that its own PARAM_VALUE announces."""
        self._unannounced.discard(name)

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def set(self, name: str, value: float) -> None:
        """Put a value in force. Raises ParamError and changes nothing."""
        parameter = PARAMETERS.get(name)
        if parameter is None:
            raise ParamError(f"no parameter {name!r}")
        if not math.isfinite(value) or not parameter.low <= value <= parameter.high:
            raise ParamError(f"{name} must be {parameter.low:g} to {parameter.high:g}, not {value:g}")
        if parameter.whole and value != int(value):
            raise ParamError(f"{name} must be a whole number, not {value:g}")
        self._check_order({**self._values, name: value})
        self._values[name] = float(value)
        self.generation += 1
        self._unannounced.add(name)

    @staticmethod
    def _check_order(values: Mapping[str, float]) -> None:
        for small, large in ORDERED_PAIRS:
            if values[small] >= values[large]:
                raise ParamError(f"{small} {values[small]:g} must be smaller than {large} {values[large]:g}")


def merge_params(
    given: Mapping[str, float],
    *,
    kept: Mapping[str, float],
    usual: Mapping[str, float],
    pinned: Collection[str] = (),
    run: Mapping[str, float] | None = None,
) -> tuple[Params, list[str]]:
    """Defaults, what is `usual` for this car, what was `kept`, what is `given` now: the later wins. `run` is what of
    the given ends with the program.

    Raises ParamError for what is given. What was kept and does not fit is left out, a line each: it comes from another
    version of this program, or the file of settings has changed since, and no ground station could mend it.
    """
    Params({**usual, **given})  # they fit each other, whatever is kept
    first = {name: value for name, value in usual.items() if name not in kept}
    params = Params({**first, **given}, pinned=pinned, usual=usual, run=run)
    left_out = []
    for name, value in kept.items():
        if name not in given:
            try:
                params.set(name, value)
            except ParamError as error:
                left_out.append(str(error))
    return params, left_out
