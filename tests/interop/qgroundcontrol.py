"""What QGroundControl does when it meets a vehicle: its steps in their order, its repeats and time limits.

Written after reading InitialConnectStateMachine, StandardModes, RequestMetaDataTypeStateMachine and ParameterManager of
its sources; it is not QGroundControl. It is stricter: where QGroundControl would go on after a time limit, this fails.
"""

from __future__ import annotations

import json
import lzma
import socket
import time
from collections.abc import Callable
from typing import TypeVar

from dialects import codec
from dialects import messages as m
from dialects.enums import Command, Result
from link.framer import Framer
from link.services.ftp import FtpPacket, Op, crc32, parse

Kind = TypeVar("Kind", bound=m.Message)

SYSTEM, COMPONENT = 255, 190
TRIES, COMMAND_LIMIT = 3, 3.0
"""Of a command, and s for each."""
PARAMETERS_BEGIN, PARAMETERS_GAP = 5.0, 3.0
"""s until the first parameter, and between two."""
PLAN_LIMIT, FTP_LIMIT = 1.5, 1.0
"""s; ours."""
NOT_SELECTABLE = 2
"""MAV_MODE_PROPERTY_NOT_USER_SELECTABLE."""
JOYSTICK = 1 / 25
"""s between two MANUAL_CONTROL."""


