"""KINDS and DRIVEN: the kinds of vehicles by MAV_TYPE and MAV_AUTOPILOT, and those of them that keys drive.

Only what neutral demands, HOLD and disarming stop is driven. Every other kind is shown, with one line why it is not
driven. To drive another kind, give it a row in DRIVEN, and its axes (dialects/axes.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import msgspec

from dialects import rover
from dialects.axes import (
    ARDUPILOT_DEAD,
    AXIS_MAPS,
    CLIMB_SPAN,
    COPTER_AXES,
    HOVER,
    PX4_COPTER_AXES,
    PX4_DEAD,
    AxisMap,
    axis_map,
)
from dialects.enums import Autopilot, ModeFlag, VehicleType, type_name
from dialects.mode_tables import (
    ARDUPILOT,
    AUTO_MAIN,
    COPTER,
    HOLD,
    PX4,
    PX4_ALIASES,
    ROVER,
    VTOL,
    ModeTable,
    px4_number,
)
from dialects.modes import Mode

NO_VEHICLES = frozenset(
    {
        rover.MAV_TYPE_GCS,
        rover.MAV_TYPE_ONBOARD_CONTROLLER,
        rover.MAV_TYPE_GIMBAL,
        rover.MAV_TYPE_ADSB,
        rover.MAV_TYPE_CAMERA,
        rover.MAV_TYPE_CHARGING_STATION,
        rover.MAV_TYPE_FLARM,
        rover.MAV_TYPE_SERVO,
        rover.MAV_TYPE_ODID,
        rover.MAV_TYPE_BATTERY,
        rover.MAV_TYPE_PARACHUTE,
        rover.MAV_TYPE_LOG,
        rover.MAV_TYPE_OSD,
        rover.MAV_TYPE_IMU,
        rover.MAV_TYPE_GPS,
        rover.MAV_TYPE_WINCH,
        rover.MAV_TYPE_ILLUMINATOR,
        rover.MAV_TYPE_GRIPPER,
        49,  # MAV_TYPE_RADIO, newer than pymavlink 2.4.50
    }
)
"""MAV_TYPEs that are not a vehicle: parts of one, and what only looks at vehicles.

