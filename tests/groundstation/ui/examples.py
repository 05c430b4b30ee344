"""Snapshots to draw, and a station that only notes what it is asked: for the tests of the screen."""

from __future__ import annotations

import math
import socket
from array import array
from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from groundstation.intents.session import RenewLease, ReportScreen, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.snapshot import (
    LinkView,
    LogLine,
    OperatorView,
    OutputView,
    Snapshot,
    StationOutage,
    VehicleView,
)
from groundstation.snapshot.drive import HealthLine, KeyToMotor, MissionProgress, StopBound, Timing
from groundstation.views.base import View
from groundstation.views.charts import FieldId, FieldInfo
from groundstation.views.drive import SpeedView, TrackRequest, TrackView
from groundstation.views.log import LogPage
from groundstation.views.messages import FieldPlot, MessageField, MessageRow, MessagesPage, MessageView
from groundstation.views.params import ParamPage, ParamRow
from groundstation.views.requests import RequestLine

NOON = 1_700_000_000.0
"""A wall clock for log lines; the tests run in UTC."""

Wanted = TypeVar("Wanted")


def _ignore(*intents: AnyIntent) -> None:
    """Do nothing with intents."""


class Recorder:
    """The connection of a screen: passes intents on and keeps them, gives what it was offered; its descriptor is real.

    A station in virtual time has one, whose `handle` is its own.
    """

    def __init__(self, handle: Callable[..., None] = _ignore) -> None:
        self._handle = handle
        self.intents: list[AnyIntent] = []
        self.alive = True
        self.outage = StationOutage()
        self._waiting: list[Snapshot] = []
        self._views: list[View] = []
        self._ours, self._theirs = socket.socketpair()
        self._ours.setblocking(False)

    def send(self, *intents: AnyIntent) -> None:
        """Note them, and let the station handle them at once."""
        self.intents += intents
        self._handle(*intents)

    def filenos(self) -> list[int]:
        """Readable after `offer`."""
        return [self._ours.fileno()] if self.alive else []

    def receive(self) -> Snapshot | None:
        """The newest offered."""
        if not self._waiting:
            return None
        self._ours.recv(1 << 16)
        newest = self._waiting[-1]
        self._waiting.clear()
        return newest

    def pop_views(self) -> list[View]:
        """The views that were offered since the last call."""
        views, self._views = self._views, []
        return views

    def offer_view(self, view: View) -> bool:
        """Let this view come with the next snapshot. Returns True, as a connection that took it."""
        self._views.append(view)
        return True

    def offer(self, snapshot: Snapshot) -> None:
        """Let this be the newest snapshot."""
        self._waiting.append(snapshot)
        self._theirs.send(b"!")

    def close(self) -> None:
        """Give the descriptors back."""
        self._ours.close()
        self._theirs.close()

    @property
    def wishes(self) -> list[AnyIntent]:
        """The intents without the beat, the gate and the names of screens."""
        return [intent for intent in self.intents if not isinstance(intent, (RenewLease, SetKeyGate, ReportScreen))]

    def of(self, kind: type[Wanted]) -> list[Wanted]:
        """Those of one kind."""
        return [intent for intent in self.intents if isinstance(intent, kind)]


def path(count: int = 160) -> tuple[tuple[float, float], ...]:
    """A drive with two bends and a loop, (north, east) in m."""
    points = []
    north = east = 0.0
    for step in range(count):
        heading = 0.6 + 1.1 * math.sin(step / 18) + step / 70
        north, east = north + 0.22 * math.cos(heading), east + 0.22 * math.sin(heading)
        points.append((north, east))
    return tuple(points)


def wheels(left: float, right: float) -> tuple[OutputView, ...]:
    """The outputs of a rover with skid steering."""
    return OutputView(name="left wheel", value=left), OutputView(name="right wheel", value=right)