class QGroundControl:
    """One connection."""

    def __init__(self, port: int, system: int = SYSTEM) -> None:
        self._system = system
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", port))
        self._framer = Framer(stream=False)
        self._vehicle: tuple[str, int] | None = None
        self._sequence = 0
        self._ftp_sequence = 0
        self._beat_due = 0.0
        self.repeats = 0
        """Questions that had to be asked again."""

    def close(self) -> None:
        """Close its port."""
        self._socket.close()

    # ---- the wire ----

    def send(self, message: m.Message) -> None:
        """To the vehicle."""
        assert self._vehicle is not None
        payload = codec.encode_payload(message)
        self._socket.sendto(
            codec.frame(type(message).id, payload, self._sequence, self._system, COMPONENT), self._vehicle
        )
        self._sequence = (self._sequence + 1) & 0xFF

    def wait(
        self, kind: type[Kind], within: float, wanted: Callable[[Kind], bool] = lambda message: True
    ) -> Kind | None:
        """The next message of a kind that is `wanted`; None where it does not come."""
        deadline = time.monotonic() + within
        while (left := deadline - time.monotonic()) > 0:
            self._beat()
            self._socket.settimeout(min(left, 0.2))
            try:
                data, self._vehicle = self._socket.recvfrom(65536)
            except TimeoutError:
                continue
            for frame in self._framer.feed(data, time.monotonic()):
                message = codec.decode(frame.message_id, frame.payload)
                if isinstance(message, kind) and wanted(message):
                    return message
        return None

    def _beat(self) -> None:
        """Its HEARTBEAT: armed and active, once a second."""
        if self._vehicle is not None and time.monotonic() >= self._beat_due:
            self._beat_due = time.monotonic() + 1
            self.send(m.Heartbeat(6, 8, 128, 0, 4, 3))

    # ---- the steps ----

    def meet(self) -> None:
        """0: a HEARTBEAT of component 1 that is a vehicle's."""
        beat = self.wait(m.Heartbeat, 15, lambda each: each.type not in (6, 18, 26, 27))
        assert beat is not None

    def command(self, command: int, *params: float) -> Result:
        """With its repeats."""
        full = (*params, *(0.0,) * (7 - len(params)))
        for confirmation in range(TRIES):
            self.repeats += confirmation > 0
            self.send(m.CommandLong(1, 1, command, confirmation, *full))
            ack = self.wait(m.CommandAck, COMMAND_LIMIT, lambda each: each.command == command)
            if ack is not None:
                return Result(ack.result)
        raise AssertionError(f"no answer to command {command}")

    def request(self, kind: type[Kind], *params: float) -> Kind:
        """REQUEST_MESSAGE: the message and the acknowledgement, in either order."""
        for confirmation in range(TRIES):
            self.repeats += confirmation > 0
            full = (kind.id, *params, *(0.0,) * (6 - len(params)))
            self.send(m.CommandLong(1, 1, Command.REQUEST_MESSAGE, confirmation, *full))
            came: dict[type[m.Message], m.Message] = {}

            def both(message: m.Message, came: dict[type[m.Message], m.Message] = came) -> bool:
                if isinstance(message, kind | m.CommandAck):
                    came.setdefault(type(message), message)
                return len(came) == 2

            self.wait(m.Message, COMMAND_LIMIT, both)
            answer = came.get(kind)
            if isinstance(answer, kind) and m.CommandAck in came:
                return answer
        raise AssertionError(f"no {kind.msgname}")

    def modes(self) -> list[str]:
        """3: the names of all modes that a driver may choose; the last one ends it."""
        mode = self.request(m.AvailableModes, 0)
        modes = [mode]
        while mode.mode_index < mode.number_modes:
            following = self.wait(m.AvailableModes, COMMAND_LIMIT)
            assert following is not None
            mode = following
            modes.append(mode)
        assert [each.mode_index for each in modes] == list(range(1, mode.number_modes + 1))
        return [each.mode_name for each in modes if not each.properties & NOT_SELECTABLE]

    def metadata(self) -> dict[str, dict[str, object]]:
        """4: what the parameters mean, by name."""
        told = self.request(m.ComponentMetadata)
        general = self.download(told.uri.removeprefix("mftp://"))
        assert crc32(general) == told.file_crc
        (kind,) = [each for each in json.loads(lzma.decompress(general))["metadataTypes"] if each["type"] == 1]
        packed = self.download(kind["uri"].removeprefix("mftp://"))
        assert crc32(packed) == kind["fileCrc"]
        return {each["name"]: each for each in json.loads(lzma.decompress(packed))["parameters"]}

    def download(self, path: str) -> bytes:
        """A file by a burst."""
        opened = self._ftp(Op.OPEN, data=path.encode())
        assert opened.op == Op.ACK, path
        size = int.from_bytes(opened.data[:4], "little")
        content = b""
        piece = self._ftp(Op.BURST, session=opened.session, size=239)
        while True:
            assert (piece.op, piece.offset) == (Op.ACK, len(content))
            content += piece.data
            if len(content) >= size:
                break
            following = self.wait(m.FileTransferProtocol, FTP_LIMIT)
            assert following is not None
            piece = parse(following)
        self._ftp(Op.TERMINATE, session=opened.session)
        return content

    def _ftp(self, op: Op, *, session: int = 0, data: bytes = b"", size: int | None = None) -> FtpPacket:
        self._ftp_sequence = (self._ftp_sequence + 2) & 0xFFFF
        packet = FtpPacket(self._ftp_sequence, op, session, data, size=size)
        for attempt in range(TRIES):
            self.repeats += attempt > 0
            self.send(packet.message(1, 1))
            answer = self.wait(m.FileTransferProtocol, FTP_LIMIT, lambda each: parse(each).asked == op)
            if answer is not None:
                return parse(answer)
        raise AssertionError(f"no answer to {op.name}")

    def parameters(self) -> dict[str, float]:
        """5: the whole list."""
        self.send(m.ParamRequestList(1, 0))
        values: dict[str, float] = {}
        limit = PARAMETERS_BEGIN
        while True:
            value = self.wait(m.ParamValue, limit)
            assert value is not None, "Vehicle did not respond to request for parameters"
            values[value.param_id] = value.param_value
            limit = PARAMETERS_GAP
            if len(values) == value.param_count:
                return values

    def plan(self, kind: int) -> int:
        """6 to 8: how long a plan is."""
        for attempt in range(TRIES):
            self.repeats += attempt > 0
            self.send(m.MissionRequestList(1, 1, kind))
            count = self.wait(m.MissionCount, PLAN_LIMIT, lambda each: each.mission_type == kind)
            if count is not None:
                return int(count.count)
        raise AssertionError(f"no answer for plan {kind}")

    def joystick(self, throttle: int, steering: int, until: Callable[[], bool], within: float) -> None:
        """Its joystick for a while: x ahead, r turn, 25 times a second."""
        deadline = time.monotonic() + within
        while not until() and time.monotonic() < deadline:
            self.send(m.ManualControl(target=1, x=throttle, y=0, z=0, r=steering, buttons=0))
            self.wait(m.FileTransferProtocol, JOYSTICK)
