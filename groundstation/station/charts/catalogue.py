"""FieldCatalogue: the numeric fields of all messages that have arrived or were sent, and ready views of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from dialects.messages import MESSAGES, Message
from groundstation.station.messages.fields import build_info, format_value, make_reader, numeric_fields, rank_fields
from groundstation.station.messages.message_traffic import MessageTraffic, TrafficKey
from groundstation.views.charts import (
    STATION,
    ChartTemplate,
    FieldId,
    FieldInfo,
    FieldRow,
    FieldsPage,
    FieldsRequest,
    ReadyView,
)

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
    ("obstacles", (
        ("nearest", ("DISTANCE_SENSOR.current_distance",)),
        ("speed limit", ("ROVER_DRIVE_STATUS.speed_limit", "VFR_HUD.groundspeed")),
        ("ahead", ("OBSTACLE_DISTANCE.distances[0]",)),
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


MAX_ROWS = 50
"""Rows of one answer, more than fit beside the charts."""

_NAME = re.compile(r"(\w+)\.(\w+)(?:\[(\d+)\])?")


def place_of(field: FieldId) -> TrafficKey:
    """Return the kind of message that has a field."""
    return ((field.sent, field.system, field.component), field.message)


def class_of(field: FieldId) -> type[Message] | None:
    """Return the class of its message; None outside the dialects, which may have grown by that of the user."""
    return next((kind for kind in MESSAGES.values() if kind.msgname == field.message), None)


class FieldCatalogue:
    """Fields by the kinds of messages that `traffic` has counted."""

    def __init__(self, traffic: MessageTraffic) -> None:
        self._traffic = traffic
        self._fields: list[FieldId] = []
        self._places: list[TrafficKey] = []
        self._first: dict[tuple[int, int], tuple[FieldId, ...]] = {}
        """Ids of a vehicle -> its first view, which changes with the kinds of messages only."""

    def build_page(self, request: FieldsRequest, vehicle: tuple[int, int]) -> FieldsPage:
        """Return the fields that match, those that are drawn, and the ready views of a vehicle (its ids)."""
        self._update()
        wanted = max(0, min(request.count, MAX_ROWS))
        matching = rank_fields(request.text, self._fields) if wanted else []
        rows = tuple(FieldRow(field, self._value(field), self._info(field).unit) for field in matching[:wanted])
        known = tuple(self._info(field) for field in request.known)
        ready = build_ready(lambda name: self._find(name, vehicle))
        return FieldsPage(request.text, rows, len(matching), len(self._fields), known, ready)

    def first_view(self, vehicle: tuple[int, int]) -> tuple[FieldId, ...]:
        """Return the fields of the ready view that opens by itself, as far as a vehicle (its ids) sends them."""
        self._update()
        if vehicle not in self._first:
            charts = build_ready(lambda name: self._find(name, vehicle))[0].charts
            self._first[vehicle] = tuple(field for chart in charts for field in chart.fields)
        return self._first[vehicle]

    def _update(self) -> None:
        places = [place for place, _ in self._traffic.kinds()]
        if places != self._places:
            self._places, self._first = places, {}
            self._fields = [*(info.field for info in STATION_FIELDS.values()), *self._all_fields()]

    def _all_fields(self) -> Iterator[FieldId]:
        for ((sent, system, component), name), kind in self._traffic.kinds():
            for field, index in numeric_fields(type(kind.newest)):
                yield FieldId(system, component, sent, name, field, index)

    def _info(self, field: FieldId) -> FieldInfo:
        if field.message == STATION:
            return STATION_FIELDS.get(field.field, FieldInfo(field, heard=False))
        kind = class_of(field)
        if kind is None or field.field not in kind.fieldnames:
            return FieldInfo(field, heard=False)
        info = build_info(field, kind)
        if self._traffic.find(place_of(field)) is None:
            return FieldInfo(field, info.unit, info.decimals, info.names, heard=False)
        return info

    def _value(self, field: FieldId) -> str:
        kind = self._traffic.find(place_of(field))
        if kind is None:
            return ""
        read = make_reader(type(kind.newest), field.field, field.index)
        return format_value(read(kind.newest) if read else None, self._info(field))

    def _find(self, name: str, vehicle: tuple[int, int]) -> FieldId | None:
        """Return the field of a name: that of the vehicle if it sends it, else that of any source."""
        match = _NAME.fullmatch(name)
        if match is None:
            return None
        message, field, index = match[1], match[2], int(match[3] or -1)
        if message == STATION:
            return STATION_FIELDS[field].field
        ids = [source[1:] for source, kind in self._places if kind == message and not source[0]]
        ids.sort(key=lambda each: (each != vehicle, each))
        return FieldId(*ids[0], False, message, field, index) if ids else None
