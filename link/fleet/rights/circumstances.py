"""Whether a frame that else needs the role drive may come from a watcher: it stops, or ends the watcher's own. Sans-IO.

Both ends ask. The ground station knows the vehicles by their HEARTBEATs; the vehicle's end knows its own autopilot, and
who transfers plans, logs and files, because everybody's frames pass it.
"""

from __future__ import annotations

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot
from dialects.kinds import find_kind
from dialects.mode_tables import HOLD
from dialects.modes import Mode
from link.fleet.roles import WatchCondition, file_opcode, target_of, watch_condition
from link.protocol.frame import Frame, payload_of

TRANSFER_LASTS = 10.0
"""s after its last frame; ArduPilot and PX4 give up a transfer after 5 to 10 s."""
MAX_AUTOPILOTS = 512
"""Autopilots that are remembered; of a fleet of 250 vehicles."""
MAX_SENDERS = 64
"""Programs whose transfers are remembered, of each kind."""

_TRANSFERS = {
    **dict.fromkeys(
        (
            message.id
            for message in (
                m.MissionRequestList, m.MissionRequestPartialList, m.MissionRequest, m.MissionRequestInt,
                m.MissionCount, m.MissionItem, m.MissionItemInt, m.MissionWritePartialList,
            )
        ),
        WatchCondition.PLAN,
    ),
    **dict.fromkeys((m.LogRequestList.id, m.LogRequestData.id), WatchCondition.LOG),
}  # fmt: skip
"""Messages that begin a transfer or go on with it."""
_OPEN_FILE_OPCODES = frozenset((4, 5, 6, 7, 11, 15))
"""Of MAV_FTP_OPCODE, with a session: open, read, create, write, open to write, burst."""


class Circumstances:
    """What one end of a fleet knows of autopilots and transfers."""

    def __init__(self) -> None:
        self._holds: dict[tuple[int, int], bool] = {}
        """System and component of an autopilot -> whether its custom mode 4 is HOLD."""
        self._transfers: dict[WatchCondition, dict[str, float]] = {}
        """Kind -> sender -> time of its last frame, in s."""

    def note_heartbeat(self, frame: Frame) -> None:
        """Record the autopilot that has sent this HEARTBEAT."""
        beat = codec.decode(frame[0], payload_of(frame[4]))
        if not isinstance(beat, m.Heartbeat) or beat.autopilot == Autopilot.INVALID:
            return
        if (frame[1], frame[2]) in self._holds or len(self._holds) < MAX_AUTOPILOTS:
            self._holds[frame[1], frame[2]] = find_kind(beat.autopilot, beat.type).modes.get(Mode.HOLD) == HOLD

    def note_transfer(self, frame: Frame, sender: str, now: float) -> None:
        """Record that a frame of a transfer came from `sender`."""
        kind = _transfer_of(frame)
        if kind is None:
            return
        senders = self._transfers.setdefault(kind, {})
        if sender not in senders and len(senders) >= MAX_SENDERS:
            del senders[min(senders, key=senders.__getitem__)]
        senders[sender] = now

    def holds(self, system: int) -> bool:
        """Return whether custom mode 4 is HOLD for each autopilot of a system (0: of all), and one was heard."""
        meant = [holds for (each, _), holds in self._holds.items() if system in (0, each)]
        return bool(meant) and all(meant)

    def allows_watcher(self, frame: Frame, sender: str, now: float) -> bool:
        """Return whether a frame whose needed_role() is drive may come from a watcher."""
        condition = watch_condition(frame)
        if condition is WatchCondition.HOLD:
            return self.holds(target_of(frame))
        if condition is None:
            return False
        senders = self._transfers.get(condition, {})
        return all(each == sender or now - at > TRANSFER_LASTS for each, at in senders.items())

    def forget_sender(self, sender: str) -> None:
        """Forget the transfers of a program that has gone."""
        for senders in self._transfers.values():
            senders.pop(sender, None)


def _transfer_of(frame: Frame) -> WatchCondition | None:
    if frame[0] == m.FileTransferProtocol.id:
        return WatchCondition.FILE if file_opcode(frame) in _OPEN_FILE_OPCODES else None
    return _TRANSFERS.get(frame[0])
