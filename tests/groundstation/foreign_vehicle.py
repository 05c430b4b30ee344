"""Vehicles of other makes on a real UDP socket, built with pymavlink: they answer as ArduPilot and as PX4 do.

Measured on ArduRover 4.7-dev: values are cast to float, unknown names are met with silence, the echo of a set has no
index, missions are requested with MISSION_REQUEST, `@PARAM/param.pck` announces a size that is too large.
"""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects import codec
from dialects import messages as m
from tests.groundstation.foreign_ftp import ForeignFtp

INTEGERS = {1: "<Bxxx", 2: "<bxxx", 3: "<Hxx", 4: "<hxx", 5: "<I", 6: "<i"}
"""MAV_PARAM_TYPE -> its bytes in the float, as PX4 packs them."""
REAL32 = 9
ARDUPILOT, PX4 = 3, 12


@dataclass
class ForeignParam:
    """One parameter."""

    value: float
    kind: int = REAL32
    default: float | None = None
    read_only: bool = False


@dataclass
class Missions:
    """The plans, and an upload under way."""

    items: dict[int, list[Any]] = field(default_factory=lambda: {0: [], 1: [], 2: []})
    upload: list[Any] = field(default_factory=list)
    count: int = 0
    kind: int = 0
    refuse: dict[int, int] = field(default_factory=dict)
    """Item -> MAV_MISSION_RESULT with which the upload ends there."""