Many of them name an autopilot in their HEARTBEAT: a gimbal that of its vehicle, a script on board GENERIC.
MAV_TYPE_GENERIC and ANTENNA_TRACKER are missing here, because autopilots send them.
"""

AUTOPILOT_COMPONENT: int = rover.MAV_COMP_ID_AUTOPILOT1
"""Component id of the autopilot of a vehicle; a second autopilot or a script on board has another one."""

MANUAL = "MANUAL"
"""The mode in which the demand goes to the motors, of all autopilots that have one."""


class SpeedParam(msgspec.Struct, frozen=True):
    """A parameter that says how fast full deflection is."""

    name: str
    scale: float = 1.0
    """Its unit in m/s or deg/s."""


class AxisLimits(msgspec.Struct, frozen=True):
    """Which parameters say what a full demand asks for: the first that the vehicle has counts."""

    speed: tuple[SpeedParam, ...] = ()
    climb: tuple[SpeedParam, ...] = ()
    turn: tuple[SpeedParam, ...] = ()

    @property
    def all(self) -> tuple[SpeedParam, ...]:
        """All of them."""
        return (*self.speed, *self.climb, *self.turn)


class VehicleKind(msgspec.Struct, frozen=True):
    """One kind of vehicle of one autopilot. The default is a kind that is only shown."""

    word: str
    """What it is called, e.g. "rover"."""
    refusal: str = ""
    """Why keys, setpoints and modes by number do not drive it, in one line; "" if they do."""
    modes: ModeTable = {}
    """custom_mode -> name, also of modes that are not selectable."""
    aliases: Mapping[str, str] = {}
    """Other names of these modes -> name."""
    keys: frozenset[str] = frozenset()
    """Names of the modes in which the driver's demand moves it."""
    standing: frozenset[str] = frozenset()
    """Names of the modes in which it stays where it is. Every mode in neither set is autonomous."""
    hidden: frozenset[str] = frozenset()
    """Names of modes that nobody selects."""
    arms_only_in_manual: bool = False
    """It changes to MANUAL before arming from every mode; others only from a standing one, where no demand counts."""
    hold_moves: bool = False
    """Its HOLD keeps a place by driving, instead of keeping the motors neutral."""
    falls: bool = False
    """Without power it falls: the emergency stop of one that is in the air asks first."""
    axes: AxisMap = COPTER_AXES
    """Its axes and their neutral, as dialects.axes.axis_map returns them; those of what flies for every other kind."""
    drive_mode: str = MANUAL
    """The mode to which arming changes, and the key of MANUAL."""
    land: str = ""
    """The mode that lands it: what the emergency stop means in the air. "" for what does not fly."""
    home: str = ""
    """The mode that flies home and lands there."""
    thrust: frozenset[str] = frozenset()
    """Names of the modes in which the throttle is thrust, so that no demand goes out, not even a neutral one."""
    limits: AxisLimits = AxisLimits()
    instruments: tuple[str, ...] = ()
    """Names of the instruments of its own, beside those of all."""

    @property
    def flies(self) -> bool:
        """Whether keys fly it."""
        return bool(self.land)

    def takes_neutral(self, mode: str) -> bool:
        """Return whether a neutral demand may go out in this mode: with thrust for throttle it would be a command."""
        return not self.flies or (mode in self.modes.values() and mode not in self.thrust)

    @property
    def is_driven(self) -> bool:
        """Whether keys drive it."""
        return not self.refusal

    def mode_name(self, custom_mode: int) -> str:
        """Return the name of a HEARTBEAT's custom_mode; "mode 99" for a number that is not known."""
        return self.modes.get(custom_mode) or f"mode {custom_mode}"

    def number_of(self, name: str) -> int | None:
        """Return the custom_mode of a name or an alias in any case; None if this kind has no such mode."""
        wanted = name.upper()
        wanted = self.aliases.get(wanted, wanted)
        return next((number for number, each in self.modes.items() if each == wanted), None)

    @property
    def choices(self) -> dict[str, int]:
        """Name -> custom_mode of what the operator may select; empty for a kind that is not driven."""
        if not self.is_driven:
            return {}
        return {name: number for number, name in self.modes.items() if name not in self.hidden}

    def moves_itself(self, mode: str) -> bool:
        """Return whether it may move without demands in this mode; also in one that is not known."""
        return mode not in self.keys and mode not in self.standing


_STANDING = frozenset({HOLD, Mode.INITIALISING.name})
_ROVER_KEYS = frozenset(mode.name for mode in Mode if mode.flag & ModeFlag.MANUAL)
_PX4_KEYS = frozenset({MANUAL, "ALTCTL", "POSCTL", "POSCTL_SLOW", "ACRO", "STABILIZED"})
_PX4_ROVER_MODES = (
    *(px4_number(main) for main in (1, 2, 3, 5, 6, 7)),
    *(px4_number(AUTO_MAIN, sub) for sub in (3, 4, 5)),
)
"""custom_mode of what a rover of PX4 has."""

_ROVER = VehicleKind(
    "rover", modes=ROVER, keys=_ROVER_KEYS, standing=_STANDING, hidden=frozenset({Mode.INITIALISING.name})
)
"""Of ArduRover. Our own vehicle, and what follows its definitions, has the same modes."""
_PX4_ROVER = VehicleKind(
    "rover", modes=PX4, aliases=PX4_ALIASES, keys=_PX4_KEYS, standing=_STANDING, arms_only_in_manual=True,
    hold_moves=True, hidden=frozenset(name for number, name in PX4.items() if number not in _PX4_ROVER_MODES),
)  # fmt: skip