WAY = KeyToMotor(Timing(0.0003, 0.0009), Timing(0.0058, 0.009), Timing(0.0021, 0.011), Timing(0.0082, 0.021))
FOREIGN_WAY = KeyToMotor(Timing(0.0003, 0.0009), Timing(0.004, 0.01), Timing(0.11, 0.19), Timing(0.12, 0.2))
STOPS = (
    StopBound("no command", "neutral", "MAN_TIMEOUT", 0.45, 0.042),
    StopBound("no command", "HOLD", "FS_TIMEOUT", 1.95, 0.042),
    StopBound("no station", "HOLD", "FS_GCS_TIMEOUT", 5.0, 0.62),
    StopBound("no key", "neutral", "OPR_TIMEOUT", 10.0, 6.1),
    StopBound("fence", "nothing", "FENCE_ENABLE", never=True, unit="m"),
    StopBound("battery", "HOLD", "BATT_LOW_VOLT", 10.5, 11.82, unit="V"),
    StopBound("tilt", "disarm", "CRASH_ANGLE", 45.0, 3.4, unit="deg"),
)
FOREIGN_STOPS = (
    StopBound("no command", "nothing", "RC_OVERRIDE_TIME", never=True),
    StopBound("... no RC", "nothing", "FS_THR_ENABLE", never=True),
    StopBound("... no RC", "--", "FS_TIMEOUT"),
    StopBound("no station", "HOLD", "FS_GCS_ENABLE", 6.5, 0.4, estimated=True),
)
HEALTH = (
    HealthLine("logging", "not healthy", False), HealthLine("battery", "11.8 V  2.4 A  76%", True),
    HealthLine("gps", "3D, 14 satellites, hdop 0.8", True), HealthLine("estimate", "good, within 0.4 m", True),
    HealthLine("computer", "load 41%, 52 °C", True), HealthLine("gyro", "ok", True), HealthLine("motors", "ok", True),
    HealthLine("fence", "off", None),
)  # fmt: skip
MISSION = MissionProgress(
    current=4, last=7, command="LOITER_TIME 10 s", distance=14.9, legs=(20.0, 30.0, 12.5, 40.0, 28.0),
    places=(2, 3, 4, 6, 7), left=82.9, time_left=98.0,
)  # fmt: skip


def vehicle(**changes: Any) -> VehicleView:
    """A rover that drives a curve, armed, with everything known."""
    track = path()
    view = VehicleView(
        system=1, name="Rover 1", autopilot=0, mode="MANUAL", armed=True, status=4, alive=True, silence=0.1, driver=255,
        in_control=True, position=track[-1], home=(0.0, 0.0), heading=2.4, roll=0.06, pitch=-0.03,
        speed=0.84, battery_voltage=11.82, battery_current=2.4, battery_remaining=0.76, gps_fix=3, gps_satellites=14,
        demand=(0.58, 0.24), outputs=wheels(0.71, 0.46), limits=("slew",), command_age=0.042, latency=0.0013,
        speed_demand=0.9, key_to_motor=WAY, stops=STOPS, health=HEALTH, mission=MISSION,
    )  # fmt: skip
    return msgspec.structs.replace(view, **changes)


def helm(**changes: Any) -> OperatorView:
    """A driver who holds `o`."""
    view = OperatorView(
        style="hold", reports_releases=True, stop_bound=0.0, held=("o",), throttle=0.6, steering=0.25,
        throttle_limit=0.6, steering_limit=0.6, gate_open=True, sending=True, rate=20.0,
    )  # fmt: skip
    return msgspec.structs.replace(view, **changes)


TRACK = TrackView(1, path())
SPEEDS = SpeedView(
    1,
    tuple((step / 2, 0.9 * (1 - math.exp(-(step % 40) / 6)), 0.9 if step % 40 < 34 else 0.0) for step in range(120)),
)
"""What the Drive screen gets beside the snapshot."""

DRIVE_WATCH = Watch((TrackRequest(),))
"""What it requests at 80x24."""

