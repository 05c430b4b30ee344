"""Commands that ask for messages and rates. They change nothing that moves; anybody with a HEARTBEAT may ask.

So may who has connected, or is at an address that the user named. An answer goes to the asker alone. Everybody else
gets a refusal, which is not longer than the question: a forged address must not turn the vehicle into an amplifier.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from dialects import messages as m
from dialects.enums import Command, Result
from link.core import Outgoing
from link.services.command.server import CommandHandler, CommandRequest, RunCommand, value_or_default
from vehicle.telemetry import build_status
from vehicle.telemetry.link_status import LinkStatusReporter
from vehicle.telemetry.scaling import parse_message_id
from vehicle.telemetry.streams import STREAM_BY_ID
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView

MICROSECONDS = 1e6
MAX_INTERVAL = 2147.0
"""s: longest interval that SET_MESSAGE_INTERVAL may ask for; MESSAGE_INTERVAL has an int32 of us for it."""


class MessageRequests:
    """Answers to the askers."""

    def __init__(
        self,
        telemetry: Telemetry,
        look: Callable[[float], TelemetryView],
        more: Mapping[int, Callable[[TelemetryView], m.Message]],
        links: LinkStatusReporter,
    ) -> None:
        """`more`: messages that are no stream, by id."""
        self._telemetry = telemetry
        self._build_view = look
        self._links = links
        self._builders = {**{number: stream.build for number, stream in STREAM_BY_ID.items()}, **more}
        self._outbox: list[Outgoing] = []

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        questions = {
            Command.REQUEST_MESSAGE: CommandHandler(self._request_message, broadcast=True),
            Command.SET_MESSAGE_INTERVAL: CommandHandler(self._set_interval),
            Command.GET_MESSAGE_INTERVAL: CommandHandler(self._get_interval),
            Command.REQUEST_PROTOCOL_VERSION: CommandHandler(self._legacy(m.ProtocolVersion)),
            Command.REQUEST_AUTOPILOT_CAPABILITIES: CommandHandler(self._legacy(m.AutopilotVersion)),
            Command.GET_HOME_POSITION: CommandHandler(self._get_home),
        }
        return {
            command: CommandHandler(_require_heartbeat(each.run), broadcast=each.broadcast)
            for command, each in questions.items()
        }

    def messages_to_send(self) -> list[Outgoing]:
        """The messages asked for; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def _request_message(self, request: CommandRequest, now: float) -> Result:
        number = parse_message_id(request.params[0])
        if number is None:
            return Result.DENIED
        if number == m.AvailableModes.id:
            return self._available_modes(request, now)
        if number == m.MessageInterval.id:
            return self._queue_interval(request, request.params[1])
        if number == m.RoverLinkStatus.id:
            return self._queue_reply(request, self._links.build_status(request.peer.link))
        if number not in self._builders:
            return Result.UNSUPPORTED
        return self._queue_reply(request, self._builders[number](self._build_view(now)))

    def _available_modes(self, request: CommandRequest, now: float) -> Result:
        """Parameter 2: 0 all, else the index from 1."""
        modes, index = build_status.available_modes(self._build_view(now)), value_or_default(request.params[1])
        if not (math.isfinite(index) and index == int(index) and 0 <= index <= len(modes)):
            return Result.DENIED
        for mode in [modes[int(index) - 1]] if index else modes:
            self._queue_reply(request, mode)
        return Result.ACCEPTED

    def _set_interval(self, request: CommandRequest, now: float) -> Result:
        """For the asker alone. Parameter 2 in us: -1 off, 0 default; too fast is made slower."""
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

    def _get_interval(self, request: CommandRequest, now: float) -> Result:
        return self._queue_interval(request, request.params[0])

    def _queue_interval(self, request: CommandRequest, asked: float) -> Result:
        """MESSAGE_INTERVAL of the asker: us, -1 off, 0 for what is no stream."""
        number, schedule = parse_message_id(asked), self._telemetry.schedule_of(request.peer)
        if number is None or number > m.UINT16_MAX:
            return Result.DENIED
        if schedule is None:
            return Result.TEMPORARILY_REJECTED
        interval = schedule.interval(number) if number in STREAM_BY_ID else 0.0
        self._queue_reply(
            request, m.MessageInterval(number, -1 if interval is None else round(interval * MICROSECONDS))
        )
        return Result.ACCEPTED

    def _get_home(self, request: CommandRequest, now: float) -> Result:
        return self._queue_reply(request, build_status.home_position(self._build_view(now)))

    def _legacy(self, message: type[m.Message]) -> Callable[[CommandRequest, float], Result]:
        """REQUEST_PROTOCOL_VERSION and REQUEST_AUTOPILOT_CAPABILITIES, older than REQUEST_MESSAGE; 1 asks."""

        def run(request: CommandRequest, now: float) -> Result:
            if request.params[0] != 1:
                return Result.DENIED
            return self._queue_reply(request, STREAM_BY_ID[message.id].build(self._build_view(now)))

        return run

    def _queue_reply(self, request: CommandRequest, message: m.Message | None) -> Result:
        if message is None:
            return Result.FAILED
        self._outbox.append(Outgoing(message, request.peer))
        return Result.ACCEPTED


def _require_heartbeat(run: RunCommand) -> RunCommand:
    """Refuse those who have shown no HEARTBEAT, at an address that nobody named; they may ask again when they have."""
    return lambda request, now: run(request, now) if request.may_ask else Result.TEMPORARILY_REJECTED
