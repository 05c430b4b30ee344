"""The command protocol, both halves: COMMAND_LONG and COMMAND_INT, answered by COMMAND_ACK, never by silence.

Rules (mavlink.io/en/services/command.html): the client repeats with a rising `confirmation` until acknowledged; the
server acknowledges every command meant for it, UNSUPPORTED when it does not know it. A command for somebody else is
never acknowledged. What takes time: jobs.py. Repeats are run: a handler does no more at the second time, or
knows a repeat itself, as vehicle/commands/actuator_test.py.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from dialects.enums import Result
from dialects.messages import CommandCancel, CommandInt, CommandLong
from link.core import Outgoing, Received
from link.services.command.jobs import CommandJob, CommandJobs, ack
from link.services.command.request import PROGRESS_TIMEOUT, CommandRequest, parse_command, value_or_default

__all__ = [
    "PROGRESS_TIMEOUT",
    "CommandHandler",
    "CommandRequest",
    "CommandServer",
    "RunCommand",
    "value_or_default",
]

RunCommand = Callable[[CommandRequest, float], Result | CommandJob]
"""Runs a command at a time: its result, or where it takes a while a job of jobs.py."""


@dataclass(frozen=True, slots=True)
class CommandHandler:
    """What a server does with one command."""

    run: RunCommand
    broadcast: bool = False
    """Obeyed and acknowledged when sent to system 0. Only for what can do no harm: stops and questions."""


class CommandServer:
    """Answers commands for one system and component from a table."""

    def __init__(self, handlers: Mapping[int, CommandHandler], *, system: int, component: int) -> None:
        self._handlers = handlers
        self._system = system
        self._component = component
        self._jobs = CommandJobs()

    @property
    def commands(self) -> frozenset[int]:
        """What has a handler."""
        return frozenset(self._handlers)

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Run or cancel a command; returns the acknowledgement, or nothing where it was not for us."""
        message = received.message
        if not isinstance(message, CommandLong | CommandInt | CommandCancel) or not self._for_us(message):
            return []
        if isinstance(message, CommandCancel):
            return self._jobs.cancel(message.command, received, now)
        return [self._run(parse_command(message, received), now)]

    def tick(self, now: float) -> list[Outgoing]:
        """News of the commands under way."""
        return self._jobs.tick(now)

    def _for_us(self, message: CommandLong | CommandInt | CommandCancel) -> bool:
        if message.target_component not in (0, self._component):
            return False
        if message.target_system == 0 and not isinstance(message, CommandCancel):
            handler = self._handlers.get(message.command)
            return handler is not None and handler.broadcast
        return bool(message.target_system == self._system)

    def _run(self, request: CommandRequest, now: float) -> Outgoing:
        handler = self._handlers.get(request.command)
        if handler is None:
            return ack(request, Result.UNSUPPORTED)
        under_way = self._jobs.reply_to_repeat(request, now)
        if under_way is not None:
            return under_way
        result = handler.run(request, now)
        return ack(request, result) if isinstance(result, Result) else self._jobs.begin(request, result, now)
