"""Server half of the command protocol: COMMAND_LONG and COMMAND_INT, each answered with COMMAND_ACK.

Rules (https://mavlink.io/en/services/command.html): every command for this component is acknowledged, with UNSUPPORTED
if there is no handler; a command for another component never is. Repeats are run: a second run of a handler changes
nothing, or the handler detects the repeat itself, as vehicle/commands/actuator_test.py does. Long-running commands:
jobs.py.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import msgspec

from dialects.enums import Result
from dialects.messages import CommandCancel, CommandInt, CommandLong
from link.core import Outgoing, Received
from link.services.command.jobs import CommandJob, CommandJobs, ack
from link.services.command.request import CommandRequest, parse_command


class CommandReply(NamedTuple):
    """A result, with messages to send after its acknowledgement."""

    result: Result
    messages: tuple[Outgoing, ...] = ()
    why: int = 0
    """result_param2 of the acknowledgement: a dialect's reason for the result."""


RunCommand = Callable[[CommandRequest, float], Result | CommandReply | CommandJob]
"""Runs a command; returns its result, a reply with messages, or a CommandJob if it takes a while."""


class CommandHandler(msgspec.Struct, frozen=True):
    """What a server does with one command."""

    run: RunCommand
    broadcast: bool = False
    """Run and acknowledged when sent to system 0. Only for what can do no harm: stops and queries."""


class CommandServer:
    """Answers the commands to one system and component from a table of handlers."""

    def __init__(self, handlers: Mapping[int, CommandHandler], *, system: int, component: int) -> None:
        self._handlers = handlers
        self._system = system
        self._component = component
        self._jobs = CommandJobs()

    @property
    def commands(self) -> frozenset[int]:
        """The commands that have a handler."""
        return frozenset(self._handlers)

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Run or cancel a command. Return the acknowledgement and what follows it; nothing if it is not for us."""
        message = received.message
        if not isinstance(message, CommandLong | CommandInt | CommandCancel) or not self._for_us(message):
            return []
        if isinstance(message, CommandCancel):
            return self._jobs.cancel(message.command, received, now)
        return self._run(parse_command(message, received), now)

    def tick(self, now: float) -> list[Outgoing]:
        """Run the long-running commands; return their progress and results."""
        return self._jobs.tick(now)

    def _for_us(self, message: CommandLong | CommandInt | CommandCancel) -> bool:
        if message.target_component not in (0, self._component):
            return False
        if message.target_system == 0 and not isinstance(message, CommandCancel):
            handler = self._handlers.get(message.command)
            return handler is not None and handler.broadcast
        return bool(message.target_system == self._system)

    def _run(self, request: CommandRequest, now: float) -> list[Outgoing]:
        handler = self._handlers.get(request.command)
        if handler is None:
            return [ack(request, Result.UNSUPPORTED)]
        under_way = self._jobs.reply_to_repeat(request, now)
        if under_way is not None:
            return [under_way]
        result = handler.run(request, now)
        if isinstance(result, Result):
            return [ack(request, result)]
        if isinstance(result, CommandReply):
            return [ack(request, result.result, why=result.why), *result.messages]
        return [self._jobs.begin(request, result, now)]
