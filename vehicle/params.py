"""TABLE: every parameter of the vehicle with name, default, range, unit and description; and their values in force.

Names are ArduRover's if it has the same parameter, at most 16 characters. Every value is a float, because only REAL32
parameters are read alike by all ground stations. Saving is vehicle/storage/param_store.py.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping

import msgspec
from msgspec.structs import replace

from link.toml.errors import suggest


class Parameter(msgspec.Struct, frozen=True):
    """One parameter. Those of failsafes, interlocks and limits are `safety`: never changed while armed."""

    name: str
    default: float
    low: float
    high: float
    unit: str
    description: str
    safety: bool = False
    whole: bool = False
    """Takes whole numbers only."""
    needs_reboot: bool = False
    """Takes effect after a restart."""
    read_only: bool = False
    """No ground station may set it: it must match the hardware, or rover.toml pins it."""
    remote_high: float | None = None
    """Largest value that a ground station may set; a larger one only in rover.toml or by --param. None: `high`."""


MOTORS = 4
"""Motors with parameters of their own: as many as the largest DRIVE_TYPE has."""


def _motor(number: int) -> tuple[Parameter, ...]:
    """Return the output parameters of one motor (vehicle/drive/output_scaling.py), numbered as in `Mixer.motors`."""
    name = f"MOT{number}"
    return (
        Parameter(f"{name}_REVERSED", 0, 0, 1, "", f"1 reverses motor {number}",
                  safety=True, whole=True),
        Parameter(f"{name}_MIN", 0, 0, 80, "%", f"Smallest output that turns motor {number}; not for steering servos",
                  safety=True),
        Parameter(f"{name}_MAX", 100, 25, 100, "%", f"Largest output of motor {number}; lower it on the faster side to "
                  "drive straight", safety=True),
        Parameter(f"{name}_TRIM", 0, -20, 20, "%", f"Added to the output of motor {number}: the centre of a steering "
                  "servo; for a drive motor only while it turns", safety=True),
    )  # fmt: skip


RANGEFINDERS = 4


def _rangefinder(number: int) -> tuple[Parameter, ...]:
    """Return the parameters of one rangefinder of this computer (vehicle/proximity/mounting.py)."""
    name = f"RNGFND{number}"
    return (
        Parameter(f"{name}_ORIENT", 0, 0, 7, "", f"Rangefinder {number} looks: 0 ahead, then in steps of 45 degrees to "
                  "the right; 4 is behind", safety=True, whole=True),
        Parameter(f"{name}_MIN", 0, 0, 10, "m", f"Rangefinder {number}: what is nearer counts as 0 m", safety=True),
        Parameter(f"{name}_MAX", 0, 0, 100, "m", f"Rangefinder {number}: ignore what is farther; 0: its own range",
                  safety=True),
    )  # fmt: skip


BUTTONS = 16
"""Bits of MANUAL_CONTROL's `buttons`."""