TEXTS = (
    LogLine(time=NOON, severity=6, label="vehicle", text="rover 1, mavhelm vehicle 0.1, MANUAL"),
    LogLine(time=NOON + 1, severity=6, label="ack", text="COMPONENT_ARM_DISARM accepted"),
    LogLine(time=NOON + 20, severity=4, label="vehicle", text="battery 11.9 V below 12.0 V", count=3),
    LogLine(time=NOON + 27, severity=2, label="vehicle", text="no MANUAL_CONTROL for 520 ms, motors stopped"),
    LogLine(time=NOON + 28, severity=6, label="vehicle", text="control regained"),
)

LONG = (
    "PreArm: Compass 1 is not healthy, and a reason that is much longer than the width of a small terminal, so that it "
    "takes two rows or three"
)
LOG_PAGE = LogPage(
    tuple(
        LogLine(time=NOON + at, severity=severity, label=label, text=text, count=count, number=number)
        for number, (at, severity, label, text, count) in enumerate(
            [
                (0, 5, "station", "Rover 1 found", 1), (1, 6, "vehicle", "rover 1, mavhelm vehicle 0.1, MANUAL", 1),
                (2, 4, "vehicle", LONG, 1), (3, 6, "ack", "arm accepted", 1), (3, 5, "state", "Rover 1: armed", 1),
                (20, 4, "vehicle", "battery 11.9 V below 12.0 V", 3),
                (27, 2, "vehicle", "no MANUAL_CONTROL for 520 ms, motors stopped", 1),
                (28, 6, "vehicle", "control regained", 1),
            ],
            start=1,
        )
    ),
    state=10,
)  # fmt: skip
"""What the Log screen gets."""


def snapshot(**changes: Any) -> Snapshot:
    """All of it."""
    picture = Snapshot(
        number=1, uptime=60.0, endpoints=("udpin:127.0.0.1:14550",), vehicle=vehicle(), operator=helm(),
        links=(LinkView(name="udpin:127.0.0.1:14550", loss=0.003, round_trip=0.012, age=0.05,
                        counts=True, rate=55.0),), texts=TEXTS,
    )  # fmt: skip
    return msgspec.structs.replace(picture, **changes)


WALLED = snapshot(
    vehicle=vehicle(
        slowed=(0.4, "obstacle"), nearest=(0.8, 0.6),
        obstacles=tuple((0.3 + 0.1 * step, 5.0 + 0.5 * step) for step in range(12)),
    )
)  # fmt: skip
"""An obstacle ahead on the right, which slows the rover down."""

TWO_PATHS = snapshot(
    links=(
        LinkView(name="udpin:0.0.0.0:14550", loss=0.003, round_trip=0.012, age=0.05, counts=True, rate=55.0),
        LinkView(name="serial:/dev/ttyUSB0:57600", loss=0.31, round_trip=0.64, age=1.7, rate=9.0),
        LinkView(name="udpin:127.0.0.1:14551"),
    )
)
"""Two links to one vehicle, the second one late and lossy, and a third one on which nobody is heard."""


def waiting(**changes: Any) -> Snapshot:
    """No vehicle yet."""
    text = "waiting for a vehicle on udpin:127.0.0.1:14550"
    return snapshot(vehicle=None, operator=OperatorView(gate_reason="no vehicle"), texts=(), waiting=text, **changes)


PARAMS: tuple[tuple[str, float, str, float | None], ...] = (
    ("FS_ACTION", 2.0, "INT8", 1.0),
    ("FS_GCS_ENABLE", 1.0, "INT8", 1.0),
    ("FS_TIMEOUT", 1.5, "REAL32", 1.5),
    ("INS_GYR_ID", 2753028.0, "INT32", None),
    ("RC_OPTIONS", 32.0, "INT32", 32.0),
    ("WP_SPEED", 0.45, "REAL32", 2.0),
)