_ARDUPILOT_CLIMB = (CLIMB_SPAN - ARDUPILOT_DEAD) / (HOVER - ARDUPILOT_DEAD)
_PX4_CLIMB = (CLIMB_SPAN - PX4_DEAD) / (HOVER - PX4_DEAD)
"""Share of its own full climb that our full demand asks for."""

_COPTER_THRUST = frozenset(
    {"STABILIZE", "ACRO", "DRIFT", "FLIP", "THROW", "TURTLE", "SYSTEMID", "AUTOROTATE", "RATE_ACRO", "GUIDED_NOGPS"}
)
_ARDU_COPTER = VehicleKind(
    "copter", modes=COPTER, aliases={MANUAL: "LOITER", HOLD: "BRAKE"},
    keys=frozenset({"LOITER", "POSHOLD", "ALT_HOLD"}), standing=frozenset({"BRAKE"}), falls=True,
    drive_mode="LOITER", land="LAND", home="RTL", thrust=_COPTER_THRUST,
    hidden=_COPTER_THRUST | {"SPORT", "POSITION", "OF_LOITER", "AUTOTUNE", "AVOID_ADSB", "AUTO_RTL"},
    limits=AxisLimits(
        (SpeedParam("LOIT_SPEED_MS"), SpeedParam("LOIT_SPEED", 0.01)),
        (SpeedParam("PILOT_SPD_UP", _ARDUPILOT_CLIMB), SpeedParam("PILOT_SPEED_UP", 0.01 * _ARDUPILOT_CLIMB)),
        (SpeedParam("PILOT_Y_RATE"),),
    ),
    instruments=("flight",),
)  # fmt: skip
"""Keys fly it in what holds altitude: LOITER and POSHOLD keep the place, too, ALT_HOLD drifts with the wind."""
_PX4_THRUST = frozenset({MANUAL, "ACRO", "STABILIZED", "RATTITUDE", "TERMINATION", "OFFBOARD"})
_PX4_COPTER_MODES = (
    *(px4_number(main) for main in (2, 3)), px4_number(3, 2), *(px4_number(AUTO_MAIN, sub) for sub in (2, 3, 4, 5, 6)),
)  # fmt: skip
"""custom_mode of what the operator may select of a multicopter of PX4."""
_PX4_COPTER = VehicleKind(
    "copter", modes=PX4, aliases={**PX4_ALIASES, MANUAL: "POSCTL"}, keys=frozenset({"ALTCTL", "POSCTL", "POSCTL_SLOW"}),
    standing=frozenset({HOLD}), falls=True, hold_moves=True, drive_mode="POSCTL", land="AUTO_LAND", home="AUTO_RTL",
    axes=PX4_COPTER_AXES, thrust=_PX4_THRUST,
    hidden=frozenset(name for number, name in PX4.items() if number not in _PX4_COPTER_MODES),
    limits=AxisLimits(
        (SpeedParam("MPC_VEL_MANUAL"),), (SpeedParam("MPC_Z_VEL_MAX_UP", _PX4_CLIMB),), (SpeedParam("MPC_MAN_Y_MAX"),)
    ),
    instruments=("flight",),
)  # fmt: skip

DRIVEN: Mapping[tuple[str, int], VehicleKind] = {
    **{
        (word, autopilot): msgspec.structs.replace(kind, word=word, axes=AXIS_MAPS[autopilot])
        for word in ("rover", "boat")
        for autopilot, kind in (
            (Autopilot.GENERIC, _ROVER),
            (Autopilot.ARDUPILOT, _ROVER),
            (Autopilot.PX4, _PX4_ROVER),
        )
    },
    ("copter", Autopilot.ARDUPILOT): _ARDU_COPTER,
    ("copter", Autopilot.PX4): _PX4_COPTER,
}
"""Word of KINDS and MAV_AUTOPILOT -> the kinds that keys drive."""


