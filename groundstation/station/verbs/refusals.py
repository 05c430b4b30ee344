"""Messages that a link does not send because our role does not allow them: who wanted them is told at once, and why."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.axes import build_neutral
from dialects.enums import OperatorFlag, Severity
from dialects.messages import INVALID_AXIS
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.station.driving.commander import Commander
from groundstation.station.verbs.running_verbs import RunningVerbs
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog

SAY_AGAIN = 5.0
"""s between two lines of the log with the same reason: demands are repeated 20 times a second."""
_COMMANDS = (m.CommandLong, m.CommandInt)
_DEMANDS = (m.ManualControl, m.RoverOperatorPresence)


class Refusals:
    """Tells verbs, commands and requests that wait for an answer, and the operator."""

    def __init__(self, fleet: Fleet, commander: Commander, verbs: RunningVerbs, log: MessageLog) -> None:
        self._fleet, self._commander, self._verbs, self._log = fleet, commander, verbs, log
        self._said: tuple[str, float] = ("", -math.inf)

    def handle(self, message: m.Message, why: str, now: float) -> None:
        """Note that `message` was not sent."""
        if self._verbs.handle_refused(message, why, now):
            return
        self._verbs.tell_alone(message, why, now)
        contact = self._fleet.get(m.target_system(message))
        if contact is None or not _is_wanted(message, contact):
            return
        self._commander.handle_refused(message, why, now)
        if contact.services is not None:
            contact.services.handle_refused(message, why, now)
        if not isinstance(message, _COMMANDS):
            self._say(contact, why, now)

    def _say(self, contact: Contact, why: str, now: float) -> None:
        text = f"{contact.state.name}: not sent: {why}"
        if text != self._said[0] or now - self._said[1] >= SAY_AGAIN:
            self._said = text, now
            self._log.add(now, "station", text, Severity.WARNING, origin=LogOrigin(contact.state.system))


def _is_wanted(message: m.Message, contact: Contact) -> bool:
    """Return whether the operator wants it: proofs of the session and neutral demands the station sends by itself."""
    return not isinstance(message, _DEMANDS) or _moves(message, contact)


def _moves(message: m.ManualControl | m.RoverOperatorPresence, contact: Contact) -> bool:
    """Return whether a demand requests motion, and does not only show that somebody is there."""
    if isinstance(message, m.RoverOperatorPresence):
        axes = (message.x, message.y, message.z, message.r) if message.flags & OperatorFlag.AXES else ()
        return any(axis not in (0, INVALID_AXIS) for axis in axes)
    neutral = build_neutral(message.target, contact.state.autopilot, contact.state.kind)
    axes = (message.x, message.y, message.z, message.r)
    return any(
        axis not in (rest, INVALID_AXIS)
        for axis, rest in zip(axes, (neutral.x, neutral.y, neutral.z, neutral.r), strict=True)
    )
