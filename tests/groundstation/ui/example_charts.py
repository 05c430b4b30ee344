"""What the Charts screen gets: fields of a rover, the points of a drive, marks."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterable

from groundstation.views.base import View
from groundstation.views.charts import (
    STATION,
    ChartTemplate,
    FieldId,
    FieldInfo,
    FieldRow,
    FieldsPage,
    Mark,
    ReadyView,
    SeriesPage,
    SeriesPoints,
)
from tests.groundstation.ui.examples import NOON

SPEED = FieldId(1, 1, False, "VFR_HUD", "groundspeed")
DEMAND = FieldId(1, 1, False, "ROVER_DRIVE_STATUS", "demand_throttle")
TURN = FieldId(1, 1, False, "ATTITUDE", "yawspeed")
VOLTS = FieldId(1, 1, False, "SYS_STATUS", "voltage_battery")
STATE = FieldId(1, 1, False, "HEARTBEAT", "system_status")
ROUND_TRIP = FieldId(0, 0, False, STATION, "round_trip")

INFOS = (
    FieldInfo(SPEED, "m/s"), FieldInfo(DEMAND, "%"), FieldInfo(TURN, "deg/s"), FieldInfo(VOLTS, "V", 3),
    FieldInfo(STATE, "", 0, ((3, "STANDBY"), (4, "ACTIVE"))), FieldInfo(ROUND_TRIP, "ms", 1),
)  # fmt: skip

READY = (
    ReadyView("drive", (ChartTemplate("speed", (SPEED,)), ChartTemplate("throttle", (DEMAND,)),
                        ChartTemplate("turn rate", (TURN,)))),
    ReadyView("power", (ChartTemplate("voltage", (VOLTS,)),)),
    ReadyView("link", ()),
)  # fmt: skip
NOW = 1000.0
ROWS = (
    FieldRow(VOLTS, "12.104 V", "V"),
    FieldRow(FieldId(1, 1, False, "BATTERY_STATUS", "voltages", 0), "12.1 V", "V"),
)


def fields_page(text: str = "", *, empty: bool = False) -> FieldsPage:
    """Answer to a search; `empty`: nothing has been heard."""
    if empty:
        ready = tuple(ReadyView(view.name, ()) for view in READY)
        return FieldsPage(text, (), 0, 4, (), ready)
    return FieldsPage(text, ROWS if text else (), 2 if text else 412, 412, INFOS, READY)


def points(field: FieldId, times: Iterable[float], value: Callable[[float], float]) -> SeriesPoints:
    """Points of a field."""
    at = array("d", times)
    return SeriesPoints(field, at.tobytes(), array("d", map(value, at)).tobytes())


def _speed(at: float) -> float:
    return 0.8 * (1 - math.exp(-(at - 955) / 3)) if at > 955 else 0.0


def drive(after: int = 0, now: float = NOW) -> SeriesPage:
    """A minute: the rover stands, starts at 955 s; VFR_HUD is missing from 980 to 988 s."""
    tenths = [now - 60 + number / 10 for number in range(601)]
    with_gap = [at for at in tenths[::3] if not 980 <= at <= 988]
    found = (
        points(SPEED, with_gap, _speed),
        points(DEMAND, tenths[::2], lambda at: 60.0 if at > 955 else 0.0),
        points(TURN, tenths, lambda at: 30 * math.sin(at / 4) if at > 965 else 0.0),
        points(VOLTS, tenths[::10], lambda at: 12.4 - (at - 940) / 200),
        points(ROUND_TRIP, tenths[::2], lambda at: 90.0 if 970 < at < 971 else 12.0),
    )
    marks = (
        Mark(900.0, "mode", "HOLD"), Mark(950.0, "mode", "MANUAL"), Mark(953.0, "armed", "armed"),
        Mark(955.0, "key", "i"), Mark(965.0, "key", "o"), Mark(975.0, "key", "stop"), Mark(980.0, "link", "link lost"),
    )  # fmt: skip
    return SeriesPage(after + 2000, after, now, NOON + 60, found, marks)


CHART_VIEWS: tuple[View, ...] = (fields_page(), drive())
