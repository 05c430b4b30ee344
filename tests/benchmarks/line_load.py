"""A second ground station on a serial line that requests all parameters and a file, again and again: bytes only."""

from __future__ import annotations

from dialects.enums import Autopilot, SystemState, VehicleType
from dialects.messages import Heartbeat, Message, ParamRequestList
from link.services.ftp.protocol import FtpOpcode, FtpPacket
from tests.benchmarks.traffic import framed

SYSTEM, COMPONENT = 254, 190
"""Ids that differ from those of the real ground station, whose sequence numbers stay without gaps."""
VEHICLE = (1, 1)
PERIOD = 0.5
"""s between two rounds of requests: an answer takes longer at 57600 baud, so that one is always in transit."""
FILE = b"@PARAM/param.pck"


class Requester:
    """The bytes of the second station, as they become due."""

    def __init__(self) -> None:
        self._due = 0.0
        self._frames = 0
        self._questions = 0

    def due(self, now: float) -> bytes:
        """Return the requests of a round, when a round is due."""
        if now < self._due:
            return b""
        self._due = now + PERIOD
        heartbeat = Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)
        ask_file = [self._ftp(FtpOpcode.RESET), self._ftp(FtpOpcode.OPEN, FILE), self._ftp(FtpOpcode.BURST)]
        return b"".join(map(self._frame, [heartbeat, ParamRequestList(*VEHICLE), *ask_file]))

    def _ftp(self, op: FtpOpcode, data: bytes = b"") -> Message:
        self._questions = (self._questions + 2) & 0xFFFF
        size = 239 if op is FtpOpcode.BURST else None  # of a burst: the size of each message
        return FtpPacket(self._questions, op, 0, data, size=size).message(*VEHICLE)

    def _frame(self, message: Message) -> bytes:
        self._frames = (self._frames + 1) & 0xFF
        return framed(message, self._frames, SYSTEM, COMPONENT)