def param_page(
    *changes: tuple[str, float], running: tuple[RequestLine, ...] = (), ended: tuple[RequestLine, ...] = ()
) -> ParamPage:
    """Return a page of parameters, some with other values."""
    values = dict(changes)
    rows = tuple(
        ParamRow(
            name=name, value=values.get(name, value), kind=kind, default=default,
            changed=default is not None and values.get(name, value) != default,
        )
        for name, value, kind, default in PARAMS
    )  # fmt: skip
    return ParamPage(1, rows, 0, len(rows), len(rows), len(rows), has_defaults=True, running=running, ended=ended)


def _source(
    system: int, component: int, label: str, loss: float | None, *messages: tuple[str, float, float, int, float]
) -> list[MessageRow]:
    sent = loss is None and system == 255
    rows = [MessageRow(system, component, sent, *message) for message in messages]
    rate, size = sum(row.rate for row in rows), sum(row.bytes for row in rows)
    count, age = sum(row.count for row in rows), min(row.age for row in rows)
    return [MessageRow(system, component, sent, "", rate, size, count, age, label, loss, 31 if loss else 0), *rows]


MESSAGE_ROWS = (
    *_source(
        1, 1, "Rover 1", 0.003, ("ATTITUDE", 10.0, 400.0, 4906, 0.1), ("AVAILABLE_MODES_MONITOR", 0.3, 4.0, 163, 2.1),
        ("COMMAND_ACK", 0.0, 0.0, 14, 41.3), ("GLOBAL_POSITION_INT", 5.0, 200.0, 2451, 0.1),
        ("HEARTBEAT", 1.0, 21.0, 490, 0.7), ("PARAM_VALUE", 0.0, 0.0, 1241, 126.2),
        ("SERVO_OUTPUT_RAW", 20.0, 660.0, 9812, 0.0), ("SYS_STATUS", 2.0, 86.0, 981, 0.4),
        ("VFR_HUD", 10.0, 320.0, 4905, 0.0),
    ),
    *_source(51, 68, "telemetry radio", 0.0, ("RADIO_STATUS", 1.0, 17.0, 488, 0.6)),
    *_source(
        255, 190, "this station", None, ("HEARTBEAT", 1.0, 21.0, 490, 0.3), ("MANUAL_CONTROL", 20.0, 800.0, 9811, 0.0)
    ),
)  # fmt: skip
MESSAGES_PAGE = MessagesPage(
    MESSAGE_ROWS, 0, len(MESSAGE_ROWS), 12, 69.3, 2518.0,
    history=tuple(6600 if 24 <= second < 28 else 2400 + 40 * (second % 5) for second in range(55)),
)  # fmt: skip
SYS_STATUS_VIEW = MessageView(
    1, 1, False, "SYS_STATUS", 1, 2.0, 981, 0.4, 43,
    (
        MessageField("onboard_control_sensors_present", "0x5361fc2f", "", "3 flags", ("3D_GYRO", "RC_RECEIVER", "GPS")),
        MessageField("onboard_control_sensors_health", "1398930479", "", "1 of 2 enabled not healthy",
                     ("✓✓✗ RC_RECEIVER", "✓✓✓ 3D_GYRO", "✓✓✓ 3D_ACCEL", "✓✓✓ BATTERY", "✓·· GPS")),
        MessageField("load", "412", "d%", "41.2 %", spark="▃▃▄▃▃▅▃▃▂"),
        MessageField("voltage_battery", "12104", "mV", "12.104 V", spark="█▇▇▆▅▄▃▂▁"),
        MessageField("battery_remaining", "76", "%", spark="▁▁▁▁▁▁▁▁▁"), MessageField("errors_comm", "3", ""),
        MessageField("a_long_text", "a text that is longer than the room beside the name of its field", ""),
    ),
    bytes.fromhex("2ffc61532ffc61532fdc61539c014830ba0003"),
    FieldPlot(
        FieldInfo(FieldId(1, 1, False, "SYS_STATUS", "load"), "%", 1), 60.0,
        array("d", range(61)).tobytes(), array("d", (35 + at % 7 for at in range(61))).tobytes(),
    ),
)  # fmt: skip
"""What the Messages screen gets."""
