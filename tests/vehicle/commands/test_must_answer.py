"""What the vehicle answers to whom in which state: one row for each case of each command.

The access and broadcast rules are tested for every row of the command table; a command without a row here fails a test.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Command, MissionType, Result, command_name
from dialects.modes import Mode
from link.core import LinkReport
from tests.rows import each_row
from tests.vehicle.bench import AHEAD, DRIVER, EVERYTHING, NEUTRAL, OTHER, Bench, Equipped, logged, said
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec

C, R = Command, Result
NAN, INF = math.nan, math.inf
NOWHERE, SOMEWHERE = (0, 0), (481_000_000, 115_000_000)
"""DO_REPOSITION: degrees x 1e7; EVERYTHING is in the second place."""

REQUESTABLE = (
    0,
    1,
    24,
    30,
    32,
    33,
    36,
    49,
    65,
    74,
    147,
    148,
    242,
    244,
    300,
    376,
    397,
    435,
    436,
    512,
    46001,
    46002,
    46003,
    46004,
)
"""Messages that everybody may ask for and that there is something to tell of."""
NEEDS_A_SENSOR = (24, 30, 32, 33, 49, 147)
NOTHING_TO_TELL = (62, 162)
"""... and those that tell of a mode that drives by itself, and of a fence that counts."""


def free() -> Bench:
    """Disarmed, and nobody in control."""
    bench = Equipped(REBOOT_ENABLE=2)
    bench.heartbeat()
    bench.heartbeat(OTHER)
    return bench


def owned() -> Bench:
    """Disarmed, DRIVER in control."""
    bench = free()
    assert bench.arm() is R.ACCEPTED
    assert bench.command(C.COMPONENT_ARM_DISARM, 0) is R.ACCEPTED
    return bench


def armed() -> Bench:
    bench = owned()
    bench.drive()
    return bench


def stopped() -> Bench:
    """Emergency stop."""
    bench = owned()
    bench.command(C.DO_SET_SAFETY_SWITCH_STATE, 0)
    return bench


def ended() -> Bench:
    """Terminated."""
    bench = owned()
    bench.command(C.DO_FLIGHTTERMINATION, 1)
    return bench


def broken() -> Bench:
    bench = owned()
    bench.rover.motor_failed("broken", bench.now)
    return bench


def unreported() -> Bench:
    """Just begun: no link has said anything of itself."""
    return Bench()


def placed() -> Bench:
    """Disarmed, with every sensor and a mission of two places."""
    bench = owned()
    bench.readings = EVERYTHING
    bench.wait(3.0)
    bench.rover.observe([LinkReport("udpin:127.0.0.1:14550", audience=(bench.station,))], bench.now)
    for message in (
        m.MissionCount(1, 1, 2, MissionType.MISSION),
        *(m.MissionItemInt(1, 1, index, 6, C.NAV_WAYPOINT, 0, 1, 0, 0, 0, NAN, *SOMEWHERE, 0, 0) for index in (0, 1)),
    ):
        bench.say(message)
    assert bench.newest(m.MissionAck).type == 0
    return bench


def ready() -> Bench:
    """The same, armed in MANUAL."""
    bench = placed()
    assert bench.arm() is R.ACCEPTED, bench.texts
    bench.wait(0.1, NEUTRAL)
    return bench


def guided() -> Bench:
    bench = ready()
    assert bench.set_mode(Mode.GUIDED) is R.ACCEPTED
    return bench


def guarded() -> Bench:
    """... with a fence that counts."""
    bench = guided()
    assert bench.command(C.DO_FENCE_ENABLE, 1) is R.ACCEPTED
    return bench


@dataclass(frozen=True)
class Row:
    """COMMAND_LONG, or COMMAND_INT where `place` is given."""

    command: int
    params: tuple[float, ...]
    result: Result | None
    """None: no answer at all."""
    state: Callable[[], Bench] = owned
    who: int = DRIVER
    introduced: bool = True
    target: int = 1
    place: tuple[int, int] | None = None
    frame: int = 6

    def __str__(self) -> str:
        name = C(self.command).name if self.command in C._value2member_map_ else str(self.command)
        who = {DRIVER: "driver", OTHER: "other"}[self.who] if self.introduced else "stranger"
        words = ",".join(f"{value:g}" for value in self.params)
        return f"{name}({words}) {who} {self.state.__name__} {self.target} {self.place or ''}"


def other(command: int, params: tuple[float, ...], result: Result, state: Callable[[], Bench] = owned) -> Row:
    """By a ground station that is not in control."""
    return Row(command, params, result, state, who=OTHER)


def stranger(command: int, params: tuple[float, ...], result: Result, state: Callable[[], Bench] = free) -> Row:
    """By somebody who has shown no HEARTBEAT."""
    return Row(command, params, result, state, introduced=False)


def everybody(command: int, params: tuple[float, ...], result: Result | None) -> Row:
    """To all systems."""
    return Row(command, params, result, target=0)


def reposition(params: tuple[float, ...], result: Result, place: tuple[int, int] = SOMEWHERE, frame: int = 6,
               state: Callable[[], Bench] = guided, who: int = DRIVER) -> Row:  # fmt: skip
    return Row(C.DO_REPOSITION, params, result, state, who, place=place, frame=frame)


ARM, MODE, STANDARD, SWITCH = (
    C.COMPONENT_ARM_DISARM, C.DO_SET_MODE, C.DO_SET_STANDARD_MODE, C.DO_SET_SAFETY_SWITCH_STATE)  # fmt: skip

ORIGIN, HERE = C.DO_SET_GLOBAL_ORIGIN, (0, 0, 0, 0, 48.1, 11.5, 500)

ROWS: tuple[Row, ...] = (
    Row(65535, (), R.UNSUPPORTED), Row(521, (1,), R.UNSUPPORTED),
    other(65535, (), R.UNSUPPORTED), stranger(65535, (), R.UNSUPPORTED), everybody(65535, (), None),
    # Arming: of the driver; disarming: of everybody
    Row(ARM, (1,), R.ACCEPTED), Row(ARM, (1,), R.ACCEPTED, free), Row(ARM, (1,), R.ACCEPTED, armed),
    other(ARM, (1,), R.FAILED), other(ARM, (1,), R.ACCEPTED, free), stranger(ARM, (1,), R.FAILED),
    everybody(ARM, (1,), None), everybody(ARM, (0,), R.ACCEPTED),
    Row(ARM, (0,), R.ACCEPTED, armed), other(ARM, (0,), R.ACCEPTED, armed), stranger(ARM, (0,), R.ACCEPTED, armed),
    Row(ARM, (1, 21196), R.FAILED, stopped), Row(ARM, (1, 21196), R.FAILED, ended), Row(ARM, (1,), R.FAILED, broken),
    Row(ARM, (0,), R.ACCEPTED, stopped), Row(ARM, (2,), R.DENIED), Row(ARM, (NAN,), R.DENIED),
    Row(ARM, (0.5,), R.DENIED),
    Row(C.RUN_PREARM_CHECKS, (), R.ACCEPTED), other(C.RUN_PREARM_CHECKS, (), R.ACCEPTED, stopped),
    Row(C.RUN_PREARM_CHECKS, (), R.TEMPORARILY_REJECTED, armed),
    # Modes: of the driver; HOLD: of everybody
    Row(MODE, (1, Mode.GUIDED), R.ACCEPTED), Row(MODE, (1, Mode.GUIDED), R.ACCEPTED, free),
    other(MODE, (1, Mode.MANUAL), R.FAILED), stranger(MODE, (1, Mode.MANUAL), R.FAILED),
    other(MODE, (1, Mode.HOLD), R.ACCEPTED, armed), stranger(MODE, (1, Mode.HOLD), R.ACCEPTED, armed),
    everybody(MODE, (1, Mode.HOLD), R.ACCEPTED), everybody(MODE, (1, Mode.MANUAL), None),
    Row(MODE, (1, Mode.STEERING), R.DENIED), Row(MODE, (1, NAN), R.DENIED), Row(MODE, (0, Mode.HOLD), R.DENIED),
    Row(MODE, (1, Mode.RTL), R.FAILED), Row(MODE, (1, Mode.RTL), R.ACCEPTED, placed),
    Row(MODE, (1, Mode.ACRO), R.FAILED), Row(MODE, (1, Mode.ACRO), R.ACCEPTED, placed),
    Row(MODE, (129, 4, 3), R.ACCEPTED), Row(MODE, (129, 4, 4), R.ACCEPTED, placed), Row(MODE, (129, 4, 5), R.FAILED),
    Row(MODE, (129, 6), R.ACCEPTED), Row(MODE, (129, 4, 9), R.DENIED), Row(MODE, (129, 7), R.DENIED),
    Row(MODE, (1, Mode.GUIDED, *(NAN,) * 5), R.ACCEPTED), Row(MODE, (129, 4, NAN), R.ACCEPTED),
    Row(STANDARD, (5,), R.ACCEPTED, placed), Row(STANDARD, (6,), R.ACCEPTED, placed), Row(STANDARD, (5,), R.FAILED),
    Row(STANDARD, (1,), R.FAILED), Row(STANDARD, (0,), R.FAILED), Row(STANDARD, (NAN,), R.DENIED),
    other(STANDARD, (5,), R.FAILED, placed),
    # Stops: of everybody; their end: of the driver
    Row(C.DO_FLIGHTTERMINATION, (1,), R.ACCEPTED, armed), other(C.DO_FLIGHTTERMINATION, (1,), R.ACCEPTED, armed),
    stranger(C.DO_FLIGHTTERMINATION, (1,), R.ACCEPTED, armed), everybody(C.DO_FLIGHTTERMINATION, (1,), R.ACCEPTED),
    Row(C.DO_FLIGHTTERMINATION, (NAN,), R.FAILED), Row(C.DO_FLIGHTTERMINATION, (0.5,), R.FAILED),
    Row(SWITCH, (0,), R.ACCEPTED, armed), other(SWITCH, (0,), R.ACCEPTED, armed),
    stranger(SWITCH, (0,), R.ACCEPTED, armed), everybody(SWITCH, (0,), R.ACCEPTED), everybody(SWITCH, (1,), None),
    Row(SWITCH, (1,), R.ACCEPTED, stopped), other(SWITCH, (1,), R.FAILED, stopped),
    stranger(SWITCH, (1,), R.FAILED, stopped), Row(SWITCH, (1,), R.FAILED, ended),
    Row(SWITCH, (2,), R.DENIED), Row(SWITCH, (NAN,), R.DENIED),
    # Driving by itself: of the driver; pausing: of everybody
    Row(C.DO_PAUSE_CONTINUE, (0,), R.ACCEPTED, guided), other(C.DO_PAUSE_CONTINUE, (0,), R.ACCEPTED, guided),
    stranger(C.DO_PAUSE_CONTINUE, (0,), R.ACCEPTED, armed), Row(C.DO_PAUSE_CONTINUE, (1,), R.ACCEPTED, guided),
    Row(C.DO_PAUSE_CONTINUE, (1,), R.FAILED, armed), other(C.DO_PAUSE_CONTINUE, (1,), R.FAILED, guided),
    Row(C.DO_PAUSE_CONTINUE, (NAN,), R.DENIED), Row(C.DO_PAUSE_CONTINUE, (2,), R.DENIED),
    Row(C.MISSION_START, (), R.ACCEPTED, ready), Row(C.MISSION_START, (1, 1), R.ACCEPTED, ready),
    Row(C.MISSION_START, (), R.FAILED, placed), Row(C.MISSION_START, (), R.FAILED, armed),
    Row(C.MISSION_START, (2,), R.DENIED, ready), Row(C.MISSION_START, (NAN,), R.DENIED, ready),
    Row(C.MISSION_START, (0, 7), R.DENIED, ready), Row(C.MISSION_START, (0, *(NAN,) * 6), R.ACCEPTED, ready),
    other(C.MISSION_START, (), R.FAILED, ready),
    Row(C.DO_SET_MISSION_CURRENT, (1,), R.ACCEPTED, placed), Row(C.DO_SET_MISSION_CURRENT, (2,), R.DENIED, placed),
    Row(C.DO_SET_MISSION_CURRENT, (1, *(NAN,) * 6), R.ACCEPTED, placed),
    Row(C.DO_SET_MISSION_CURRENT, (NAN,), R.DENIED, placed), other(C.DO_SET_MISSION_CURRENT, (1,), R.FAILED, placed),
    reposition((-1, 0), R.ACCEPTED), reposition((-1, 1), R.ACCEPTED, state=ready), reposition((NAN, 1), R.ACCEPTED),
    reposition((1.0, 0), R.ACCEPTED, frame=0), reposition((-1, 0), R.UNSUPPORTED_FRAME, frame=1),
    reposition((-1, 0), R.DENIED, state=ready), reposition((-1, 2), R.DENIED), reposition((-1, NAN), R.ACCEPTED),
    reposition((-1, NAN), R.DENIED, state=ready),
    reposition((INF, 0), R.DENIED), reposition((-2, 0), R.DENIED), reposition((-1, 0), R.DENIED, NOWHERE),
    reposition((-1, 0), R.DENIED, (910_000_000, 0)), reposition((-1, 0), R.DENIED, (2**31 - 1, 2**31 - 1)),
    reposition((-1, 1), R.FAILED, state=placed), reposition((-1, 1), R.FAILED, state=armed),
    reposition((-1, 0), R.FAILED, who=OTHER), Row(C.DO_REPOSITION, (-1, 0, 0, NAN, 48.1, 11.5), R.INT_ONLY, guided),
    Row(C.DO_CHANGE_SPEED, (1, 0.5), R.ACCEPTED), Row(C.DO_CHANGE_SPEED, (0, -1), R.ACCEPTED),
    Row(C.DO_CHANGE_SPEED, (1, -2), R.ACCEPTED), Row(C.DO_CHANGE_SPEED, (1, 99), R.ACCEPTED),
    Row(C.DO_CHANGE_SPEED, (1, NAN), R.DENIED), Row(C.DO_CHANGE_SPEED, (1, -3), R.DENIED),
    Row(C.DO_CHANGE_SPEED, (2, 1), R.DENIED), other(C.DO_CHANGE_SPEED, (1, 0.5), R.FAILED),
    Row(C.DO_SET_HOME, (1,), R.ACCEPTED, placed), Row(C.DO_SET_HOME, (1,), R.FAILED),
    Row(C.DO_SET_HOME, (0, 0, 0, 0, 48.1, 11.5, 500), R.ACCEPTED, placed), Row(C.DO_SET_HOME, (0,), R.DENIED, placed),
    Row(C.DO_SET_HOME, (0, NAN, NAN, NAN, 48.1, 11.5, NAN), R.ACCEPTED, placed),
    Row(C.DO_SET_HOME, (0, 0, 0, 0, NAN, 11.5, 500), R.DENIED, placed), Row(C.DO_SET_HOME, (2,), R.DENIED),
    Row(C.DO_SET_HOME, (0,), R.UNSUPPORTED_FRAME, placed, place=SOMEWHERE, frame=1),
    other(C.DO_SET_HOME, (1,), R.FAILED, placed),
    Row(ORIGIN, HERE, R.ACCEPTED, placed), Row(ORIGIN, (), R.ACCEPTED, placed, place=SOMEWHERE),
    Row(ORIGIN, HERE, R.TEMPORARILY_REJECTED, ready), Row(ORIGIN, HERE, R.FAILED),
    other(ORIGIN, HERE, R.FAILED, placed), stranger(ORIGIN, HERE, R.FAILED), Row(ORIGIN, (), R.DENIED, placed),
    Row(ORIGIN, (*HERE[:4], NAN, 11), R.DENIED), Row(ORIGIN, (*HERE[:4], 48, 11.5), R.FAILED, placed),
    Row(ORIGIN, (), R.DENIED, placed, place=(2**31 - 1, 2**31 - 1)),
    Row(ORIGIN, (), R.UNSUPPORTED_FRAME, placed, place=SOMEWHERE, frame=1),
    Row(C.NAV_RETURN_TO_LAUNCH, (), R.ACCEPTED, ready), Row(C.NAV_RETURN_TO_LAUNCH, (), R.FAILED, armed),
    other(C.NAV_RETURN_TO_LAUNCH, (), R.FAILED, ready),
    Row(C.DO_SET_REVERSE, (1,), R.ACCEPTED), Row(C.DO_SET_REVERSE, (0,), R.ACCEPTED),
    Row(C.DO_SET_REVERSE, (NAN,), R.DENIED), Row(C.DO_SET_REVERSE, (2,), R.DENIED),
    other(C.DO_SET_REVERSE, (1,), R.FAILED),
    Row(C.DO_FENCE_ENABLE, (1,), R.ACCEPTED), Row(C.DO_FENCE_ENABLE, (0,), R.ACCEPTED),
    Row(C.DO_FENCE_ENABLE, (2,), R.UNSUPPORTED), Row(C.DO_FENCE_ENABLE, (3,), R.DENIED),
    Row(C.DO_FENCE_ENABLE, (NAN,), R.DENIED), other(C.DO_FENCE_ENABLE, (0,), R.FAILED),
    # Motors one by one and accessories
    Row(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.ACCEPTED), Row(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.ACCEPTED, free),
    Row(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.TEMPORARILY_REJECTED, armed),
    Row(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.FAILED, stopped), Row(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.FAILED, broken),
    Row(C.DO_MOTOR_TEST, (1, 0, 31, 1), R.DENIED), Row(C.DO_MOTOR_TEST, (1, 0, 20, 4), R.DENIED),
    other(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.FAILED), stranger(C.DO_MOTOR_TEST, (1, 0, 20, 1), R.FAILED),
    Row(C.ACTUATOR_TEST, (0.2, 1, 0, 0, 1), R.ACCEPTED), Row(C.ACTUATOR_TEST, (NAN, 0, 0, 0, 1), R.ACCEPTED),
    Row(C.ACTUATOR_TEST, (0.2, 1, 0, 0, 1), R.TEMPORARILY_REJECTED, armed),
    Row(C.ACTUATOR_TEST, (0.2, 1, 0, 0, 1), R.FAILED, ended), Row(C.ACTUATOR_TEST, (0.4, 1, 0, 0, 1), R.DENIED),
    Row(C.ACTUATOR_TEST, (0.2, NAN, 0, 0, 1), R.DENIED), other(C.ACTUATOR_TEST, (0.2, 1, 0, 0, 1), R.FAILED),
    Row(C.DO_SET_SERVO, (9, 1700), R.ACCEPTED), Row(C.DO_SET_SERVO, (9, 1700), R.ACCEPTED, free),
    Row(C.DO_SET_SERVO, (9, 1700), R.ACCEPTED, armed), Row(C.DO_SET_SERVO, (9, 1700), R.FAILED, stopped),
    Row(C.DO_SET_SERVO, (9, 1700), R.FAILED, ended), Row(C.DO_SET_SERVO, (9, 1700), R.ACCEPTED, broken),
    Row(C.DO_SET_SERVO, (9, 1700), R.ACCEPTED, place=NOWHERE),
    *(Row(C.DO_SET_SERVO, (number, 1500), R.DENIED) for number in (1, 3, 0, -1, 5, 9.5, 17, NAN, INF)),
    *(Row(C.DO_SET_SERVO, (9, width), R.DENIED) for width in (0, 1099, 1901, 1e9, NAN, INF)),
    other(C.DO_SET_SERVO, (9, 1500), R.FAILED), stranger(C.DO_SET_SERVO, (9, 1500), R.FAILED),
    Row(C.DO_SET_SERVO, (9, 1500), R.DENIED, Bench), everybody(C.DO_SET_SERVO, (9, 1500), None),
    Row(C.DO_REPEAT_SERVO, (9, 1700, 3, 0.5), R.ACCEPTED), Row(C.DO_REPEAT_SERVO, (9, 1700, 3, 0), R.ACCEPTED, armed),
    Row(C.DO_REPEAT_SERVO, (1, 1700, 3, 1), R.DENIED), Row(C.DO_REPEAT_SERVO, (9, 2000, 3, 1), R.DENIED),
    *(Row(C.DO_REPEAT_SERVO, (9, 1700, times, 1), R.DENIED) for times in (0, -1, 1.5, 1001, NAN, INF)),
    *(Row(C.DO_REPEAT_SERVO, (9, 1700, 3, period), R.DENIED) for period in (-1, 3601, NAN, INF)),
    Row(C.DO_REPEAT_SERVO, (9, 1700, 3, 1), R.FAILED, stopped), other(C.DO_REPEAT_SERVO, (9, 1700, 3, 1), R.FAILED),
    Row(C.DO_SET_RELAY, (0, 1), R.ACCEPTED), Row(C.DO_SET_RELAY, (0, 0), R.ACCEPTED, free),
    Row(C.DO_SET_RELAY, (0, 1), R.ACCEPTED, armed), Row(C.DO_SET_RELAY, (0, 1), R.FAILED, stopped),
    Row(C.DO_SET_RELAY, (1, 1), R.ACCEPTED, stopped), Row(C.DO_SET_RELAY, (2, 1), R.ACCEPTED, armed),
    Row(C.DO_SET_RELAY, (2, 1), R.FAILED), Row(C.DO_SET_RELAY, (2, 1), R.FAILED, broken),
    *(Row(C.DO_SET_RELAY, (number, 1), R.DENIED) for number in (3, -1, 0.5, 99, NAN, INF)),
    *(Row(C.DO_SET_RELAY, (0, state), R.DENIED) for state in (2, -1, 0.5, NAN, INF)),
    other(C.DO_SET_RELAY, (0, 1), R.FAILED), stranger(C.DO_SET_RELAY, (0, 1), R.FAILED),
    Row(C.DO_SET_RELAY, (0, 1), R.DENIED, Bench), everybody(C.DO_SET_RELAY, (0, 1), None),
    Row(C.DO_REPEAT_RELAY, (0, 3, 0.5), R.ACCEPTED), Row(C.DO_REPEAT_RELAY, (0, 3, 0.5), R.FAILED, stopped),
    Row(C.DO_REPEAT_RELAY, (2, 3, 0.5), R.FAILED), Row(C.DO_REPEAT_RELAY, (7, 3, 0.5), R.DENIED),
    Row(C.DO_REPEAT_RELAY, (0, 0, 0.5), R.DENIED), Row(C.DO_REPEAT_RELAY, (0, 3, NAN), R.DENIED),
    other(C.DO_REPEAT_RELAY, (0, 3, 0.5), R.FAILED),
    # Standing still
    Row(C.PREFLIGHT_STORAGE, (0,), R.ACCEPTED), Row(C.PREFLIGHT_STORAGE, (1,), R.FAILED),
    Row(C.PREFLIGHT_STORAGE, (2,), R.ACCEPTED), Row(C.PREFLIGHT_STORAGE, (3,), R.DENIED),
    Row(C.PREFLIGHT_STORAGE, (2,), R.TEMPORARILY_REJECTED, armed), other(C.PREFLIGHT_STORAGE, (2,), R.FAILED),
    Row(C.PREFLIGHT_CALIBRATION, (1,), R.IN_PROGRESS, placed), Row(C.PREFLIGHT_CALIBRATION, (1,), R.FAILED),
    Row(C.PREFLIGHT_CALIBRATION, (1, *(NAN,) * 6), R.IN_PROGRESS, placed),
    Row(C.PREFLIGHT_CALIBRATION, (0, 1), R.UNSUPPORTED), Row(C.PREFLIGHT_CALIBRATION, (NAN,), R.UNSUPPORTED),
    Row(C.PREFLIGHT_CALIBRATION, (1, 1), R.UNSUPPORTED, placed), other(C.PREFLIGHT_CALIBRATION, (1,), R.FAILED),
    Row(C.PREFLIGHT_CALIBRATION, (1,), R.TEMPORARILY_REJECTED, armed),
    Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (1,), R.ACCEPTED), Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (0, 2), R.ACCEPTED),
    Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (1,), R.FAILED, armed), Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (1,), R.DENIED, Bench),
    Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (3,), R.DENIED), Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (), R.DENIED),
    Row(C.PREFLIGHT_REBOOT_SHUTDOWN, (2, *(NAN,) * 6), R.ACCEPTED),
    other(C.PREFLIGHT_REBOOT_SHUTDOWN, (1,), R.FAILED), stranger(C.PREFLIGHT_REBOOT_SHUTDOWN, (1,), R.FAILED),
    # Control
    Row(C.REQUEST_OPERATOR_CONTROL, (1,), R.ACCEPTED, free), Row(C.REQUEST_OPERATOR_CONTROL, (1, 1), R.ACCEPTED),
    Row(C.REQUEST_OPERATOR_CONTROL, (0,), R.ACCEPTED), other(C.REQUEST_OPERATOR_CONTROL, (1,), R.FAILED),
    other(C.REQUEST_OPERATOR_CONTROL, (0,), R.FAILED), stranger(C.REQUEST_OPERATOR_CONTROL, (1,), R.FAILED),
    Row(C.REQUEST_OPERATOR_CONTROL, (2,), R.DENIED), Row(C.REQUEST_OPERATOR_CONTROL, (1, 0, 0, 9), R.DENIED),
    Row(C.REQUEST_OPERATOR_CONTROL, (NAN,), R.DENIED), Row(C.REQUEST_OPERATOR_CONTROL, (1, *(NAN,) * 6), R.ACCEPTED),
    # Questions: of everybody who has shown a HEARTBEAT
    *(other(C.REQUEST_MESSAGE, (number,), R.ACCEPTED, placed) for number in REQUESTABLE),
    *(other(C.REQUEST_MESSAGE, (number,), R.FAILED, placed) for number in NOTHING_TO_TELL),
    *(Row(C.REQUEST_MESSAGE, (number,), R.FAILED) for number in NEEDS_A_SENSOR),
    *(other(C.REQUEST_MESSAGE, (number,), R.ACCEPTED, guarded) for number in NOTHING_TO_TELL),
    Row(C.REQUEST_MESSAGE, (9999,), R.UNSUPPORTED), Row(C.REQUEST_MESSAGE, (NAN,), R.DENIED),
    Row(C.REQUEST_MESSAGE, (-1,), R.DENIED), Row(C.REQUEST_MESSAGE, (4294967040.0,), R.DENIED),
    Row(C.REQUEST_MESSAGE, (242,), R.FAILED), Row(C.REQUEST_MESSAGE, (435, *(NAN,) * 6), R.ACCEPTED),
    Row(C.REQUEST_MESSAGE, (376,), R.FAILED, Bench),
    Row(C.REQUEST_MESSAGE, (46003,), R.FAILED, unreported), everybody(C.REQUEST_MESSAGE, (148,), R.ACCEPTED),
    stranger(C.REQUEST_MESSAGE, (148,), R.TEMPORARILY_REJECTED),
    other(C.SET_MESSAGE_INTERVAL, (30, 1), R.ACCEPTED), Row(C.SET_MESSAGE_INTERVAL, (30, -1), R.ACCEPTED),
    Row(C.SET_MESSAGE_INTERVAL, (30, 0), R.ACCEPTED), Row(C.SET_MESSAGE_INTERVAL, (9999, 1), R.DENIED),
    Row(C.SET_MESSAGE_INTERVAL, (30, NAN), R.DENIED), Row(C.SET_MESSAGE_INTERVAL, (30, -2), R.DENIED),
    stranger(C.SET_MESSAGE_INTERVAL, (30, 1), R.TEMPORARILY_REJECTED),
    other(C.GET_MESSAGE_INTERVAL, (30,), R.ACCEPTED), Row(C.GET_MESSAGE_INTERVAL, (NAN,), R.DENIED),
    stranger(C.GET_MESSAGE_INTERVAL, (30,), R.TEMPORARILY_REJECTED),
    other(C.REQUEST_PROTOCOL_VERSION, (1,), R.ACCEPTED), Row(C.REQUEST_PROTOCOL_VERSION, (NAN,), R.DENIED),
    other(C.REQUEST_AUTOPILOT_CAPABILITIES, (1,), R.ACCEPTED), Row(C.REQUEST_AUTOPILOT_CAPABILITIES, (0,), R.DENIED),
    other(C.GET_HOME_POSITION, (), R.ACCEPTED, placed), Row(C.GET_HOME_POSITION, (), R.FAILED),
    # Camera: there is none; with one: test_camera.py
    other(C.VIDEO_START_STREAMING, (0,), R.UNSUPPORTED), other(C.VIDEO_STOP_STREAMING, (0,), R.UNSUPPORTED),
    stranger(C.VIDEO_START_STREAMING, (0,), R.TEMPORARILY_REJECTED),
    other(C.REQUEST_CAMERA_INFORMATION, (1,), R.UNSUPPORTED),
    other(C.REQUEST_VIDEO_STREAM_INFORMATION, (0,), R.UNSUPPORTED),
    other(C.REQUEST_VIDEO_STREAM_STATUS, (0,), R.UNSUPPORTED),
    other(C.DO_SEND_BANNER, (), R.ACCEPTED), stranger(C.DO_SEND_BANNER, (), R.TEMPORARILY_REJECTED),
)  # fmt: skip


@pytest.mark.slow
@each_row("row", ROWS, ids=str)
def test_the_answer(row: Row) -> None:
    bench = row.state()
    answers = len(bench.all(m.CommandAck))
    one, two, three, four, five, six, seven = (*row.params, *(0.0,) * (7 - len(row.params)))
    message: m.Message = m.CommandLong(row.target, 1, row.command, 0, one, two, three, four, five, six, seven)
    if row.place is not None:
        message = m.CommandInt(row.target, 1, row.frame, row.command, 0, 0, one, two, three, four, *row.place, seven)
    bench.say(message, row.who, introduced=row.introduced)
    found = bench.all(m.CommandAck)[answers:]
    assert [each.result for each in found] == ([] if row.result is None else [row.result])
    assert all((each.command, each.target_system, each.target_component) == (row.command, row.who, 190)
               for each in found)  # fmt: skip


COMMANDS = Bench().rover.commands


def test_every_command_that_is_answered_has_a_line() -> None:
    known = {row.command for row in COMMANDS}
    assert {command_name(each) for each in known} == {command_name(row.command) for row in ROWS if row.command in known}


def test_every_command_has_one_row_in_the_table() -> None:
    assert len({row.command for row in COMMANDS}) == len(COMMANDS)


def named(row: CommandSpec) -> str:
    return command_name(row.command)


UNCLEAR = (NAN,) * 7
"""Parameters that stop nothing."""


@pytest.mark.slow
@each_row("row", [each for each in COMMANDS if each.access is Access.DRIVER_OR_UNCLAIMED], ids=named)
@pytest.mark.parametrize("state", [owned, armed, stopped], ids=lambda each: str(each.__name__))
def test_a_command_of_the_driver_is_denied_to_all_others(row: CommandSpec, state: Callable[[], Bench]) -> None:
    bench = state()
    assert bench.command(row.command, *UNCLEAR, system=OTHER) is R.FAILED
    assert bench.command(row.command, *UNCLEAR, introduced=False) is R.FAILED
    bench.wait(1.0)  # texts wait for their turn
    assert said(bench, f"GCS {OTHER}: {command_name(row.command)} refused: GCS {DRIVER} is in control")
    assert logged(bench, f"{command_name(row.command)} refused: no HEARTBEAT received")


@pytest.mark.parametrize("row", [each for each in COMMANDS if each.access is Access.INTRODUCED], ids=named)
def test_a_command_that_needs_a_heartbeat_is_denied_without_one(row: CommandSpec) -> None:
    bench = free()
    assert bench.command(row.command, *UNCLEAR, introduced=False) is R.FAILED
    assert logged(bench, f"{command_name(row.command)} refused: no HEARTBEAT received")


@each_row("row", [each for each in COMMANDS if each.access is Access.CONNECTED], ids=named)
def test_a_request_without_heartbeat_is_rejected_for_now(row: CommandSpec) -> None:
    assert free().command(row.command, introduced=False) is R.TEMPORARILY_REJECTED


@each_row("row", COMMANDS, ids=named)
def test_a_broadcast_is_answered_only_where_the_row_accepts_it(row: CommandSpec) -> None:
    answered = owned().command(row.command, *UNCLEAR, target=0) is not None
    assert answered == (row.broadcast and row.stops is None)


def test_only_these_commands_are_accepted_as_broadcast() -> None:
    accepted = {row.command for row in COMMANDS if row.broadcast}
    assert accepted == {ARM, MODE, SWITCH, C.DO_FLIGHTTERMINATION, C.REQUEST_MESSAGE}
    assert {row.command for row in COMMANDS if row.broadcast and row.stops} == {ARM, MODE, SWITCH}


def test_each_line_says_something_else() -> None:
    assert len({str(row) + str(row.frame) for row in ROWS}) == len(ROWS)


IGNORED = (126, 233, 248, 385)
"""SERIAL_CONTROL (a shell, elsewhere), GPS_RTCM_DATA, V2_EXTENSION, TUNNEL. DEVICE_OP_READ and _WRITE are in no dialect
of ours."""


@pytest.mark.parametrize("number", IGNORED)
@pytest.mark.parametrize("fill", [0, 1, 255])
def test_what_is_for_others_is_ignored(number: int, fill: int) -> None:
    bench = armed()
    kind = m.MESSAGES[number]
    payload = bytearray([fill]) * kind.unpacker.size
    message = codec.decode(number, bytes(payload))
    for name in ("target_system", "target_component"):
        if hasattr(message, name):
            setattr(message, name, 1)
    sent = len(bench.sent)
    bench.say(message)
    bench.say(message, OTHER, introduced=False)
    assert bench.sent[sent:] == []
    bench.wait(0.1, AHEAD)
    assert bench.throttles == (1.0, 1.0)


def test_device_op_is_unknown() -> None:
    assert not {11000, 11002} & set(m.MESSAGES)
