"""MCAP for Foxglove and ROS 2: every message as a topic of its own, and the telemetry as standard messages of ROS.

The container is written by mcap, standard types and CDR come from rosbags; both are in the extra "bags".
https://mcap.dev/spec/registry#ros2: every channel needs `offered_qos_profiles`, which may be empty.
"""

from __future__ import annotations

import keyword
import re
from typing import Any

import numpy as np
from mcap.writer import Writer
from rosbags.typesys import get_types_from_msg

from dialects.messages import Heartbeat, ManualControl, Message, RoverOperatorPresence, field_value
from groundstation.disk.new_file import NewFile
from groundstation.export.exporter import LogInfo
from groundstation.export.log_time import iso_time
from groundstation.export.sample import Sample
from groundstation.ros.types import RosTypes
from groundstation.ros.vehicle import ODOMETRY, ROWS, RosVehicle, Values, transforms
from groundstation.stream.recorded_video import RecordedUnit
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle, replaces

_TYPES = RosTypes()
"""Standard types, and those made so far."""

VIDEO = "foxglove_msgs/msg/CompressedVideo"
"""https://docs.foxglove.dev/docs/sdk/schemas/compressed-video: Annex B, one picture a message, no B frames."""
VIDEO_DEFINITION = "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n"
CAMERA_TOPIC, CAMERA_FRAME = "/camera", "camera"


class McapExport:
    """Writes topics /sys1/comp1/NAME, and /fix, /imu, /odom, /cmd_vel, /battery_state of the first vehicle.

    Those of further vehicles are below /sys2.
    """

    learns = True

    def __init__(self, path: str, log: LogInfo) -> None:
        self.target = NewFile(path)
        self.count = 0
        self._topics = _Topics(Writer(self.target.file), log)
        self._kinds: dict[int, RosType] = {}
        self._vehicles: dict[int, RosVehicle] = {}

    def add(self, sample: Sample) -> None:
        """Write a message, and what it says in ROS. Messages that are not chosen are only learned from."""
        if sample.kind is None:
            return
        if sample.chosen:
            self._topics.write_message(sample, self._kind(sample.kind))
            self.count += 1
        self._add_standard(sample)

    def add_picture(self, unit: RecordedUnit) -> None:
        """Write a recorded picture, as it is."""
        self._topics.write_picture(unit)
        self.count += 1

    def finish(self) -> None:
        """Write the index."""
        self._topics.writer.finish()  # type: ignore[no-untyped-call]

    def discard(self) -> None:
        """Remove what is not in its place."""
        self.target.discard()

    def _kind(self, kind: type[Message]) -> RosType:
        found = self._kinds.get(kind.id)
        if found is None:
            found = self._kinds[kind.id] = RosType(kind)
        return found

    def _add_standard(self, sample: Sample) -> None:
        if sample.kind is ManualControl or sample.kind is RoverOperatorPresence:
            self._add_demand(sample)
            return
        vehicle = self._vehicle(sample)
        made = (
            vehicle.take(sample.message, sample.microseconds) if vehicle is not None and sample.kind in ROWS else None
        )
        if vehicle is not None and made is not None and sample.chosen:
            self._write(sample, vehicle, *made)

    def _add_demand(self, sample: Sample) -> None:
        message = sample.message
        assert isinstance(message, ManualControl | RoverOperatorPresence)
        system = message.target if isinstance(message, ManualControl) else message.target_system
        vehicle = self._vehicles.get(system)
        made = vehicle.take_demand(message) if vehicle is not None and sample.chosen else None
        if vehicle is not None and made is not None:
            self._write(sample, vehicle, *made)

    def _vehicle(self, sample: Sample) -> RosVehicle | None:
        """Return the vehicle of a message of its autopilot, which is known by its HEARTBEAT."""
        found = self._vehicles.get(sample.system)
        if sample.kind is Heartbeat and is_vehicle(sample.message):
            if found is None:
                prefix = f"sys{sample.system}/" if self._vehicles else ""
                found = self._vehicles[sample.system] = RosVehicle(sample.component, prefix)
            elif replaces(sample.component, found.component):
                found = self._vehicles[sample.system] = RosVehicle(sample.component, found.prefix)
        return found if found is not None and found.component == sample.component else None

    def _write(self, sample: Sample, vehicle: RosVehicle, topic: str, kind: str, values: Values) -> None:
        self._topics.write_standard(sample, f"/{vehicle.prefix}{topic}", kind, values)
        if kind == ODOMETRY:
            self._topics.write_standard(sample, "/tf", "tf2_msgs/msg/TFMessage", transforms(values))


