"""What QGroundControl does when it connects to a vehicle: its steps in their order, its retries and time limits.

Written after reading InitialConnectStateMachine, StandardModes, RequestMetaDataTypeStateMachine and ParameterManager of
its sources; it is not QGroundControl. It is stricter: where QGroundControl would continue without an answer, this
repeats the request and counts it in `repeats`, or fails. Files and plans are in qgc_files.py and qgc_plans.py.
"""

from __future__ import annotations

import json
import lzma
import socket
import time
from collections import deque
from collections.abc import Callable
from typing import TypeVar

from dialects import codec
from dialects import messages as m
from dialects.enums import Command, Result
from link.protocol.framer import Framer
from link.services.ftp.protocol import crc32
from tests.interop.qgc_files import LIMIT, Download, DownloadError
from tests.waits import PATIENCE, Patience

Kind = TypeVar("Kind", bound=m.Message)

SYSTEM, COMPONENT = 255, 190
TRIES, COMMAND_LIMIT = 3, 3.0
"""Retries of a command, and s for each."""
PARAMETERS_BEGIN, PARAMETERS_GAP = 5.0, 3.0
"""s until the first parameter, and between two."""
PARAMETER_TRIES, PARAMETER_BATCH = 5, 10
"""Retries for missing parameters, and how many are requested at once."""
NOT_SELECTABLE = 2
"""MAV_MODE_PROPERTY_NOT_USER_SELECTABLE."""
JOYSTICK = 1 / 25
"""s between two MANUAL_CONTROL."""
NEUTRALS = 8
"""Neutral messages before the stick moves: more than a lossy link loses in a row."""


