"""Access control: who may send a message or a command, and how a denial is reported."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from enum import Enum
from typing import Any

from dialects.enums import Rejection, Result, Severity, command_name
from dialects.messages import Message
from link.core import Outgoing, Received
from link.services.command.jobs import CommandJob
from link.services.command.request import CommandRequest
from link.services.command.server import CommandReply
from link.signing.role import SigningRole
from vehicle.drive.ownership import Ownership
from vehicle.drive.roles import role_denial
from vehicle.navigation.geo import Home
from vehicle.statustext import StatusTextQueue

GLOBAL_FRAMES = (0, 3, 5, 6)
"""MAV_FRAME_GLOBAL, MAV_FRAME_GLOBAL_RELATIVE_ALT and their _INT: frames with latitude and longitude."""
RELATIVE_FRAMES = (3, 6)
"""Frames of GLOBAL_FRAMES with an altitude above home. A position of COMMAND_LONG is in MAV_FRAME_GLOBAL, as in
ArduPilot."""

ALTITUDE_MAX = 1e5
"""m above or below sea level; beyond that it is not an altitude of a rover."""

CommandResult = Result | CommandReply | CommandJob
"""What the handler of a command returns."""
Handle = Callable[[Received, Any, float], Sequence[Outgoing] | None]
"""Handles a message, with the time; returns the replies."""


class Access(Enum):
    """Who may send a message or a command. The values are the words of docs/dialect.md."""

    ANYONE = "anyone"
    CONNECTED = "connected"
    """A sender that has sent a HEARTBEAT or connected, or is at an address that the user named."""
    INTRODUCED = "introduced"
    """A sender that has sent a HEARTBEAT."""
    DRIVER = "in control"
    """The ground station in control."""
    DRIVER_OR_UNCLAIMED = "driver"
    """The ground station in control, or any introduced one while none is in control."""


NEEDED_ROLES = {
    Access.ANYONE: SigningRole.WATCH,
    Access.CONNECTED: SigningRole.WATCH,
    Access.INTRODUCED: SigningRole.DRIVE,
    Access.DRIVER: SigningRole.DRIVE,
    Access.DRIVER_OR_UNCLAIMED: SigningRole.DRIVE,
}
"""What the key of a sender must allow, where a row says nothing else."""


class CommandAccess:
    """Checks the sender of a command and reports denials to the driver."""

    def __init__(self, ownership: Ownership, texts: StatusTextQueue) -> None:
        self._ownership = ownership
        self._texts = texts

    def deny(self, access: Access, request: CommandRequest, now: float) -> Result | None:
        """Return the result that denies a command, or None if its sender may send it."""
        if access is Access.CONNECTED:
            return None if request.may_ask else Result.TEMPORARILY_REJECTED
        if access is Access.INTRODUCED and request.introduced:
            return None
        reason = self.denial_reason(request, now)
        if reason is None:
            return None
        denied = self.reject(request, reason, now)
        return Result.TEMPORARILY_REJECTED if self._ownership.is_barred(request, now) else denied

    def deny_role(self, needed: SigningRole, request: CommandRequest, now: float) -> Result | None:
        """Return DENIED, after saying why, if the sender's key does not allow this; None if it does."""
        reason = role_denial(request, needed)
        if reason is None:
            return None
        self.reject(request, reason, now)
        return Result.DENIED

    def may_set_up(self, received: Received, now: float) -> bool:
        """Return whether a sender may change parameters or files now; it is told if its key does not allow it."""
        if reason := role_denial(received, SigningRole.SET_UP):
            text = f"GCS {received.system}: change refused: {reason}"
            self._texts.reply(received, Severity.WARNING, text, now)
            return False
        return self._ownership.denial_reason(received, now) is None

    def denial_reason(self, sender: Received | CommandRequest, now: float) -> str | None:
        """Return why a sender may not command the vehicle, or None."""
        return self._ownership.denial_reason(sender, now) if sender.introduced else "no HEARTBEAT received"

    def soften(self, result: CommandResult, request: CommandRequest, now: float) -> CommandResult:
        """Let a sender whose session is in control repeat what was refused for want of a proof.

        It may prove again soon: one of both programs was late, or a few frames were lost. Its reason has been sent.
        """
        failed = result.result if isinstance(result, CommandReply) else result
        if failed is not Result.FAILED or self._ownership.missing_proof(request, now) is None:
            return result
        return CommandReply(Result.TEMPORARILY_REJECTED, why=Rejection.NO_PROOF)

    def await_proof(self, handle: Handle) -> Handle:
        """Return a handler of a message that its sender repeats until it is answered.

        A link of the driver's session without a proof gets no answer but the reason: the repeat counts if the session
        is proven by then.
        """

        def run(received: Received, message: Message, now: float) -> Sequence[Outgoing] | None:
            reason = self._ownership.missing_proof(received, now)
            if reason is None:
                return handle(received, message, now)
            text = f"GCS {received.system}: {message.msgname} not answered: {reason}"
            self._texts.reply(received, Severity.WARNING, text, now)
            return None

        return run

    def reject(self, request: CommandRequest, reason: str, now: float) -> Result:
        """Send the reason as STATUSTEXT and return FAILED: the command may work later."""
        name = command_name(request.command)
        self._texts.reply(request, Severity.WARNING, f"GCS {request.system}: {name} refused: {reason}", now)
        return Result.FAILED


def parse_position(request: CommandRequest) -> tuple[float, float] | Result:
    """Return latitude and longitude of parameters 5 and 6 in degrees x 1e7, or the result if they are invalid."""
    if request.is_int and request.frame not in GLOBAL_FRAMES:
        return Result.UNSUPPORTED_FRAME
    scale = 1.0 if request.is_int else 1e7
    latitude, longitude = request.params[4] * scale, request.params[5] * scale
    return Result.DENIED if is_invalid_position(latitude, longitude) else (latitude, longitude)


def parse_altitude(request: CommandRequest, home: Home | None) -> float | None:
    """Return the altitude of parameter 7 in m above sea level; None if it is NaN."""
    altitude = request.params[6]
    if math.isnan(altitude):
        return None
    return altitude + (home.altitude if home and request.frame in RELATIVE_FRAMES else 0.0)


def is_invalid_position(latitude: float, longitude: float) -> bool:
    """Return True for 0/0, INT32_MAX, NaN and beyond the poles; in degrees x 1e7."""
    return not (abs(latitude) <= 90e7 and abs(longitude) <= 180e7) or (latitude, longitude) == (0, 0)
