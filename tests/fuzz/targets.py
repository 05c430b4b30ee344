"""The targets: functions of bytes that raise only for a fault of ours. To add one, write it and its row in TARGETS."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import msgspec

from dialects import codec
from dialects import messages as m
from groundstation.config.config_file import ConfigError, read_config
from groundstation.formats.errors import FileFormatError
from groundstation.formats.param_file import parse_params
from groundstation.formats.plan_file import parse_plan
from groundstation.formats.waypoint_file import parse_waypoints
from groundstation.input.keymap import KeymapError
from groundstation.input.keymap_file import load_keymap
from groundstation.ipc import decode_from_screen, decode_from_station
from groundstation.station.station import Station
from groundstation.station_socket.hello import decode_hello
from groundstation.station_socket.verb_run import decode_from_shell
from link.core import Core, Outgoing
from link.protocol.channel import Channel
from link.protocol.framer import Framer
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.routing.router import Router
from link.signing.clock import TICKS
from link.signing.role import SigningRole
from link.signing.signature import STAMP_MAX
from link.tlog.tlog import read_records
from tests.fuzz.files import as_file
from tests.link.signing.signed import DAY, DRIVER, NOW, STRANGER, keep, signed
from vehicle.config.config import RoverConfigError, parse_config
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.storage.checksummed_file import CorruptFileError, add_checksum
from vehicle.storage.param_store import decode as decode_params

IDS = sorted(m.MESSAGES)
VEHICLE, STATION = (1, 1), (255, 190)
SERVICES = sorted(
    number
    for number, kind in m.MESSAGES.items()
    if kind.msgname.startswith(("PARAM_", "MISSION_", "FILE_TRANSFER", "COMMAND_", "LOG_", "SET_MODE", "SET_POSITION"))
)
"""Messages of the services, which keep a state from one message to the next."""


def frames(data: bytes, ids: list[int], sender: tuple[int, int], target: tuple[int, int]) -> Iterator[bytes]:
    """Yield frames with valid checksums: two bytes choose a message, one the length, the rest fills its fields."""
    at = sequence = 0
    while at + 3 <= len(data):
        number = ids[int.from_bytes(data[at : at + 2], "little") % len(ids)]
        payload = data[at + 3 : at + 3 + data[at + 2]]
        at += 3 + data[at + 2]
        message: Any = codec.decode(number, payload)
        if hasattr(message, "target_system") and data[0] & 1:  # else it is nearly never for us
            message.target_system, message.target_component = target
            payload = codec.encode_payload(message)
        yield codec.frame(number, payload, sequence & 0xFF, *sender)
        sequence += 1


def run(core: Core, ids: tuple[int, int], pieces: Iterator[bytes], sender: tuple[int, int]) -> None:
    """Let a core take what comes over a link, and check that what it answers can be sent."""
    channel, now = Channel("fuzz", 0, system=ids[0], component=ids[1]), 100.0
    beat = codec.frame(m.Heartbeat.id, codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3)), 255, *sender)
    for data in (beat, *pieces):
        now += 0.05
        for received in channel.receive(data, "peer", now):
            core.receive(received, now)
        core.tick(now)
        outgoing: list[Outgoing] = core.messages_to_send()
        for each in outgoing:
            channel.send(each)
    core.observe([channel.report()], now)


def framer(data: bytes) -> None:
    for stream in (True, False):
        reader = Framer(stream=stream, unknown=bool(data[:1] and data[0] & 1))
        for at in range(0, len(data), 40):
            reader.feed(data[at : at + 40], at / 100)
        reader.expire(1e3)


def channel(data: bytes) -> None:
    for stream in (True, False):
        link = Channel("fuzz", 0, system=1, component=1, stream=stream, target="x" if stream else None)
        for at in range(0, len(data), 60):
            link.receive(data[at : at + 60], "x", at / 100)
            link.tick(at / 100)
        link.report()


def bridge(data: bytes) -> None:
    router = Router([(False, None), (True, "serial")])
    for at in range(0, len(data), 50):
        router.receive(at // 50 % 2, [(data[at : at + 50], "serial" if at // 50 % 2 else at % 3)], at / 100)
        router.tick(at / 100)


def bridge_frames(data: bytes) -> None:
    router = Router([(False, None), (False, None)])
    for number, frame in enumerate(frames(data, IDS, STATION, VEHICLE)):
        router.receive(number % 2, [(frame, number % 3)], number / 50)


def vehicle_bytes(data: bytes) -> None:
    run(Rover(Params(), now=100.0), VEHICLE, iter([data[at : at + 80] for at in range(0, len(data), 80)]), STATION)


def vehicle(data: bytes) -> None:
    run(Rover(Params(), now=100.0), VEHICLE, frames(data, IDS, STATION, VEHICLE), STATION)


def vehicle_services(data: bytes) -> None:
    run(Rover(Params(), now=100.0), VEHICLE, frames(data, SERVICES, STATION, VEHICLE), STATION)


def station_bytes(data: bytes) -> None:
    run(Station(["udpin:127.0.0.1:1"]), STATION, iter([data[at : at + 80] for at in range(0, len(data), 80)]), VEHICLE)


def station(data: bytes) -> None:
    run(Station(["udpin:127.0.0.1:1"]), STATION, frames(data, IDS, VEHICLE, STATION), VEHICLE)


def tlog(data: bytes) -> None:
    for record in read_records(data):
        assert record.raw


def runtime_socket(data: bytes) -> None:
    for decode in (decode_from_screen, decode_from_station, decode_hello, decode_from_shell):
        with contextlib.suppress(msgspec.MsgspecError):
            decode(data)


def parser(parse: Callable[[str], object], *errors: type[Exception]) -> Callable[[bytes], None]:
    """Return the target of a parser of text."""

    def target(data: bytes) -> None:
        with contextlib.suppress(*errors):
            parse(data.decode(errors="replace"))

    return target


def saved_params(data: bytes) -> None:
    for content in (data, add_checksum(data)):
        with contextlib.suppress(CorruptFileError):
            decode_params(content)


UNITS = (1, TICKS, 60 * TICKS, DAY, 365 * DAY)


def signing(data: bytes) -> None:
    """Six bytes a frame: the driver's, a stranger's or unsigned, from any system and link id, at any time."""
    guard = SigningGuard(keep(DRIVER), SigningPolicy(unsigned=SigningRole.WATCH), 0)
    link, newest = Channel("fuzz", 0, system=1, component=1, guard=guard), dict[tuple[int, int], int]()
    for at in range(0, len(data) - 5, 6):
        who, link_id, system, unit = data[at : at + 4]
        away = int.from_bytes(data[at + 4 : at + 6], "little", signed=True) * UNITS[unit % len(UNITS)]
        stamp, key = min(max(0, NOW + away), STAMP_MAX), (DRIVER, STRANGER, None)[who % 3]
        beat = codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3))
        unsigned = codec.frame(m.Heartbeat.id, beat, at // 6 % 256, system, 190)
        ours = {"link_id": link_id, "sequence": at // 6 % 256, "ids": (system, 190)}
        frame = signed(key=key, stamp=stamp, **ours) if key else unsigned  # type: ignore[arg-type]
        for received in link.receive(frame, "x", at / 100):
            if received.role > SigningRole.WATCH:
                assert key is DRIVER
                assert stamp > newest.get((system, link_id), -1), "a replay"
                newest[system, link_id] = stamp


TARGETS: dict[str, Callable[[bytes], None]] = {
    "framer": framer,
    "channel": channel,
    "bridge": bridge,
    "bridge-frames": bridge_frames,
    "vehicle-bytes": vehicle_bytes,
    "vehicle": vehicle,
    "vehicle-services": vehicle_services,
    "station-bytes": station_bytes,
    "station": station,
    "tlog": tlog,
    "runtime-socket": runtime_socket,
    "config": parser(lambda text: as_file(text, read_config), ConfigError),
    "keymap": parser(lambda text: as_file(text, lambda path: load_keymap(str(path))), KeymapError),
    "rover-toml": parser(lambda text: parse_config(text, "rover.toml"), RoverConfigError),
    "plan": parser(lambda text: parse_plan(text, "x.plan"), FileFormatError),
    "waypoints": parser(lambda text: parse_waypoints(text, "x.waypoints"), FileFormatError),
    "param-file": parser(lambda text: parse_params(text, "x.param"), FileFormatError),
    "saved-params": saved_params,
    "signing": signing,
}