class QGroundControl:
    """One connection.

    `haste` divides the time limits of its requests, which makes it stricter by that factor. `clicks` is how often its
    user retries what it has given up.
    """

    def __init__(self, port: int, system: int = SYSTEM, haste: float = 1.0, clicks: int = 1) -> None:
        self._system = system
        self._haste = haste
        self._clicks = clicks
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", port))
        self._framer = Framer(stream=False)
        self._vehicle: tuple[str, int] | None = None
        self._sequence = 0
        self._beat_due = 0.0
        self._unread: deque[m.Message] = deque()
        """A datagram may hold several frames; those behind what was waited for."""
        self.watch: Callable[[m.Message], object] = lambda message: None
        """Called with every message that arrives."""
        self.repeats = 0
        """Requests that had to be repeated."""

    def __enter__(self) -> QGroundControl:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self._socket.close()

    # ---- messages ----

    def send(self, message: m.Message) -> None:
        """Send a message to the vehicle."""
        assert self._vehicle is not None
        payload = codec.encode_payload(message)
        self._socket.sendto(
            codec.frame(type(message).id, payload, self._sequence, self._system, COMPONENT), self._vehicle
        )
        self._sequence = (self._sequence + 1) & 0xFF

    def wait(
        self, kind: type[Kind], within: float, wanted: Callable[[Kind], bool] = lambda message: True
    ) -> Kind | None:
        """Return the next message of a kind that is `wanted`; None if there is none."""
        deadline = time.monotonic() + within
        while (left := deadline - time.monotonic()) > 0:
            while self._unread:
                message = self._unread.popleft()
                self.watch(message)
                if isinstance(message, kind) and wanted(message):
                    return message
            self._beat()
            self._socket.settimeout(min(left, 0.2))
            try:
                data, self._vehicle = self._socket.recvfrom(65536)
            except TimeoutError:
                continue
            frames = self._framer.feed(data, time.monotonic())
            self._unread.extend(codec.decode_frame(message_id, raw) for message_id, *_, raw in frames)
        return None

    def listen(self, seconds: float) -> None:
        """Receive for a while."""
        self.wait(m.Message, seconds, lambda message: False)

    def _beat(self) -> None:
        """Send its HEARTBEAT, armed and active, once a second."""
        if self._vehicle is not None and time.monotonic() >= self._beat_due:
            self._beat_due = time.monotonic() + 1
            self.send(m.Heartbeat(6, 8, 128, 0, 4, 3))

    # ---- the steps ----

    def meet(self) -> None:
        """Step 0: wait for a HEARTBEAT of component 1 of a vehicle."""
        beat = self.wait(m.Heartbeat, PATIENCE, lambda each: each.type not in (6, 18, 26, 27))
        assert beat is not None
        self._beat()  # repeated: the first may be sent before it has found a vehicle

    def command(self, command: int, *params: float) -> Result:
        """Send a command, with retries."""
        full = (*params, *(0.0,) * (7 - len(params)))
        for confirmation in range(TRIES * self._clicks):
            self.repeats += confirmation > 0
            self.send(m.CommandLong(1, 1, command, confirmation, *full))
            ack = self.wait(m.CommandAck, COMMAND_LIMIT / self._haste, lambda each: each.command == command)
            if ack is not None:
                return Result(ack.result)
        raise AssertionError(f"no answer to command {command}")

    def request(self, kind: type[Kind], *params: float) -> Kind:
        """Send REQUEST_MESSAGE; wait for the message and the acknowledgement, in either order."""
        for confirmation in range(TRIES * self._clicks):
            self.repeats += confirmation > 0
            full = (kind.id, *params, *(0.0,) * (6 - len(params)))
            self.send(m.CommandLong(1, 1, Command.REQUEST_MESSAGE, confirmation, *full))
            came: dict[type[m.Message], m.Message] = {}

            def both(message: m.Message, came: dict[type[m.Message], m.Message] = came) -> bool:
                if isinstance(message, kind | m.CommandAck):
                    came.setdefault(type(message), message)
                return len(came) == 2

            self.wait(m.Message, COMMAND_LIMIT / self._haste, both)
            answer = came.get(kind)
            if isinstance(answer, kind) and m.CommandAck in came:
                return answer
        raise AssertionError(f"no {kind.msgname}")

    def modes(self) -> list[str]:
        """Step 3: return the names of all modes that a driver may select; the last one ends the list.

        A lost mode is requested again, where QGroundControl would continue without it.
        """
        mode = self.request(m.AvailableModes, 0)
        modes = {mode.mode_index: mode}
        while mode.mode_index < mode.number_modes:
            following = self.wait(m.AvailableModes, COMMAND_LIMIT / self._haste)
            if following is None:
                break
            mode = following
            modes[mode.mode_index] = mode
        for index in set(range(1, mode.number_modes + 1)) - modes.keys():
            self.repeats += 1
            modes[index] = self.request(m.AvailableModes, index)
        return [each.mode_name for _, each in sorted(modes.items()) if not each.properties & NOT_SELECTABLE]

    def metadata(self) -> dict[str, dict[str, object]]:
        """Step 4: return the parameter metadata, by name."""
        told = self.request(m.ComponentMetadata)
        general = self.download(told.uri.removeprefix("mftp://"))
        assert crc32(general) == told.file_crc
        (kind,) = [each for each in json.loads(lzma.decompress(general))["metadataTypes"] if each["type"] == 1]
        packed = self.download(kind["uri"].removeprefix("mftp://"))
        assert crc32(packed) == kind["fileCrc"]
        return {each["name"]: each for each in json.loads(lzma.decompress(packed))["parameters"]}

    def download(self, path: str) -> bytes:
        """Download a file, with a retry where QGroundControl would continue without it."""
        for _ in range(TRIES * self._clicks):
            try:
                return Download(self, path, LIMIT / self._haste).run()
            except DownloadError:
                self.repeats += 1
        raise AssertionError(f"no {path}")

    def parameters(self) -> dict[str, float]:
        """Step 5: read the whole parameter list; missing ones are requested by index."""
        values: dict[int, m.ParamValue] = {}
        self.send(m.ParamRequestList(1, 0))
        for _ in range(PARAMETER_TRIES * self._clicks):
            limit = PARAMETERS_GAP if values else PARAMETERS_BEGIN
            while value := self.wait(m.ParamValue, limit / self._haste):
                values[value.param_index] = value
                limit = PARAMETERS_GAP
                if len(values) == value.param_count:
                    return {values[number].param_id: values[number].param_value for number in sorted(values)}
            self.repeats += 1
            self._ask_for_missing(values)
        raise AssertionError("Vehicle did not respond to request for parameters")

    def _ask_for_missing(self, values: dict[int, m.ParamValue]) -> None:
        if not values:
            self.send(m.ParamRequestList(1, 0))
            return
        total = next(iter(values.values())).param_count
        for number in [number for number in range(total) if number not in values][:PARAMETER_BATCH]:
            self.send(m.ParamRequestRead(1, 1, b"", number))

    def joystick(self, throttle: int, until: Callable[[], bool], within: float = PATIENCE) -> bool:
        """Send its joystick, 25 times a second, until `until`; return False if that does not become true."""
        deadline = time.monotonic() + within
        while not until():
            if time.monotonic() > deadline:
                return False
            self._stick(throttle)
        return True

    def drive(self, throttle: int, until: Callable[[], bool]) -> None:
        """Send neutral, then the joystick, until `until`; again and in MANUAL, if a pause has ended in HOLD."""
        patience = Patience()
        self.neutral()
        while not self.joystick(throttle, until, 5.0):
            assert not patience.ended
            self.command(Command.DO_SET_MODE, 1, 0)
            self.neutral()

    def neutral(self) -> None:
        """Hold the stick at rest for a moment."""
        for _ in range(NEUTRALS):
            self._stick(0)

    def _stick(self, throttle: int) -> None:
        self.send(m.ManualControl(target=1, x=throttle, y=0, z=0, r=0, buttons=0))
        self.wait(m.FileTransferProtocol, JOYSTICK)
