"""A vehicle of another make with parameters, plans, files and logs, as ArduPilot and PX4 answer them.

Measured on ArduRover 4.7-dev: missions are requested with MISSION_REQUEST, the last item is not acknowledged again.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from link.core import Received
from tests.fakes.ftp import ForeignFtp
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle, Part
from tests.fakes.wires import PymavlinkWire

ARDUPILOT, PX4 = int(Autopilot.ARDUPILOT), int(Autopilot.PX4)
LOG_PIECE = 90


class Missions:
    """The plans, and an upload under way."""

    def __init__(self) -> None:
        self.items: dict[int, list[Any]] = {0: [], 1: [], 2: []}
        """MAV_MISSION_TYPE -> MISSION_ITEM_INT."""
        self.refuse: dict[int, int] = {}
        """Item -> MAV_MISSION_RESULT with which the upload ends there."""
        self._upload: list[Any] = []
        self._count = self._kind = 0
        self._sender = (255, 190)

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Take uploads, answer downloads."""
        message: Any = received.message
        self._sender = received.system, received.component
        match message:
            case m.MissionCount():
                self._begin(vehicle, message)
            case m.MissionItemInt():
                self._item(vehicle, message)
            case m.MissionRequestList():
                count = len(self.items[message.mission_type])
                vehicle.send(m.MissionCount(*self._sender, count, message.mission_type))
            case m.MissionRequestInt() if message.seq < len(self.items[message.mission_type]):
                item = self.items[message.mission_type][message.seq]
                item.target_system, item.target_component = self._sender
                vehicle.send(item)
            case m.MissionClearAll():
                self._kind = message.mission_type
                self.items[self._kind] = []
                self._end(vehicle, 0)

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send nothing of its own."""

    def _begin(self, vehicle: FakeVehicle, message: m.MissionCount) -> None:
        self._upload, self._count, self._kind = [], message.count, message.mission_type
        if self._count:
            self._request(vehicle)
        else:
            self.items[self._kind] = []
            self._end(vehicle, 0)

    def _request(self, vehicle: FakeVehicle) -> None:
        request = m.MissionRequest if vehicle.autopilot == ARDUPILOT else m.MissionRequestInt
        vehicle.send(request(*self._sender, len(self._upload), self._kind))

    def _item(self, vehicle: FakeVehicle, message: m.MissionItemInt) -> None:
        if message.seq == self._count - 1 < len(self._upload):
            # PX4 acknowledges the last item again; ArduPilot receives nothing any more: MAV_MISSION_ERROR
            self._end(vehicle, 0 if vehicle.autopilot == PX4 else 1)
        elif message.seq < len(self._upload) < self._count:
            self._request(vehicle)  # the request for the next one was lost
        if message.seq != len(self._upload) or message.seq >= self._count:
            return
        if message.seq in self.refuse:
            self._end(vehicle, self.refuse[message.seq])
            self._count = 0
            return
        self._upload.append(message)
        if len(self._upload) < self._count:
            self._request(vehicle)
        else:
            self.items[self._kind] = self._upload
            self._end(vehicle, 0)

    def _end(self, vehicle: FakeVehicle, result: int) -> None:
        vehicle.send(m.MissionAck(*self._sender, result, self._kind))


class Files:
    """The file service."""

    def __init__(self, server: ForeignFtp) -> None:
        self._server = server

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Answer FILE_TRANSFER_PROTOCOL."""
        if isinstance(received.message, m.FileTransferProtocol):
            for payload in self._server.answer(bytes(received.message.payload)):
                vehicle.send(m.FileTransferProtocol(0, received.system, received.component, payload))

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send nothing of its own."""


class Logs(list[bytes]):
    """The logs, numbered from 1."""

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """List, send and erase them."""
        match received.message:
            case m.LogRequestList() as message:
                for number, data in enumerate(self, 1):
                    if message.start <= number <= message.end:
                        vehicle.send(m.LogEntry(number, len(self), len(self), 1_700_000_000 + number, len(data)))
                if not self:
                    vehicle.send(m.LogEntry(0, 0, 0, 0, 0))
            case m.LogRequestData() as message if 1 <= message.id <= len(self):
                data = self[message.id - 1]
                for offset in range(message.ofs, min(message.ofs + message.count, len(data)), LOG_PIECE):
                    piece = data[offset : offset + LOG_PIECE]
                    padded = list(piece.ljust(LOG_PIECE, b"\0"))
                    vehicle.send(m.LogData(message.id, offset, len(piece), padded))
            case m.LogErase():
                self.clear()

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send nothing of its own."""


