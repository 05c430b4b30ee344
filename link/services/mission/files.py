"""Plans as files: the text format "QGC WPL 110", and a folder of MAVLink FTP with the plans in force.

MAVProxy, Mission Planner and QGroundControl read the format (https://mavlink.io/en/file_formats/). A line has,
separated by tabs: number, current, frame, command, parameters 1..4, latitude, longitude, altitude, autocontinue.
ArduPilot's tools put home into line 0; here every line is an item, as in the protocol. A line that begins with # is a
comment.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence

from dialects.enums import MissionResult, MissionType
from link.services.ftp.files import BytesContent, Content, DirectoryEntry, NotReadyError, Query
from link.services.ftp.protocol import FtpError
from link.services.mission.commit import PlanChange
from link.services.mission.items import Items, MissionItem, coordinate_scale, to_int32
from link.services.mission.server import MissionServer

HEADER = "QGC WPL 110"
FIELDS = 12
FILE_TYPES: dict[str, MissionType] = {
    "mission.waypoints": MissionType.MISSION,
    "fence.waypoints": MissionType.FENCE,
    "rally.waypoints": MissionType.RALLY,
}


class PlanFileError(ValueError):
    """The file is not a plan; the message is one line."""


def encode_plan(items: Sequence[MissionItem]) -> bytes:
    """Return the file of a plan, without any loss, also of NaN."""
    lines = [HEADER, *(_line(number, item) for number, item in enumerate(items))]
    return ("\n".join(lines) + "\n").encode("ascii")


FindFault = Callable[[MissionItem, float, float], str | None]
"""Takes an item and its two coordinates as the file has them: one that fits no int32 is unset in the item."""


def decode_plan(data: bytes, find_fault: FindFault = lambda item, x, y: None) -> Items:
    """Return the plan of a file. Raises PlanFileError, also for an item of which `find_fault` says what is wrong."""
    text = data.decode("ascii", "replace")
    header, *lines = text.splitlines() or [""]
    if header.strip() != HEADER:
        raise PlanFileError(f"line 1 is not {HEADER!r}")
    numbered = ((number, line) for number, line in enumerate(lines, start=2) if line.strip() and line[0] != "#")
    return tuple(_item(number, line, find_fault) for number, line in numbered)


def _line(number: int, item: MissionItem) -> str:
    scale = coordinate_scale(item.command, item.frame)
    place = (f"{item.x / scale:.7f}", f"{item.y / scale:.7f}", repr(item.z))
    head = (number, 0, item.frame, item.command)
    return "\t".join(map(str, (*head, *map(repr, item.params), *place, int(item.autocontinue))))


def _item(number: int, line: str, find_fault: FindFault) -> MissionItem:
    fields = line.split()
    if len(fields) != FIELDS:
        raise PlanFileError(f"line {number} has {len(fields)} fields, not {FIELDS}")
    try:
        frame, command = int(fields[2]), int(fields[3])
        x, y = float(fields[8]), float(fields[9])
        one, two, three, four, z = (_float32(text) for text in (*fields[4:8], fields[10]))
        autocontinue = bool(int(fields[11]))
    except ValueError as error:
        raise PlanFileError(f"line {number}: {error}") from error
    scale = coordinate_scale(command, frame)
    place = to_int32(x, scale), to_int32(y, scale)
    item = MissionItem(command, frame, (one, two, three, four), *place, z, autocontinue)
    if fault := find_fault(item, x, y):
        raise PlanFileError(f"line {number}: {fault}")
    return item


def _float32(text: str) -> float:
    """Return the number as float32. Raises ValueError if it is too large."""
    value = float(text)
    try:
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    except OverflowError:
        raise ValueError(f"{text} is too large") from None


class PlanFolder:
    """The plans of a MissionServer as files; writing one puts it in force."""

    def __init__(
        self,
        server: MissionServer,
        in_use: Callable[[MissionType], str | None] = lambda kind: None,
        refused: Callable[[MissionType, str], None] = lambda kind, reason: None,
    ) -> None:
        """Serve the plans of `server`.

        `in_use` returns why a plan may not be changed now, or None; `refused` gets the reason why a file was rejected,
        which MAVLink FTP cannot carry.
        """
        self._server = server
        self._in_use = in_use
        self._refused = refused
        self._changes: dict[MissionType, tuple[bytes, PlanChange]] = {}
        """The last change by file, until its sender has got the result."""

    def writable(self, name: str) -> bool:
        """Return whether `name` is that of a plan."""
        return name in FILE_TYPES

    def entries(self) -> list[DirectoryEntry]:
        """Return one file per plan, also for an empty one."""
        return [DirectoryEntry(name, len(encode_plan(self._server.plan(kind)))) for name, kind in FILE_TYPES.items()]

    def open(self, name: str, query: Query) -> Content | None:
        """Return the plan as it is now."""
        return (
            BytesContent(encode_plan(self._server.plan(FILE_TYPES[name]))) if name in FILE_TYPES and not query else None
        )

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Put the plan in force; return FAIL if it is invalid or cannot be saved.

        Raises NotReadyError until it is saved; the same call again returns the result.
        """
        kind = FILE_TYPES.get(name)
        if kind is None:
            return FtpError.PROTECTED
        change = self._pending_change(kind, data) or self._begin_change(kind, data)
        if isinstance(change, FtpError):
            return change
        if change.verdict is None:
            self._changes[kind] = data, change
            raise NotReadyError
        self._changes.pop(kind, None)
        return None if change.verdict is MissionResult.ACCEPTED else FtpError.FAIL

    def remove(self, name: str) -> FtpError | None:
        """Clear the plan. Raises NotReadyError as `store` does."""
        return self.store(name, HEADER.encode()) if name in FILE_TYPES else FtpError.NOT_FOUND

    def _pending_change(self, kind: MissionType, data: bytes) -> PlanChange | None:
        """Return the change that this file has started already.

        Not one that has ended without its sender getting the result while the plan has changed since: it is made again.
        """
        before, change = self._changes.get(kind, (b"", None))
        if change is None or before != data:
            return None
        replaced = change.verdict is MissionResult.ACCEPTED and self._server.plan(kind) is not change.plans[kind]
        return None if replaced else change

    def _begin_change(self, kind: MissionType, data: bytes) -> PlanChange | FtpError:
        reason = self._in_use(kind)
        if reason:
            self._refused(kind, reason)
            return FtpError.PROTECTED
        try:
            items = decode_plan(data)
        except PlanFileError as fault:
            self._refused(kind, str(fault))
            return FtpError.FAIL
        return self._server.replace({kind: items}, lambda kind: self._in_use(kind) is None) or FtpError.FAIL
