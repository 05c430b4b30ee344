"""FieldCatalogue: the numeric fields of all messages that have arrived or were sent, and what they are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from dialects.messages import MESSAGES, Message
from groundstation.station.charts.ready_views import STATION_FIELDS, build_ready
from groundstation.station.messages.fields import build_info, format_value, make_reader, numeric_fields, rank_fields
from groundstation.station.messages.message_traffic import MessageTraffic, Place
from groundstation.views.charts import STATION, FieldId, FieldInfo, FieldRow, FieldsPage, FieldsRequest

MAX_ROWS = 50
"""Rows of one answer, more than fit beside the charts."""

_NAME = re.compile(r"(\w+)\.(\w+)(?:\[(\d+)\])?")


def place_of(field: FieldId) -> Place:
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
        self._places: list[Place] = []

    def build_page(self, request: FieldsRequest, vehicle: tuple[int, int]) -> FieldsPage:
        """Return the fields that match, those that are drawn, and the ready views of a vehicle (its ids)."""
        self._update()
        wanted = max(0, min(request.count, MAX_ROWS))
        matching = rank_fields(request.text, self._fields) if wanted else []
        rows = tuple(FieldRow(field, self._value(field), self._info(field).unit) for field in matching[:wanted])
        known = tuple(self._info(field) for field in request.known)
        ready = build_ready(lambda name: self._find(name, vehicle))
        return FieldsPage(request.text, rows, len(matching), len(self._fields), known, ready)

    def _update(self) -> None:
        places = [place for place, _ in self._traffic.kinds()]
        if places != self._places:
            self._places = places
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
