"""RosTypes: values of messages and services of ROS 2 to CDR and back, and the hashes of their types.

Standard types and CDR come from rosbags, which has no services: those are registered here from their definitions. The
hash of a service is that of a type with three members, REP 2016.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SECONDS_MAX = 0x7FFFFFFF
"""builtin_interfaces/Time ends in 2038."""
_EMPTY = "uint8 structure_needs_at_least_one_member\n"
"""Definition of a request without fields."""
_EVENT = "service_msgs/msg/ServiceEventInfo"
_EVENT_DEFINITION = """\
uint8 event_type
builtin_interfaces/msg/Time stamp
uint8[16] client_gid
int64 sequence_number
"""
"""`client_gid` is a char in the file, which is a uint8 in the hash; rosbags takes it for another type."""


class BadMessageError(ValueError):
    """Bytes are not a message of the type, in one line."""


class RosTypes:
    """The types of the oldest supported release of ROS 2, and those that are registered. Each costs about 10 ms."""

    def __init__(self) -> None:
        self.store = get_typestore(Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg(_EVENT_DEFINITION, _EVENT))
        self._hashes: dict[str, str] = {}

    def register_service(self, name: str, request: str, response: str) -> None:
        """Make `name`, e.g. "std_srvs/srv/SetBool", known, with its _Request and _Response: the parts of its file."""
        types: dict[str, Any] = {}
        for part, text in (("Request", request), ("Response", response)):
            made = get_types_from_msg(text or _EMPTY, f"made/msg/{part}")
            types[f"{name}_{part}"] = made[f"made/msg/{part}"]
        halves = [(half, (Nodetype.SEQUENCE, ((Nodetype.NAME, f"{name}_{part}"), 1)))
                  for half, part in (("request", "Request"), ("response", "Response"))]  # fmt: skip
        types[f"{name}_Event"] = ([], [("info", (Nodetype.NAME, _EVENT)), *halves])
        members = ("request_message", "Request"), ("response_message", "Response"), ("event_message", "Event")
        types[name] = ([], [(member, (Nodetype.NAME, f"{name}_{part}")) for member, part in members])
        self.store.register(types)

    def prepare(self, kind: str) -> None:
        """Do what takes long for a type, 10 to 50 ms, before a vehicle waits for it."""
        self.hash(kind)
        for each in (f"{kind}_Request", f"{kind}_Response") if "/srv/" in kind else (kind,):
            self.store.get_msgdef(each)

    def hash(self, kind: str) -> str:
        """Return the hash of a type: "RIHS01_" and 64 digits."""
        if kind not in self._hashes:
            self._hashes[kind] = self.store.hash_rihs01(kind)
        return self._hashes[kind]

    def encode(self, kind: str, values: Mapping[str, Any]) -> bytes:
        """Return values as CDR, little endian. A header is a pair of a Unix time in us and a frame."""
        return bytes(self.store.serialize_cdr(self.build(kind, values), kind))

    def decode(self, kind: str, data: bytes) -> Any:
        """Return a message whose fields are attributes. Raises BadMessageError."""
        try:
            return self.store.deserialize_cdr(data, kind)
        except Exception as error:  # rosbags raises what its generated code happens to: struct.error, IndexError, ...
            raise BadMessageError(f"{len(data)} bytes are not a {kind}: {type(error).__name__}") from None

    def to_plain(self, value: Any) -> Any:
        """Return a message, or a value in one, as dictionaries and lists."""
        kind = getattr(value, "__msgtype__", None)
        if kind is not None:
            named = self.store.get_msgdef(kind).fields
            return {name: self.to_plain(getattr(value, name)) for name, _ in named}
        if isinstance(value, np.ndarray):
            return value.tolist()
        return [self.to_plain(each) for each in value] if isinstance(value, list) else value

    def build(self, kind: str, values: Mapping[str, Any]) -> Any:
        """Return the message of a type, and of the types in it."""
        named = self.store.get_msgdef(kind).fields
        return self.store.types[kind](**{name: self._field(of, values[name]) for name, of in named})

    def _field(self, of: Any, value: Any) -> Any:
        if isinstance(value, dict):
            return self.build(of[1], value)
        if of[0] == Nodetype.NAME:
            return self._header(*value) if of[1] == "std_msgs/msg/Header" else self._time(*value)
        if not isinstance(value, list):
            return value
        inner = of[1][0]
        if inner[0] == Nodetype.NAME:
            return [self.build(inner[1], each) for each in value]
        return value if inner[1][0] == "string" else np.array(value, dtype=_DTYPES.get(inner[1][0], inner[1][0]))

    def _header(self, microseconds: int, frame: str) -> Any:
        return self.store.types["std_msgs/msg/Header"](stamp=self._time(microseconds), frame_id=frame)

    def _time(self, microseconds: int) -> Any:
        seconds, rest = divmod(microseconds, 1_000_000)
        return self.store.types["builtin_interfaces/msg/Time"](sec=min(seconds, SECONDS_MAX), nanosec=rest * 1000)


_DTYPES = {"byte": "uint8", "char": "uint8"}
"""Type of ROS -> type of numpy, where the names differ."""
