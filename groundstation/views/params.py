"""Views of the parameters of the selected vehicle."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest
from groundstation.views.requests import RequestLine


class ParamPageRequest(ViewRequest, frozen=True):
    """Parameters of the selected vehicle, sorted by name; the best matches of a filter come first."""

    filter: str = ""
    """Words, one of which must be in the name or the texts; upper or lower case. Empty: all."""
    changed_only: bool = False
    """Only those that are not at their default."""
    first: int = 0
    """First row, counted among those that match."""
    rows: int = 0
    group: str = ""
    """Only those of this group. Empty: all."""
    names: tuple[str, ...] | None = None
    """Only these. None: all."""


class ParamRow(msgspec.Struct, frozen=True):
    """One parameter."""

    name: str
    value: float
    kind: str
    """Name of its MAV_PARAM_TYPE, e.g. "INT8"."""
    default: float | None
    """None: not known."""
    changed: bool
    """It is not at its default."""
    unit: str = ""
    meaning: str = ""
    """Name of its value, or of its bits."""
    file: float | None = None
    """Its value in the file that is compared; None: it is not in it, or there is none."""


class ParamGroup(msgspec.Struct, frozen=True):
    """Parameters whose names begin alike."""

    name: str
    count: int
    changed: int
    """Those that are not at their default."""


class ParamPage(View, frozen=True):
    """A page of parameters."""

    system: int
    """System id of the vehicle."""
    rows: tuple[ParamRow, ...]
    first: int
    """Number of the first row: less than requested if there are fewer that match."""
    matching: int
    known: int
    total: int | None
    """Parameters that the vehicle has; None: not known."""
    has_defaults: bool
    running: tuple[RequestLine, ...]
    ended: tuple[RequestLine, ...]
    """The last requests that have ended, oldest first."""
    groups: tuple[ParamGroup, ...] = ()
    """All groups, whatever the filter."""
    changed: int = 0
    """Parameters that are not at their default."""
    missing: int = 0
    """Parameters that have not arrived although the list has ended."""
    gaps: tuple[int, ...] = ()
    """Indexes of the first of them."""
    autopilot: str = ""
    """"ardupilot", "px4" or "other": for whom the operator has favourites."""
    texts: str = ""
    """Where the texts come from, or why there are none."""
    file: str = ""
    """The file that is compared; empty: none."""


class ParamInfoRequest(ViewRequest, frozen=True):
    """What is known of some parameters: the selected one, and those whose changes are shown."""

    names: tuple[str, ...] = ()


class ParamDoc(msgspec.Struct, frozen=True):
    """The description of a parameter. Where its file says nothing, a field is empty or None."""

    name: str
    title: str = ""
    text: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None
    default: float | None = None
    """Of a vehicle: as it reports it, else as its description says."""
    values: tuple[tuple[float, str], ...] = ()
    """Values with a name."""
    bits: tuple[tuple[int, str], ...] = ()
    """Bits with a name, the lowest is 0."""
    reboot: bool = False
    """Takes effect after a restart."""
    read_only: bool = False
    not_armed: bool = False
    """The vehicle refuses changes while it is armed."""

    def meaning(self, value: float) -> str:
        """Return the name of a value, or the names of its bits; empty where it has none."""
        if self.values:
            return next((name for each, name in self.values if each == value), "")
        if self.bits and value.is_integer() and value >= 0:
            return ", ".join(name for bit, name in self.bits if int(value) >> bit & 1)
        return ""


class ParamInfo(ParamDoc, frozen=True, kw_only=True):
    """A parameter of a vehicle with its description."""

    value: float
    kind: str
    index: int | None = None
    file: float | None = None
    """Its value in the file that is compared."""


class ParamInfos(View, frozen=True):
    """What is known of the requested parameters that the vehicle has."""

    system: int
    infos: tuple[ParamInfo, ...]


class ParamDiffRequest(ViewRequest, frozen=True):
    """Where the vehicle and the file that is compared differ."""


class ParamDiff(View, frozen=True):
    """The differences, by name."""

    system: int
    file: str
    """Empty: no file is compared."""
    same: int = 0
    different: tuple[tuple[str, float, float], ...] = ()
    """Name, value on the vehicle, value in the file; at most as many as one write takes."""
    only_vehicle: int = 0
    only_file: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    """Names that differ and are not taken from a file: read-only, or the vehicle's own id."""


class ParamExportRequest(ViewRequest, frozen=True):
    """The text of a parameter file."""

    number: int
    """Counts the requests: each is answered once."""
    form: str
    """"mavproxy", "qgc" or "mp"."""
    changed_only: bool = False
    group: str = ""


class ParamExport(View, frozen=True):
    """The text of a parameter file."""

    number: int
    text: str
    count: int
    """Parameters in it."""
    problem: str = ""
    """Why there is none."""
    left_out: str = ""
    """Which parameters it does not have, as the end of a line."""
