"""READY_VIEWS: the views that every vehicle has, built from what it sends. A new one is a row here."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.views.charts import STATION, ChartTemplate, FieldId, FieldInfo, ReadyView

READY_VIEWS: tuple[tuple[str, tuple[tuple[str, tuple[str, ...]], ...]], ...] = (
    ("drive", (
        ("speed", ("VFR_HUD.groundspeed",)),
        ("throttle", ("ROVER_DRIVE_STATUS.demand_throttle|VFR_HUD.throttle", "ROVER_DRIVE_STATUS.output[0]",
                      "ROVER_DRIVE_STATUS.output[1]")),
        ("turn rate", ("ATTITUDE.yawspeed",)),
        ("steering", ("ROVER_DRIVE_STATUS.demand_steering|RC_CHANNELS.chan1_raw",)),
    )),
    ("power", (
        ("voltage", ("SYS_STATUS.voltage_battery|BATTERY_STATUS.voltages[0]",)),
        ("current", ("SYS_STATUS.current_battery|BATTERY_STATUS.current_battery",)),
        ("charge", ("SYS_STATUS.battery_remaining|BATTERY_STATUS.battery_remaining",)),
    )),
    ("link", (
        ("latency", (f"{STATION}.round_trip", f"{STATION}.command_age", f"{STATION}.key_to_motor")),
        ("loss", (f"{STATION}.loss", "RADIO_STATUS.txbuf")),
        ("signal", ("RADIO_STATUS.rssi", "RADIO_STATUS.remrssi", "RADIO_STATUS.noise")),
    )),
)  # fmt: skip
"""Name -> charts; a chart has a title and fields. "a|b": the first of them that the vehicle sends."""

STATION_FIELDS: dict[str, FieldInfo] = {
    name: FieldInfo(FieldId(0, 0, False, STATION, name), unit, decimals)
    for name, unit, decimals in (
        ("round_trip", "ms", 1), ("loss", "%", 1), ("command_age", "ms", 0), ("key_to_motor", "ms", 1),
    )
}  # fmt: skip
"""What this station measures of the selected vehicle: TIMESYNC round trip, lost frames, age of the newest demand
that it has taken, and the time from a sent demand to the motors."""


def build_ready(find: Callable[[str], FieldId | None]) -> tuple[ReadyView, ...]:
    """Return the views with the fields that there are. `find` returns the field of a name, None if it is not sent."""
    views = []
    for name, rows in READY_VIEWS:
        charts = (ChartTemplate(title, _found(fields, find)) for title, fields in rows)
        views.append(ReadyView(name, tuple(chart for chart in charts if chart.fields)))
    return tuple(views)


def _found(fields: tuple[str, ...], find: Callable[[str], FieldId | None]) -> tuple[FieldId, ...]:
    found = (next((field for name in names.split("|") if (field := find(name))), None) for names in fields)
    return tuple(field for field in found if field is not None)