class _Topics:
    """The channels of the file."""

    def __init__(self, writer: Writer, log: LogInfo) -> None:
        self.writer = writer
        self._store = _TYPES.store
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, str], int] = {}
        writer.start(profile="ros2", library="mavhelm")
        writer.add_metadata("mavhelm", {"log": log.name, "begin": iso_time(log.begin), "only": log.only})

    def write_message(self, sample: Sample, kind: RosType) -> None:
        """Write a message of MAVLink."""
        topic = f"/sys{sample.system}/comp{sample.component}/{sample.name}"
        channel = self._channels.get((topic, kind.name))
        if channel is None:
            if kind.name not in self._store.types:
                self._store.register(get_types_from_msg(kind.definition, kind.name))
            channel = self._open(topic, kind.name, kind.definition)
        value = self._store.types[kind.name](*kind.values(sample.message))
        self._write(channel, sample, kind.name, value)

    def write_standard(self, sample: Sample, topic: str, kind: str, values: Values) -> None:
        """Write a standard message of ROS."""
        channel = self._channels.get((topic, kind))
        if channel is None:
            channel = self._open(topic, kind, self._store.generate_msgdef(kind, ros_version=2)[0])
        self._write(channel, sample, kind, _TYPES.build(kind, values))

    def write_picture(self, unit: RecordedUnit) -> None:
        """Write a picture as Foxglove has it."""
        channel = self._channels.get((CAMERA_TOPIC, VIDEO))
        if channel is None:
            self._store.register(get_types_from_msg(VIDEO_DEFINITION, VIDEO))
            definition = self._store.generate_msgdef(VIDEO, ros_version=2)[0]
            channel = self._open(CAMERA_TOPIC, VIDEO, definition)
        types = self._store.types
        stamp = types["builtin_interfaces/msg/Time"](unit.time // 1_000_000, unit.time % 1_000_000 * 1000)
        value = types[VIDEO](stamp, CAMERA_FRAME, np.frombuffer(unit.data, np.uint8), "h264")
        at = unit.time * 1000
        self.writer.add_message(channel, at, bytes(self._store.serialize_cdr(value, VIDEO)), at)

    def _write(self, channel: int, sample: Sample, kind: str, value: object) -> None:
        at = sample.microseconds * 1000
        data = bytes(self._store.serialize_cdr(value, kind))
        self.writer.add_message(channel, at, data, at, sample.sequence)

    def _open(self, topic: str, kind: str, definition: str) -> int:
        schema = self._schemas.get(kind)
        if schema is None:
            schema = self._schemas[kind] = self.writer.register_schema(kind, "ros2msg", definition.encode())
        channel = self.writer.register_channel(topic, "cdr", schema, {"offered_qos_profiles": ""})
        self._channels[topic, kind] = channel
        return channel


PACKAGE = "mavlink"
BASES = {
    "char": "uint8", "int8_t": "int8", "uint8_t": "uint8", "int16_t": "int16", "uint16_t": "uint16",
    "int32_t": "int32", "uint32_t": "uint32", "int64_t": "int64", "uint64_t": "uint64", "float": "float32",
    "double": "float64",
}  # fmt: skip
"""Type of a MAVLink field -> type of ROS. An array of char is a string."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


class RosType:
    """How a message of MAVLink is written as a message of ROS."""

    def __init__(self, kind: type[Message]) -> None:
        self.name = f"{PACKAGE}/msg/{type_name(kind.msgname)}"
        lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
        self._fields = [(name, of, lengths[name]) for name, of in zip(kind.fieldnames, kind.fieldtypes, strict=True)]
        self.definition = "".join(_line(kind, *each) for each in self._fields)

    def values(self, message: Message) -> list[Any]:
        """Return the values of the fields, in their order."""
        return [_value(field_value(message, name), of, length) for name, of, length in self._fields]


def type_name(name: str) -> str:
    """Return the name of a type: "GlobalPositionInt" for GLOBAL_POSITION_INT."""
    joined = "".join(part.capitalize() for part in name.split("_"))
    return joined if joined[:1].isalpha() else f"Message{joined}"


def _line(kind: type[Message], name: str, of: str, length: int) -> str:
    """Return the line of a field, with its unit and enum as a comment."""
    base = "string" if of == "char" and length else f"{BASES[of]}[{length}]" if length else BASES[of]
    notes = [kind.fieldunits_by_name.get(name, ""), kind.fieldenums_by_name.get(name, "")]
    comment = " ".join(filter(None, notes))
    return f"{base} {_field_name(name)}{f'  # {comment}' if comment else ''}\n"


def _field_name(name: str) -> str:
    """Return the name as it is; one that a reader in Python could not have gets a prefix."""
    return f"field_{name}" if keyword.iskeyword(name) or not _NAME.fullmatch(name) else name


def _value(value: Any, of: str, length: int) -> Any:
    if of == "char":
        return value if length else ord(value[0]) & 0xFF if value else 0
    return np.array(value, dtype=BASES[of]) if length else value