class ForeignVehicle:
    """Answers in a thread from `with` on.

    `loss` is the share of what it sends that is lost, but for heartbeats, `loss_in` that of what is sent to it.
    """

    def __init__(
        self, autopilot: int = ARDUPILOT, *, loss: float = 0.0, loss_in: float = 0.0, ftp: bool = True, system: int = 1
    ) -> None:
        self.autopilot = autopilot
        self.kind = 10
        """MAV_TYPE."""
        self.loss = loss
        self.loss_in = loss_in
        self.params: dict[str, ForeignParam] = {}
        self.silent: set[int] = set()
        """Message ids that it does not answer."""
        self.files = ForeignFtp(self._packed_params) if ftp else None
        self.missions = Missions()
        self.logs: list[bytes] = []
        self.modes: list[tuple[str, int, int]] = []
        """Name, custom_mode and properties of AVAILABLE_MODES."""
        self.standard_modes: dict[int, int] = {}
        """custom_mode -> MAV_STANDARD_MODE in AVAILABLE_MODES."""
        self.mode = 0
        """custom_mode of its HEARTBEAT."""
        self.armed = False
        self.obeys = True
        """Does what it accepts: modes, arming."""
        self.telemetry: dict[int, Any] = {}
        """Message id -> what it sends on request."""
        self.on_command: dict[int, Callable[[], None]] = {}
        """Command -> what it does when it has accepted it."""
        self.answers_timesync = False
        self.acks: dict[int, tuple[int, str]] = {}
        """Command -> MAV_RESULT, and STATUSTEXT before it."""
        self.received: list[Any] = []
        self.beat_period = 1.0
        """s between two heartbeats."""
        self._beat_due = 0.0
        self._arrived = threading.Condition()
        self._dice = random.Random(3)
        self.system = system
        self._link = mav.MAVLink(None, srcSystem=system, srcComponent=1)
        self._link.robust_parsing = True
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.02)
        self._peer: tuple[str, int] | None = None
        self._sender = (255, 190)
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)

    @property
    def endpoint(self) -> str:
        """Where it listens."""
        return f"udpout:127.0.0.1:{self._socket.getsockname()[1]}"

    def __enter__(self) -> ForeignVehicle:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._running = False
        self._thread.join()
        self._socket.close()

    def of(self, name: str) -> list[Any]:
        """Return the received messages of this name."""
        return [message for message in list(self.received) if message.get_type() == name]

    def wait_for(self, name: str, count: int, within: float = 30.0) -> None:
        """Wait until `count` messages of this name have arrived."""
        with self._arrived:
            assert self._arrived.wait_for(lambda: len(self.of(name)) >= count, within), f"no {count} {name}"

    # ---- the loop ----

    def _run(self) -> None:
        while self._running:
            try:
                data, self._peer = self._socket.recvfrom(65536)
                messages = [] if self._dice.random() < self.loss_in else self._link.parse_buffer(data) or []
            except TimeoutError:
                messages = []
            for message in messages:
                with self._arrived:
                    self.received.append(message)
                    self._arrived.notify_all()
                self._answer(message)
            if self._peer and time.monotonic() >= self._beat_due:
                self._beat_due = time.monotonic() + self.beat_period
                flags, state = (209, 4) if self.armed else (81, 3)
                self.send(
                    mav.MAVLink_heartbeat_message(self.kind, self.autopilot, flags, self.mode, state, 3), certain=True
                )

    def send(self, message: Any, *, certain: bool = False) -> None:
        """Send a message of pymavlink."""
        if self._peer and (certain or self._dice.random() >= self.loss):
            self._socket.sendto(message.pack(self._link), self._peer)
        self._link.seq = (self._link.seq + 1) % 256

    def send_ours(self, message: m.Message) -> None:
        """Send a message that pymavlink's dialect lacks."""
        if self._peer:
            payload = codec.encode_payload(message)
            self._socket.sendto(codec.frame(type(message).id, payload, self._link.seq, self.system, 1), self._peer)
            self._link.seq = (self._link.seq + 1) % 256

    def change_mode(self, mode: int, *, armed: bool = True) -> None:
        """Change the mode; the next heartbeat follows at once."""
        self.mode, self.armed, self._beat_due = mode, armed, 0.0

    def say(self, text: str, severity: int = 4) -> None:
        """Send a STATUSTEXT."""
        self.send(mav.MAVLink_statustext_message(severity, text.encode()))

    def _answer(self, message: Any) -> None:
        self._sender = message.get_srcSystem(), message.get_srcComponent()
        answer = _ANSWERS.get(message.get_type())
        if (
            answer is not None
            and message.get_msgId() not in self.silent
            and getattr(message, "target_system", 0) in (0, self.system)
        ):
            answer(self, message)

    # ---- commands ----

    def _command(self, message: Any) -> None:
        result, text = self.acks.get(message.command, (0, ""))
        if text:
            self.say(text)
        self.send(mav.MAVLink_command_ack_message(message.command, result, 0, 0, *self._sender))
        if result == mav.MAV_RESULT_ACCEPTED:
            self.on_command.get(message.command, lambda: None)()
        if message.command in (176, 400) and result == 0 and self.obeys:
            self._obey(message)
        if message.command == 512 and result == 0:
            self._requested(int(message.param1), int(message.param2))

    def _obey(self, message: Any) -> None:
        """Take a mode, or arm; the next heartbeat follows at once."""
        self._beat_due = 0.0
        main, sub = int(message.param2), int(message.param3)
        if message.command == 400:
            self.armed = message.param1 == 1
        else:
            self.mode = sub << 24 | main << 16 if self.autopilot == PX4 else main

    def _requested(self, number: int, index: int) -> None:
        if number in self.telemetry:
            self.send(self.telemetry[number])
        if number == 148:
            capabilities = 2 | 8 | (0 if self.autopilot == ARDUPILOT else 16) | (32 if self.files else 0)
            none = [0] * 8
            self.send(mav.MAVLink_autopilot_version_message(capabilities, 0, 0, 0, 0, none, none, none, 0, 0, 0))
        if number == 435:
            chosen = enumerate(self.modes, 1) if index == 0 else [(index, self.modes[index - 1])]
            for at, (name, custom, properties) in chosen:
                standard = self.standard_modes.get(custom, 0)
                self.send_ours(m.AvailableModes(len(self.modes), at, standard, custom, properties, name.encode()))

    def _timesync(self, message: Any) -> None:
        if self.answers_timesync and message.tc1 == 0:
            self.send(mav.MAVLink_timesync_message(time.monotonic_ns(), message.ts1))

    # ---- parameters ----

    def _value(self, name: str, index: int) -> Any:
        param = self.params[name]
        wire = param.value
        if self.autopilot == PX4 and param.kind in INTEGERS:
            (wire,) = struct.unpack("<f", struct.pack(INTEGERS[param.kind], int(param.value)))
        return mav.MAVLink_param_value_message(name.encode("latin-1"), wire, param.kind, len(self.params), index)

    def _list(self, message: Any) -> None:
        if self.autopilot == PX4:
            self.send(mav.MAVLink_param_value_message(b"_HASH_CHECK", 1.5, 5, len(self.params), 65535))
        for index, name in enumerate(list(self.params)):
            self.send(self._value(name, index))
            if index % 100 == 99:
                time.sleep(0.005)  # a socket buffer holds no more

    def _read(self, message: Any) -> None:
        names = list(self.params)
        name = message.param_id if message.param_index < 0 else dict(enumerate(names)).get(message.param_index)
        if name in self.params:
            self.send(self._value(name, names.index(name)))

    def _set(self, message: Any) -> None:
        name, value = message.param_id, message.param_value
        param = self.params.get(name)
        if param is None:
            if self.autopilot == PX4:
                self.say(f"[pm] unknown param: {name}")
            return
        if self.autopilot == PX4 and message.param_type != param.kind:
            self.say("[pm] param types mismatch")
            return
        if self.autopilot == PX4 and param.kind in INTEGERS:
            (value,) = struct.unpack(INTEGERS[param.kind], struct.pack("<f", value))
        if param.read_only:
            self.say(f"{name} is read-only")
        else:
            param.value = float(int(value)) if param.kind in INTEGERS else value
        self.send(self._value(name, 65535 if self.autopilot == ARDUPILOT else list(self.params).index(name)))

    def _packed_params(self) -> bytes | None:
        """Return param.pck with defaults, as ArduPilot packs it; PX4 has none."""
        if self.autopilot != ARDUPILOT:
            return None
        packed, before = struct.pack("<HHH", 0x671C, len(self.params), len(self.params)), b""
        for name, param in self.params.items():
            kind, form = {2: (1, "<b"), 4: (2, "<h"), 6: (3, "<i")}.get(param.kind, (4, "<f"))
            raw, flag = name.encode("latin-1"), 0 if param.default is None else 0x10
            shared = 0
            while shared < min(len(raw) - 1, len(before), 15) and raw[shared] == before[shared]:
                shared += 1
            packed += bytes([kind | flag, shared | (len(raw) - shared - 1) << 4]) + raw[shared:]
            for value in (param.value, param.default):
                if value is not None:
                    packed += struct.pack(form, value if kind == 4 else int(value))
            before = raw
        return packed

    # ---- files ----

    def _ftp(self, message: Any) -> None:
        if self.files is not None:
            for payload in self.files.answer(bytes(message.payload)):
                self.send(mav.MAVLink_file_transfer_protocol_message(0, *self._sender, payload))

    # ---- missions ----

    def _mission_count(self, message: Any) -> None:
        missions = self.missions
        missions.upload, missions.count, missions.kind = [], message.count, message.mission_type
        if missions.count:
            self._request_item()
        else:
            missions.items[missions.kind] = []
            self._mission_ack(0)

    def _request_item(self) -> None:
        request = (
            mav.MAVLink_mission_request_message
            if self.autopilot == ARDUPILOT
            else mav.MAVLink_mission_request_int_message
        )
        self.send(request(*self._sender, len(self.missions.upload), self.missions.kind))

    def _mission_item(self, message: Any) -> None:
        missions = self.missions
        if self.autopilot == PX4 and message.seq == missions.count - 1 < len(missions.upload):
            self._mission_ack(0)  # PX4 acknowledges the last item again: the ground station has missed that
        elif message.seq == missions.count - 1 < len(missions.upload):
            self._mission_ack(1)  # ArduPilot receives nothing any more: MAV_MISSION_ERROR
        elif message.seq < len(missions.upload) < missions.count:
            self._request_item()  # the request for the next one was lost
        if message.seq != len(missions.upload) or message.seq >= missions.count:
            return
        if message.seq in missions.refuse:
            self._mission_ack(missions.refuse[message.seq])
            missions.count = 0
            return
        missions.upload.append(message)
        if len(missions.upload) < missions.count:
            self._request_item()
        else:
            missions.items[missions.kind] = missions.upload
            self._mission_ack(0)

    def _mission_ack(self, result: int) -> None:
        self.send(mav.MAVLink_mission_ack_message(*self._sender, result, self.missions.kind))

    def _mission_list(self, message: Any) -> None:
        items = self.missions.items[message.mission_type]
        self.send(mav.MAVLink_mission_count_message(*self._sender, len(items), message.mission_type))

    def _mission_request(self, message: Any) -> None:
        items = self.missions.items[message.mission_type]
        if message.seq < len(items):
            item = items[message.seq]
            item.target_system, item.target_component = self._sender
            self.send(item)

    def _mission_clear(self, message: Any) -> None:
        self.missions.kind = message.mission_type
        self.missions.items[message.mission_type] = []
        self._mission_ack(0)

    # ---- logs ----

    def _log_list(self, message: Any) -> None:
        last = len(self.logs)
        for number, data in enumerate(self.logs, 1):
            if message.start <= number <= message.end:
                self.send(mav.MAVLink_log_entry_message(number, last, last, 1_700_000_000 + number, len(data)))
        if not self.logs:
            self.send(mav.MAVLink_log_entry_message(0, 0, 0, 0, 0))

    def _log_data(self, message: Any) -> None:
        if not 1 <= message.id <= len(self.logs):
            return
        data = self.logs[message.id - 1]
        for offset in range(message.ofs, min(message.ofs + message.count, len(data)), 90):
            piece = data[offset : offset + 90]
            self.send(mav.MAVLink_log_data_message(message.id, offset, len(piece), list(piece.ljust(90, b"\0"))))
            if offset % 9000 == 0:
                time.sleep(0.005)


