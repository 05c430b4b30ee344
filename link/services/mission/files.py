"""Plans as files: the text format that MAVProxy, Mission Planner and QGroundControl read ("QGC WPL 110"), and a folder
for MAVLink FTP whose files are the plans in force.

A line has, with tabs between: number, current, frame, command, parameters 1..4, latitude, longitude, altitude,
autocontinue. ArduPilot's tools put home into line 0; here every line is an item, as on the wire. A line that begins
with # is a comment.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence

from dialects.enums import MissionResult, MissionType
from link.services.ftp.files import BytesContent, Content, Entry, NotReadyError, Query
from link.services.ftp.protocol import FtpError
from link.services.mission.commit import PlanChange
from link.services.mission.items import DEGREES_SCALE, GLOBAL_FRAMES, LOCAL_SCALE, Items, MissionItem, to_int32
from link.services.mission.server import MissionServer

HEADER = "QGC WPL 110"
FIELDS = 12
FILE_TYPES: dict[str, MissionType] = {
    "mission.waypoints": MissionType.MISSION,
    "fence.waypoints": MissionType.FENCE,
    "rally.waypoints": MissionType.RALLY,
}


class PlanFileError(ValueError):
    """A file that is no plan; the message is one clear line."""


def encode_plan(items: Sequence[MissionItem]) -> bytes:
    """The file of a plan. Nothing of an item is lost, NaN included."""
    lines = [HEADER, *(_line(number, item) for number, item in enumerate(items))]
    return ("\n".join(lines) + "\n").encode("ascii")


def decode_plan(data: bytes) -> Items:
    """The plan of a file. Raises PlanFileError."""
    text = data.decode("ascii", "replace")
    header, *lines = text.splitlines() or [""]
    if header.strip() != HEADER:
        raise PlanFileError(f"line 1 is not {HEADER!r}")
    spoken = ((number, line) for number, line in enumerate(lines, start=2) if line.strip() and line[0] != "#")
    return tuple(_item(number, line) for number, line in spoken)


def _line(number: int, item: MissionItem) -> str:
    scale = DEGREES_SCALE if item.frame in GLOBAL_FRAMES else LOCAL_SCALE
    place = (f"{item.x / scale:.7f}", f"{item.y / scale:.7f}", repr(item.z))
    head = (number, 0, item.frame, item.command)
    return "\t".join(map(str, (*head, *map(repr, item.params), *place, int(item.autocontinue))))


def _item(number: int, line: str) -> MissionItem:
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
    scale = DEGREES_SCALE if frame in GLOBAL_FRAMES else LOCAL_SCALE
    return MissionItem(command, frame, (one, two, three, four), to_int32(x, scale), to_int32(y, scale), z, autocontinue)


def _float32(text: str) -> float:
    """As the wire would have it. Raises ValueError for what is too large for that."""
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
        refused: Callable[[MissionType, str], None] = lambda kind, why: None,
    ) -> None:
        """`in_use` says why a plan may not be changed now, or None; `refused` is told why a file was not
        taken: MAVLink FTP has no words for that, and some clients do not look.
        """
        self._server = server
        self._in_use = in_use
        self._refused = refused
        self._changes: dict[MissionType, tuple[bytes, PlanChange]] = {}
        """What was written last, until its writer has heard how that went."""

    def writable(self, name: str) -> bool:
        """Under the names of the plans."""
        return name in FILE_TYPES

    def entries(self) -> list[Entry]:
        """One file a plan, also where it is empty."""
        return [Entry(name, len(encode_plan(self._server.plan(kind)))) for name, kind in FILE_TYPES.items()]

    def open(self, name: str, query: Query) -> Content | None:
        """The plan as it is now."""
        return (
            BytesContent(encode_plan(self._server.plan(FILE_TYPES[name]))) if name in FILE_TYPES and not query else None
        )

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Put the plan in force, or say FAIL where it is none, breaks the rules or cannot be kept.

        Raises NotYetError until it is kept: the same again gets the answer.
        """
        kind = FILE_TYPES.get(name)
        if kind is None:
            return FtpError.PROTECTED
        change = self._said_before(kind, data) or self._begun(kind, data)
        if isinstance(change, FtpError):
            return change
        if change.verdict is None:
            self._changes[kind] = data, change
            raise NotReadyError
        self._changes.pop(kind, None)
        return None if change.verdict is MissionResult.ACCEPTED else FtpError.FAIL

    def remove(self, name: str) -> FtpError | None:
        """The plan is empty after this. Raises NotYetError as `store` does."""
        return self.store(name, HEADER.encode()) if name in FILE_TYPES else FtpError.NOT_FOUND

    def _said_before(self, kind: MissionType, data: bytes) -> PlanChange | None:
        """The change that this file has begun already. Not where it came to its end unheard and the plan is another one
        by now: that is to be made again.
        """
        before, change = self._changes.get(kind, (b"", None))
        if change is None or before != data:
            return None
        replaced = change.verdict is MissionResult.ACCEPTED and self._server.plan(kind) is not change.plans[kind]
        return None if replaced else change

    def _begun(self, kind: MissionType, data: bytes) -> PlanChange | FtpError:
        why = self._in_use(kind)
        if why:
            self._refused(kind, why)
            return FtpError.PROTECTED
        try:
            items = decode_plan(data)
        except PlanFileError as fault:
            self._refused(kind, str(fault))
            return FtpError.FAIL
        return self._server.replace({kind: items}, lambda kind: self._in_use(kind) is None) or FtpError.FAIL