TABLE: tuple[Parameter, ...] = (
    # Identity
    Parameter("MAV_SYSID", 1, 1, 255, "", "System id of this vehicle", whole=True, needs_reboot=True),
    Parameter("MAV_GCS_SYSID", 0, 0, 255, "", "System id of the only ground station that may take control; 0: any",
              safety=True, whole=True),
    Parameter("REBOOT_ENABLE", 0, 0, 2, "", "PREFLIGHT_REBOOT_SHUTDOWN: 0 denied, 1 restarts this program, 2 also "
              "reboots or shuts down the computer on board", whole=True, read_only=True),
    # Manual driving
    Parameter("MAN_TIMEOUT", 0.45, 0.2, 2, "s", "A demand older than this is neutral: 9 frames at 20 Hz. Below 0.5 s, "
              "so that the wheels slow down by then; above it only in rover.toml", safety=True, remote_high=0.5),
    Parameter("MAN_DEADBAND", 3, 0, 20, "%", "Demands smaller than this are neutral", safety=True),
    Parameter("MANUAL_EXPO", 0, 0, 0.9, "", "Expo of throttle and sideways demand; 0 is linear"),
    Parameter("MANUAL_STR_EXPO", 0, 0, 0.9, "", "Expo of steering; 0 is linear"),
    Parameter("INITIAL_MODE", 0, 0, 4, "", "Mode after the start: 0 MANUAL, 4 HOLD", whole=True),
    Parameter("OPR_TIMEOUT", 10, 2, 60, "s", "Stop after this long without a key or stick event while moving",
              safety=True),
    Parameter("OPR_ECHO_MAX", 0.45, 0.2, 5, "s", "A demand is rejected if the newest telemetry that its sender has "
              "seen is older than this; for slow radios higher, above 0.5 s only in rover.toml", safety=True,
              remote_high=0.5),
    *(Parameter(f"BTN{bit}_FUNCTION", 0, 0, 7, "", f"Button {bit} of MANUAL_CONTROL, when pressed: 0 none, "
                "1 arm, 2 disarm, 3 emergency stop, 4 HOLD, 5 MANUAL, 6 AUTO, 7 RTL", safety=True, whole=True)
      for bit in range(BUTTONS)),
    # Failsafes
    Parameter("FRESH_DIST", 2, 0, 1000, "m", "Slow down so that the rover drives at most this far after the newest "
              "command was sent; 0: off", safety=True),
    Parameter("STOP_LAG", 0.2, 0, 2, "s", "For this long the wheels follow their motors: m driven after the motors are "
              "at zero, divided by the speed before", safety=True),
    Parameter("FS_TIMEOUT", 1.5, 0.5, 10, "s", "From loss of manual control to HOLD", safety=True),
    Parameter("FS_DISARM_T", 30, 5, 300, "s", "From loss of manual control to disarming", safety=True),
    Parameter("FS_GCS_ENABLE", 1, 0, 2, "", "Ground station lost: 0 no action, 1 HOLD, 2 HOLD except in AUTO",
              safety=True, whole=True),
    Parameter("FS_GCS_TIMEOUT", 5, 2, 120, "s", "The ground station in control is lost after this long in silence",
              safety=True),
    Parameter("FS_LOOP_TIMEOUT", 0.2, 0.1, 2, "s", "Disarm if a control cycle is later than this", safety=True),
    Parameter("FS_LOW_ACT", 2, 0, 2, "", "Battery low: 0 slow down, 2 slow down and HOLD", safety=True, whole=True),
    Parameter("BATT_LOW_VOLT", 10.5, 0, 100, "V", "Battery low below this; 0: off", safety=True),
    Parameter("BATT_CRT_VOLT", 10.0, 0, 100, "V", "Battery critical below this; 0: off", safety=True),
    Parameter("BATT_LOW_TIMER", 10, 1, 120, "s", "The voltage must be low for this long; motors lower it briefly",
              safety=True),
    Parameter("FS_PI_ACT", 2, 0, 2, "", "Pi too hot or undervoltage: 0 report only, 1 slow down, 2 slow down and HOLD",
              safety=True, whole=True),
    Parameter("FS_PI_TEMP", 85, 0, 110, "degC", "The Pi is too hot above this; a Pi throttles itself at 85; 0: off",
              safety=True),
    Parameter("FS_PI_TIMER", 10, 1, 120, "s", "From slowing down to HOLD, while heat or undervoltage lasts",
              safety=True),
    Parameter("DISARM_DELAY", 300, 0, 3600, "s", "Disarm after this long without a demand; 0: never", safety=True),
    Parameter("GUIDED_TIMEOUT", 1, 0.2, 5, "s", "Stop if the velocity setpoint of GUIDED is older than this",
              safety=True),
    Parameter("CRASH_ANGLE", 45, 0, 80, "deg", "Disarm if tilted more than this for 0.5 s; 0: off", safety=True),
    Parameter("FS_CRASH_CHECK", 1, 0, 2, "", "Blocked: throttle for 2 s without motion: 0 none, 1 HOLD, 2 disarm",
              safety=True, whole=True),
    Parameter("FENCE_ENABLE", 0, 0, 1, "", "1 enables the fence", safety=True, whole=True),
    Parameter("FENCE_TYPE", 6, 0, 6, "", "Bits: 2 circle around home, 4 uploaded areas", safety=True, whole=True),
    Parameter("FENCE_ACTION", 2, 0, 2, "", "Fence breach: 0 report only, 1 RTL, 2 HOLD", safety=True, whole=True),
    Parameter("FENCE_RADIUS", 100, 1, 10000, "m", "Radius of the circle around home", safety=True),
    Parameter("FENCE_MARGIN", 1, 0, 10, "m", "Autonomous modes stop this far before the fence", safety=True),
    Parameter("AVOID_ENABLE", 3, 0, 3, "", "Bits: 1 stops autonomous modes before the fence (FENCE_MARGIN), 2 stops "
              "all modes before obstacles (AVOID_MARGIN)", safety=True, whole=True),
    Parameter("AVOID_MARGIN", 0.3, 0.05, 10, "m", "Distance to keep from obstacles", safety=True),
    Parameter("AVOID_ACCEL_MAX", 3, 0, 9, "m/s/s", "Braking before obstacles, at most as MOT_DECEL; 0: as MOT_DECEL",
              safety=True),
    Parameter("AVOID_LOST_SPD", 0.2, 0, 1, "m/s", "Speed toward where a range sensor has failed", safety=True),
    Parameter("PRX1_TYPE", 0, 0, 2, "", "Obstacles from companions: 0 none, 2 by DISTANCE_SENSOR and "
              "OBSTACLE_DISTANCE, which must arrive", safety=True, whole=True),
    Parameter("PRX1_ORIENT", 0, 0, 1, "", "OBSTACLE_DISTANCE: 0 sensor upright, 1 upside down", safety=True,
              whole=True),
    Parameter("PRX1_YAW_CORR", 0, -180, 180, "deg", "OBSTACLE_DISTANCE: turn its directions to the right", safety=True),
    Parameter("PRX1_MIN", 0, 0, 10, "m", "OBSTACLE_DISTANCE: ignore what is nearer, as parts of the rover; 0: nothing",
              safety=True),
    Parameter("PRX1_MAX", 0, 0, 100, "m", "OBSTACLE_DISTANCE: ignore what is farther; 0: nothing", safety=True),
    *(parameter for number in range(1, RANGEFINDERS + 1) for parameter in _rangefinder(number)),
    # Autonomous modes
    Parameter("WP_SPEED", 0.8, 0.1, 30, "m/s", "Speed along a path; SPEED_MAX is never exceeded"),
    Parameter("WP_RADIUS", 0.5, 0.1, 20, "m", "A waypoint without a stop is reached at this distance"),
    Parameter("WP_PIVOT_ANGLE", 60, 10, 180, "deg", "Pivot at corners sharper than this"),
    Parameter("WP_PIVOT_RATE", 60, 5, 360, "deg/s", "Turn rate of a pivot turn"),
    Parameter("RTL_SPEED", 0, 0, 30, "m/s", "Speed in RTL and SMART_RTL; 0: WP_SPEED"),
    Parameter("RALLY_LIMIT_KM", 0.5, 0, 100, "km", "RTL uses rally points within this distance; 0: any distance"),
    Parameter("RALLY_INCL_HOME", 1, 0, 1, "", "1: RTL uses home if it is nearer than the rally points", whole=True),
    Parameter("LOIT_RADIUS", 1, 0.3, 20, "m", "LOITER drives back beyond this distance; radius of circles"),
    Parameter("ACRO_TURN_RATE", 180, 10, 720, "deg/s", "Turn rate at full steering in ACRO"),
    Parameter("TURN_RADIUS", 0.55, 0.1, 30, "m", "Turning radius at full steering, with steered wheels"),
    Parameter("CRUISE_SPEED", 0.75, 0.05, 30, "m/s", "Speed at CRUISE_THROTTLE"),
    Parameter("CRUISE_THROTTLE", 50, 5, 100, "%", "Throttle that gives CRUISE_SPEED"),
    Parameter("ATC_ACCEL_MAX", 1, 0.1, 10, "m/s/s", "Acceleration along a path"),
    Parameter("ATC_DECEL_MAX", 1, 0.1, 10, "m/s/s", "Braking along a path", safety=True),
    Parameter("ATC_STOP_SPEED", 0.1, 0.01, 1, "m/s", "Below this speed the rover counts as standing", safety=True),
    Parameter("ATC_SPEED_P", 0.2, 0, 2, "", "Speed control: throttle per m/s of error"),
    Parameter("ATC_SPEED_I", 0.2, 0, 2, "", "Speed control: throttle per m of integrated error"),
    Parameter("ATC_STR_ANG_P", 2, 0.5, 10, "", "Heading control: rad/s per rad of error"),
    Parameter("ATC_STR_RAT_MAX", 120, 10, 720, "deg/s", "Largest turn rate in autonomous modes", safety=True),
    Parameter("ATC_TURN_MAX_G", 0.6, 0.1, 10, "g", "Largest lateral acceleration in autonomous modes; lower it "
              "for rovers that may tip over", safety=True),
    Parameter("ATC_STR_RAT_P", 0.1, 0, 2, "", "Turn rate control: steering per rad/s of error"),
    Parameter("ATC_STR_RAT_I", 0.2, 0, 2, "", "Turn rate control: steering per rad of integrated error"),
    Parameter("ATC_STR_RAT_FF", 0.23, 0, 3, "", "Turn rate control: feed-forward steering per rad/s"),
    # Motors
    Parameter("DRIVE_TYPE", 1, 1, 4, "", "1 skid steering, 2 Ackermann, 3 omni, 4 mecanum; "
              "set it in rover.toml or on the command line", whole=True,
              needs_reboot=True, read_only=True),
    Parameter("MOT_SLEWRATE", 250, 10, 1000, "%/s", "Acceleration of each motor", safety=True),
    Parameter("MOT_DECEL", 250, 250, 10000, "%/s", "Deceleration of each motor; 250: full to zero in 0.4 s",
              safety=True),
    Parameter("MOT_THR_MAX", 100, 30, 100, "%", "Largest throttle", safety=True),
    Parameter("MOT_STR_THR_MIX", 0.5, 0.2, 1, "", "Skid steering at saturation: higher favours steering",
              safety=True),
    Parameter("MOT_TEST_MAX", 30, 0, 30, "%", "Largest throttle of DO_MOTOR_TEST and ACTUATOR_TEST; 0: no motor "
              "tests", safety=True),
    Parameter("MOT_REV_DELAY", 0, 0, 1, "s", "Pause at zero before a motor reverses", safety=True),
    Parameter("MOT_PIVOT_MAX", 100, 10, 100, "%", "Largest output of a pivot turn; curves are in between",
              safety=True),
    Parameter("MOT_THST_EXPO", 0, -1, 1, "", "Thrust curve of drive motors; 0 is linear, higher is more at half",
              safety=True),
    Parameter("MOT_THST_ASYM", 1, 1, 10, "", "Skid steering: ratio of forward to reverse thrust of a motor",
              safety=True),
    *(parameter for number in range(1, MOTORS + 1) for parameter in _motor(number)),
    # Logs
    Parameter("LOG_BACKEND_TYPE", 1, 0, 1, "", "Telemetry logs: 0 none, 1 files", whole=True),
    Parameter("LOG_DISARMED", 0, 0, 1, "", "0: log from arming until 15 s after disarming, 1: always", whole=True),
    Parameter("LOG_MAX_FILES", 500, 2, 500, "", "Beyond this number of logs the oldest is removed", whole=True),
    Parameter("LOG_FILE_MB_FREE", 500, 10, 1000, "MB", "Below this free space the oldest logs are removed",
              whole=True),
    # Shape
    Parameter("SPEED_MAX", 1.5, 0.1, 30, "m/s", "Top speed", safety=True),
    Parameter("TRACK_WIDTH", 0.35, 0.05, 5, "m", "Distance between left and right wheels"),
    Parameter("BODY_LENGTH", 0.4, 0.05, 10, "m", "Length of the rover with all that sticks out", safety=True),
    Parameter("BODY_WIDTH", 0.4, 0.05, 10, "m", "Width of the rover with all that sticks out", safety=True),
    Parameter("WHEELBASE", 0.3, 0.05, 5, "m", "Distance between front and rear axles"),
)  # fmt: skip

