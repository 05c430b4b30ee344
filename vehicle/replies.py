"""Questions that one message answers at once: time, ping, and "nothing here" for plans, files and logs.

Silence would cost the asker its repeats: MAVProxy waits 10 s for a file server that never answers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import timesync

FTP_OPCODE, FTP_ACK, FTP_NAK, FTP_SIZE = 3, 128, 129, 251
"""MAVLink FTP (mavlink.io/en/services/ftp.html): place of the opcode, the answers' opcodes, length."""
FTP_FILE_NOT_FOUND, FTP_UNKNOWN_COMMAND = 10, 7
FTP_OPEN_RO, FTP_TERMINATE, FTP_RESET = 4, 1, 2


class Replies:
    """Answers for one system and component."""

    def __init__(self, system: int, component: int) -> None:
        self._ids = (system, component)

    def answer(self, received: Received, now: float) -> list[Outgoing]:
        """The answer, or nothing where the message asks nothing of us."""
        found = _ANSWERS.get(type(received.message))
        if found is None:
            return timesync.answer(received, now, self._ids[0])
        return [Outgoing(found(received), received.peer)] if self._for_us(received.message) else []

    def _for_us(self, message: Any) -> bool:
        return message.target_system == self._ids[0] and message.target_component in (0, self._ids[1])


def _no_mission(received: Received) -> m.Message:
    asked: Any = received.message
    return m.MissionCount(received.system, received.component, 0, mission_type=asked.mission_type)


def _no_logs(received: Received) -> m.Message:
    return m.LogEntry(id=0, num_logs=0, last_log_num=0, time_utc=0, size=0)


def _no_file(received: Received) -> m.Message:
    """NAK, but a session that never was is closed without complaint."""
    message: Any = received.message
    asked = bytes(message.payload)
    opcode = asked[FTP_OPCODE]
    closing = opcode in (FTP_TERMINATE, FTP_RESET)
    sequence = (int.from_bytes(asked[:2], "little") + 1) & m.UINT16_MAX
    fault = FTP_FILE_NOT_FOUND if opcode == FTP_OPEN_RO else FTP_UNKNOWN_COMMAND
    # sequence, session, opcode, size, the opcode answered, 1 byte burst flag, 1 byte padding, 4 bytes offset, data
    head = sequence.to_bytes(2, "little") + bytes(
        (asked[2], FTP_ACK if closing else FTP_NAK, 0 if closing else 1, opcode)
    )
    body = head + bytes(6) + (b"" if closing else bytes((fault,)))
    return m.FileTransferProtocol(0, received.system, received.component, list(body.ljust(FTP_SIZE, b"\0")))


_ANSWERS: dict[type[m.Message], Callable[[Received], m.Message]] = {
    m.MissionRequestList: _no_mission,
    m.LogRequestList: _no_logs,
    m.FileTransferProtocol: _no_file,
}
"""Message -> answer. Missions, files and logs are not offered yet."""