class ModeList:
    """AUTOPILOT_VERSION and AVAILABLE_MODES on request."""

    def __init__(self, owner: ForeignVehicle, *, ftp: bool) -> None:
        self._owner, self._ftp = owner, ftp

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Answer REQUEST_MESSAGE for the two."""
        message: Any = received.message
        if not isinstance(message, m.CommandLong | m.CommandInt) or message.command != Command.REQUEST_MESSAGE:
            return
        if message.command in vehicle.silent_on or vehicle.answers.get(message.command, 0) != 0:
            return
        if message.param1 == m.AutopilotVersion.id:
            capabilities = 2 | 8 | (0 if vehicle.autopilot == ARDUPILOT else 16) | (32 if self._ftp else 0)
            none = [0] * 8
            vehicle.send(m.AutopilotVersion(capabilities, 0, 0, 0, 0, none, none, none, 0, 0, 0))
        elif message.param1 == m.AvailableModes.id:
            index = int(message.param2)
            modes = self._owner.modes
            chosen = enumerate(modes, 1) if index == 0 else [(index, modes[index - 1])]
            for at, (name, custom, properties) in chosen:
                standard = self._owner.standard_modes.get(custom, 0)
                vehicle.send(m.AvailableModes(len(modes), at, standard, custom, properties, name.encode()))

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send nothing of its own."""


class Px4Calibration:
    """Calibrations at rest as PX4 does them: accepted at the start, the end in a text; others are refused meanwhile."""

    def __init__(self) -> None:
        self.seconds = 0.4
        self.failure = ""
        """A text in place of the one that it is done."""
        self._name, self._ends_at = "", 0.0

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Begin what was accepted; FakeVehicle has answered."""
        message: Any = received.message
        if vehicle.autopilot != PX4 or not isinstance(message, m.CommandLong) or vehicle.calibrating:
            return
        if message.command == Command.PREFLIGHT_CALIBRATION and not vehicle.answers.get(message.command):
            parts = (message.param1, message.param2, message.param3, message.param5)
            self._name = next(
                (each for each, on in zip(("gyro", "mag", "baro", "level"), parts, strict=True) if on), ""
            )
            self._ends_at, vehicle.calibrating = now + self.seconds, True
            vehicle.answers[Command.PREFLIGHT_CALIBRATION] = Result.TEMPORARILY_REJECTED, "motion, retrying.."
            vehicle.silent_on.discard(message.command)  # at most the first COMMAND_ACK is lost
            vehicle.say(f"[cal] calibration started: 2 {self._name}", 6)
            vehicle.beat()

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """End it."""
        if vehicle.calibrating and now >= self._ends_at:
            vehicle.calibrating = False
            del vehicle.answers[Command.PREFLIGHT_CALIBRATION]
            vehicle.say(self.failure or f"[cal] calibration done: {self._name}", 2 if self.failure else 6)
            vehicle.beat()


class ForeignVehicle(FakeVehicle):
    """An ArduPilot or PX4 rover with all services."""

    def __init__(self, autopilot: int = ARDUPILOT, *, ftp: bool = True, system: int = 1) -> None:
        self.missions, self.logs = Missions(), Logs()
        self.modes: list[tuple[str, int, int]] = []
        """Name, custom_mode and properties of AVAILABLE_MODES."""
        self.standard_modes: dict[int, int] = {}
        """custom_mode -> MAV_STANDARD_MODE in AVAILABLE_MODES."""
        self.files = ForeignFtp(lambda: self.params.packed() if autopilot == ARDUPILOT else None)
        self.calibration = Px4Calibration()
        parts: list[Part] = [self.missions, self.logs, self.calibration, ModeList(self, ftp=ftp)]
        parts += [Files(self.files)] if ftp else []
        super().__init__(autopilot=autopilot, system=system, mode=0, parts=parts)


def foreign_vehicle(
    autopilot: int = ARDUPILOT, *, ftp: bool = True, system: int = 1, loss: float = 0.0, loss_in: float = 0.0
) -> AbstractContextManager[ForeignVehicle]:
    """Run a ForeignVehicle on UDP, framed by pymavlink; the program under test is the one that sends first."""
    vehicle = ForeignVehicle(autopilot, ftp=ftp, system=system)
    return on_line(vehicle, "udpout", wire=PymavlinkWire(), loss=loss, loss_in=loss_in)
