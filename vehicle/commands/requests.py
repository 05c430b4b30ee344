"""REQUEST_MESSAGE, SET_MESSAGE_INTERVAL and the other commands that ask for messages and rates.

They move nothing; anyone connected may send them, in control or not. The messages go to the sender alone. A sender that
is not connected gets a rejection, which is no longer than the request: a forged address must not amplify traffic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from dialects import messages as m
from dialects.enums import Command, Result
from link.core import Outgoing
from link.services.command.request import CommandRequest, value_or_default
from link.services.command.server import CommandReply
from vehicle.commands.access import Access, CommandResult
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Reporting
from vehicle.telemetry import build_status
from vehicle.telemetry.scaling import parse_message_id
from vehicle.telemetry.streams import STREAM_BY_ID
from vehicle.telemetry.view import TelemetryView

MICROSECONDS = 1e6
MAX_INTERVAL = 2147.0
"""s; longest interval of SET_MESSAGE_INTERVAL: MESSAGE_INTERVAL has an int32 of us for it."""


MessageBuilders = Mapping[int, Callable[[TelemetryView], m.Message]]


class MessageRequestHandler:
    """Answers requests for messages and rates."""

    def __init__(
        self,
        reporting: Reporting,
        builders: MessageBuilders,
        note: Callable[[int, CommandRequest, float], None] = lambda message_id, request, now: None,
    ) -> None:
        """`builders` build the messages that are not a stream, by message id. `note` is told what was requested."""
        self._note = note
        self._telemetry = reporting.telemetry
        self._build_view = reporting.build_view
        self._links = reporting.links
        self._builders = {**{number: stream.build for number, stream in STREAM_BY_ID.items()}, **builders}

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        connected = Access.CONNECTED
        return (
            CommandSpec(Command.REQUEST_MESSAGE, self._request_message, connected,
                        "1: message id; 2: index", broadcast=True),
            CommandSpec(Command.SET_MESSAGE_INTERVAL, self._set_interval, connected,
                        "1: message id; 2: us, -1 off, 0 default"),
            CommandSpec(Command.GET_MESSAGE_INTERVAL, self._get_interval, connected, "1: message id"),
            CommandSpec(Command.REQUEST_PROTOCOL_VERSION, self._legacy_request(m.ProtocolVersion), connected, "1: 1"),
            CommandSpec(Command.REQUEST_AUTOPILOT_CAPABILITIES, self._legacy_request(m.AutopilotVersion), connected,
                        "1: 1"),
            CommandSpec(Command.GET_HOME_POSITION, self._get_home, connected, "answered by HOME_POSITION"),
        )  # fmt: skip

    def _request_message(self, request: CommandRequest, now: float) -> CommandResult:
        number = parse_message_id(request.params[0])
        if number is None:
            return Result.DENIED
        if number == m.AvailableModes.id:
            return self._available_modes(request, now)
        if number == m.MessageInterval.id:
            return self._reply_interval(request, request.params[1])
        if number == m.RoverLinkStatus.id:
            return _reply(request, self._links.build_status(request.peer.link))
        if number not in self._builders:
            return Result.UNSUPPORTED
        self._note(number, request, now)
        return _reply(request, self._builders[number](self._build_view(now)))

    def _available_modes(self, request: CommandRequest, now: float) -> CommandResult:
        """Parameter 2: 0 requests all modes, else the index from 1."""
        modes, index = build_status.available_modes(self._build_view(now)), value_or_default(request.params[1])
        if not (math.isfinite(index) and index == int(index) and 0 <= index <= len(modes)):
            return Result.DENIED
        return _reply(request, *([modes[int(index) - 1]] if index else modes))

    def _set_interval(self, request: CommandRequest, now: float) -> CommandResult:
        """Change a rate for the sender alone. Parameter 2 in us: -1 off, 0 default; the fastest is 20 ms."""
        number, interval = parse_message_id(request.params[0]), request.params[1]
        if number not in STREAM_BY_ID or not math.isfinite(interval) or (interval < 0 and interval != -1):
            return Result.DENIED
        schedule = self._telemetry.schedule_of(request.peer)
        if schedule is None:
            return Result.TEMPORARILY_REJECTED
        if interval == 0:
            schedule.set_default(number, now)
        else:
            schedule.set_interval(number, None if interval == -1 else min(MAX_INTERVAL, interval / MICROSECONDS), now)
        return Result.ACCEPTED

    def _get_interval(self, request: CommandRequest, now: float) -> CommandResult:
        return self._reply_interval(request, request.params[0])

    def _reply_interval(self, request: CommandRequest, asked: float) -> CommandResult:
        """Reply with the MESSAGE_INTERVAL of the sender: us, -1 off, 0 for a message that is not a stream."""
        number, schedule = parse_message_id(asked), self._telemetry.schedule_of(request.peer)
        if number is None or number > m.UINT16_MAX:
            return Result.DENIED
        if schedule is None:
            return Result.TEMPORARILY_REJECTED
        interval = schedule.interval(number) if number in STREAM_BY_ID else 0.0
        return _reply(request, m.MessageInterval(number, -1 if interval is None else round(interval * MICROSECONDS)))

    def _get_home(self, request: CommandRequest, now: float) -> CommandResult:
        return _reply(request, build_status.home_position(self._build_view(now)))

    def _legacy_request(self, message: type[m.Message]) -> Callable[[CommandRequest, float], CommandResult]:
        """Return the handler of a command that is older than REQUEST_MESSAGE. Parameter 1 must be 1."""

        def run(request: CommandRequest, now: float) -> CommandResult:
            if request.params[0] != 1:
                return Result.DENIED
            return _reply(request, STREAM_BY_ID[message.id].build(self._build_view(now)))

        return run


def _reply(request: CommandRequest, *messages: m.Message | None) -> CommandResult:
    """Return ACCEPTED with messages for the sender; FAILED if there is nothing to send."""
    found = tuple(Outgoing(message, request.peer) for message in messages if message is not None)
    return CommandReply(Result.ACCEPTED, found) if found else Result.FAILED
