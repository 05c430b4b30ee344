"""Views of the Charts screen: points of the drawn fields, marks under the time axis, and fields to choose from."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest

MAX_SERIES = 6 * 4
"""Series of one screen: 6 charts with 4 each."""

MAX_FIELDS = 2 * MAX_SERIES
"""Fields of one request: a difference is drawn from two."""


class FieldId(msgspec.Struct, frozen=True, array_like=True, order=True):
    """A numeric field of the messages of one source."""

    system: int
    component: int
    sent: bool
    """This station sends the message."""
    message: str
    """Name of the message; STATION for what this station measures itself."""
    field: str
    index: int = -1
    """Item of an array; -1: the field is none."""

    @property
    def name(self) -> str:
        """Message and field, e.g. "SERVO_OUTPUT_RAW.servo1_raw", "BATTERY_STATUS.voltages[0]"."""
        return f"{self.message}.{self.field}" + (f"[{self.index}]" if self.index >= 0 else "")

    @property
    def source(self) -> str:
        """System and component, e.g. "1/1"; "" for what this station measures."""
        return "" if self.message == STATION else f"{self.system}/{self.component}"


STATION = "STATION"
"""Message name of the fields that this station measures: round trip, loss and so on."""


class SeriesRequest(ViewRequest, frozen=True):
    """New points of some fields. They are recorded while they are requested, or pinned (PinFields)."""

    fields: tuple[FieldId, ...]
    """At most MAX_FIELDS; more are ignored."""
    after: int = 0
    """SeriesPage.state of the newest page: points and marks after this state are new."""


class SeriesPoints(msgspec.Struct, frozen=True, array_like=True):
    """New points of one field, oldest first."""

    field: FieldId
    times: bytes
    """s of the station's clock, as 8-byte floats of this machine."""
    values: bytes
    """In the unit of FieldInfo, as 8-byte floats of this machine."""


class Mark(msgspec.Struct, frozen=True, array_like=True):
    """What happened at one time."""

    at: float
    """s of the station's clock."""
    kind: str
    """One of MARK_KINDS."""
    text: str
    """The mode, the key, or what happened."""


MARK_KINDS = ("mode", "armed", "disarmed", "failsafe", "link", "key")
"""Kinds of marks."""


class SeriesPage(View, frozen=True):
    """New points and marks; at most PAGE of them (station/charts/recorder.py)."""

    state: int
    """State after these points. A screen that requests those after it loses none and gets none twice."""
    after: int
    """That of the request: a page for an older state must not pass for the answer to this one."""
    now: float
    """s of the station's clock."""
    wall: float
    """The same moment, s since the epoch."""
    points: tuple[SeriesPoints, ...] = ()
    marks: tuple[Mark, ...] = ()


class FieldsRequest(ViewRequest, frozen=True):
    """Numeric fields whose name matches a text, and what is known of some fields."""

    text: str = ""
    """Fuzzy, see station/messages/fuzzy.py; several words must all match."""
    count: int = 0
    """Rows wanted; 0: none."""
    known: tuple[FieldId, ...] = ()
    """Fields that a screen draws: FieldsPage.known has them in the same order."""


class FieldInfo(msgspec.Struct, frozen=True, array_like=True):
    """What is known of a field."""

    field: FieldId
    unit: str = ""
    """A unit that people use: "V" where the message has mV."""
    decimals: int = 2
    names: tuple[tuple[int, str], ...] = ()
    """Values of its enum and their names."""
    heard: bool = True
    """The message has arrived, or was sent, in this session."""


class FieldRow(msgspec.Struct, frozen=True, array_like=True):
    """A field to choose."""

    field: FieldId
    value: str
    """Newest value with its unit."""
    unit: str = ""


class ChartTemplate(msgspec.Struct, frozen=True, array_like=True):
    """A chart of a ready view: its title and the fields of it that the vehicle sends."""

    title: str
    fields: tuple[FieldId, ...]


class ReadyView(msgspec.Struct, frozen=True, array_like=True):
    """A ready view, built from what the vehicle sends."""

    name: str
    charts: tuple[ChartTemplate, ...]


class FieldsPage(View, frozen=True):
    """Answer to a FieldsRequest."""

    text: str
    """That of the request."""
    rows: tuple[FieldRow, ...]
    matching: int
    """Fields that match; `rows` has the best of them."""
    total: int
    """Numeric fields of all messages."""
    known: tuple[FieldInfo, ...]
    ready: tuple[ReadyView, ...]