PARAMETERS: dict[str, Parameter] = {parameter.name: parameter for parameter in TABLE}


def suggest_parameter(name: str) -> str:
    """Return which parameters may be meant, or where all of them are listed."""
    return suggest(name, PARAMETERS, "`mavhelm vehicle dialect` lists all")


SAFETY_PARAMETERS: tuple[str, ...] = tuple(parameter.name for parameter in TABLE if parameter.safety)
"""The parameters that are locked while armed."""

ORDERED_PAIRS: tuple[tuple[str, str], ...] = tuple((f"MOT{n}_MIN", f"MOT{n}_MAX") for n in range(1, MOTORS + 1))
"""Pairs whose first value must be smaller. Their defaults are their extremes, so that two values that fit each other
can be set in any order."""


class ParamError(ValueError):
    """An unknown name or an invalid value; the message is one line."""


class Params:
    """The values in force, in memory; vehicle/storage/param_store.py saves what is set."""

    def __init__(
        self,
        values: Mapping[str, float] | None = None,
        *,
        pinned: Collection[str] = (),
        usual: Mapping[str, float] | None = None,
        run: Mapping[str, float] | None = None,
    ) -> None:
        """Start with the defaults and apply `values`. Raises ParamError.

        No ground station may set the `pinned` names. A reset restores the values of this `run`, else the `usual` ones
        of this car, else the defaults.
        """
        self.pinned = frozenset(pinned)
        self.run_values = dict(run or {})
        """Values of the command line; they end with the program."""
        self._usual = dict(usual or {})
        self.generation = 0
        """Increases with each change: a cached value derived from parameters is valid until then."""
        self._damage: str | None = None
        self._unannounced: set[str] = set()
        self._values = {parameter.name: float(parameter.default) for parameter in TABLE}
        for name, value in (values or {}).items():
            self.set(name, value)

    @property
    def table(self) -> tuple[Parameter, ...]:
        """TABLE for ground stations: pinned parameters are read only, the defaults are those of this car."""
        return tuple(map(self._for_stations, TABLE))

    def _for_stations(self, parameter: Parameter) -> Parameter:
        own = (
            parameter.read_only or parameter.name in self.pinned,
            self.get_default(parameter.name),
            parameter.high if parameter.remote_high is None else parameter.remote_high,
        )
        if own == (parameter.read_only, parameter.default, parameter.high):
            return parameter
        read_only, default, high = own
        return replace(parameter, read_only=read_only, default=default, high=high)

    def get_default(self, name: str) -> float:
        """Return the default of a parameter for this car."""
        return self._usual.get(name, PARAMETERS[name].default)

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
        """Do not announce a change that its PARAM_VALUE already reports."""
        self._unannounced.discard(name)

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def set(self, name: str, value: float) -> None:
        """Set a value. Raises ParamError and changes nothing if it is invalid."""
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