_ANSWERS: dict[str, Callable[[ForeignVehicle, Any], None]] = {
    "COMMAND_LONG": ForeignVehicle._command,
    "COMMAND_INT": ForeignVehicle._command,
    "TIMESYNC": ForeignVehicle._timesync,
    "PARAM_REQUEST_LIST": ForeignVehicle._list,
    "PARAM_REQUEST_READ": ForeignVehicle._read,
    "PARAM_SET": ForeignVehicle._set,
    "FILE_TRANSFER_PROTOCOL": ForeignVehicle._ftp,
    "MISSION_COUNT": ForeignVehicle._mission_count,
    "MISSION_ITEM_INT": ForeignVehicle._mission_item,
    "MISSION_REQUEST_LIST": ForeignVehicle._mission_list,
    "MISSION_REQUEST_INT": ForeignVehicle._mission_request,
    "MISSION_CLEAR_ALL": ForeignVehicle._mission_clear,
    "LOG_REQUEST_LIST": ForeignVehicle._log_list,
    "LOG_REQUEST_DATA": ForeignVehicle._log_data,
    "LOG_ERASE": lambda vehicle, _: vehicle.logs.clear(),
}


def many_params(count: int) -> Iterator[tuple[str, ForeignParam]]:
    """Yield parameters of all ArduPilot types, with names that share beginnings."""
    kinds = ((2, -127), (4, -3000), (6, 2_000_000_000), (REAL32, 0.1))
    for number in range(count):
        kind, value = kinds[number % 4]
        default = None if number % 3 else value - 1
        yield f"GRP{number // 30:02}_PARAM_{number:04}"[:16], ForeignParam(float(value), kind, default)