class TypeRow(msgspec.Struct, frozen=True):
    """What is known of a MAV_TYPE."""

    word: str
    """What it is called."""
    why: str
    """Completes "keys do not drive a WORD: ", for a kind without a row in DRIVEN."""
    falls: bool = False
    """See VehicleKind."""


KINDS: Mapping[int, TypeRow] = {
    VehicleType.GROUND_ROVER: TypeRow("rover", "its autopilot is not known"),
    VehicleType.SURFACE_BOAT: TypeRow("boat", "its autopilot is not known"),
    **dict.fromkeys(
        (
            rover.MAV_TYPE_QUADROTOR, rover.MAV_TYPE_HEXAROTOR, rover.MAV_TYPE_OCTOROTOR, rover.MAV_TYPE_TRICOPTER,
            rover.MAV_TYPE_DECAROTOR, rover.MAV_TYPE_DODECAROTOR, rover.MAV_TYPE_GENERIC_MULTIROTOR,
        ),
        TypeRow("copter", "a released key lets it fall", falls=True),
    ),
    **dict.fromkeys(
        (rover.MAV_TYPE_HELICOPTER, rover.MAV_TYPE_COAXIAL, rover.MAV_TYPE_VTOL_GYRODYNE),
        TypeRow("helicopter", "a released key lets it fall", falls=True),
    ),
    **dict.fromkeys(
        (
            rover.MAV_TYPE_FIXED_WING, rover.MAV_TYPE_FLAPPING_WING, rover.MAV_TYPE_PARAFOIL, rover.MAV_TYPE_KITE,
        ),
        TypeRow("plane", "it cannot stand still", falls=True),
    ),
    **dict.fromkeys(VTOL, TypeRow("VTOL plane", "it cannot stand still", falls=True)),
    **dict.fromkeys(
        (rover.MAV_TYPE_AIRSHIP, rover.MAV_TYPE_FREE_BALLOON),
        TypeRow("airship", "no neutral stops it", falls=True),
    ),
    rover.MAV_TYPE_ROCKET: TypeRow("rocket", "no neutral stops it", falls=True),
    rover.MAV_TYPE_SUBMARINE: TypeRow("submarine", "two axes are not enough for it"),
    rover.MAV_TYPE_ANTENNA_TRACKER: TypeRow("antenna tracker", "it does not drive"),
}  # fmt: skip
"""MAV_TYPE -> what it is. A type without a row is not driven: what stops it is not known."""


@lru_cache(maxsize=256)
def find_kind(autopilot: int, kind: int) -> VehicleKind:
    """Return the kind of a vehicle with these MAV_AUTOPILOT and MAV_TYPE."""
    row = KINDS.get(kind)
    modes, aliases, axes = _modes(autopilot, kind), _aliases(autopilot), axis_map(autopilot, kind)
    if row is None:
        return VehicleKind("vehicle", _unknown(kind), modes, aliases, axes=axes, falls=True)
    driven = DRIVEN.get((row.word, autopilot))
    if driven is not None:
        return driven
    refusal = f"keys do not drive a {row.word}: {row.why}"
    return VehicleKind(row.word, refusal, modes, aliases, axes=axes, falls=row.falls)


DRIVEN_WORDS = "rovers, boats and multicopters"
"""What keys drive, in a text."""


def _unknown(kind: int) -> str:
    if kind == rover.MAV_TYPE_GENERIC:
        return f"keys drive {DRIVEN_WORDS}, and this one does not say what it is (MAV_TYPE 0)"
    return f"keys drive {DRIVEN_WORDS}, and this is a {type_name(kind)} (MAV_TYPE {kind})"


def _modes(autopilot: int, kind: int) -> ModeTable:
    """Return the names of the modes of a vehicle that is only shown."""
    return PX4 if autopilot == Autopilot.PX4 else ARDUPILOT.get(kind, {}) if autopilot == Autopilot.ARDUPILOT else {}


def _aliases(autopilot: int) -> Mapping[str, str]:
    return PX4_ALIASES if autopilot == Autopilot.PX4 else {}
