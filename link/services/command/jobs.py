"""Long-running commands: IN_PROGRESS with progress, one final COMMAND_ACK, COMMAND_CANCEL.

Rules (https://mavlink.io/en/services/command.html#long_running_commands): one of a kind at a time, a second one
meanwhile is TEMPORARILY_REJECTED; a cancelled one ends with CANCELLED, and a cancel without a running command is
ignored.

To make a command long-running, let its handler's `run` (link/services/command/server.py) return a CommandJob instead of
a Result once the work has begun. The server does the rest:

    class Survey:                                           # fits CommandJob
        percent = None                                      # or 0..100
        def step(self, now): return Result.ACCEPTED if now >= self._end else None
        def cancel(self, now): self._readings.clear()

    CommandHandler(lambda request, now: Survey(...) if allowed else Result.DENIED)
"""

from __future__ import annotations

from typing import Protocol

import msgspec

from dialects.enums import Result
from dialects.messages import CommandAck
from link.core import Outgoing, Received
from link.services.command.request import CommandRequest

PROGRESS_PERIOD = 0.5
"""s between two progress reports: after each the client waits longer than usual."""
REPEAT_WINDOW = 3.0
"""s after start and after the end in which a repeated command or cancel gets the same reply again, because replies get
lost. Later it is a new command, unless it is marked as a repeat."""
PROGRESS_UNKNOWN = 255
"""`progress` of COMMAND_ACK when it is not known."""


class CommandJob(Protocol):
    """A long-running command."""

    @property
    def percent(self) -> int | None:
        """Progress, 0..100; None where not known."""

    def step(self, now: float) -> Result | None:
        """Run one cycle; return None while the command goes on, and its result once at the end."""

    def cancel(self, now: float) -> None:
        """Stop at once; step() is not called after that.

        Any ground station may cancel, as any may stop the vehicle.
        """


class _Running(msgspec.Struct):
    request: CommandRequest
    job: CommandJob
    started_at: float
    reported_at: float


class _EndedCommand(msgspec.Struct, frozen=True):
    request: CommandRequest
    result: Result
    at: float


class CommandJobs:
    """The long-running commands of a server, at most one of a kind."""

    def __init__(self) -> None:
        self._running: dict[int, _Running] = {}
        self._ended: dict[int, _EndedCommand] = {}

    def begin(self, request: CommandRequest, job: CommandJob, now: float) -> Outgoing:
        """Add a command that has begun; return its first IN_PROGRESS."""
        self._running[request.command] = _Running(request, job, now, now)
        return _progress_ack(request, job)

    def reply_to_repeat(self, request: CommandRequest, now: float) -> Outgoing | None:
        """Return the reply to a command under way, or to a repeat of one just ended; None: run it."""
        running = self._running.get(request.command)
        if running is not None:
            again = running.request == request and (request.repeated or now - running.started_at < REPEAT_WINDOW)
            return _progress_ack(request, running.job) if again else ack(request, Result.TEMPORARILY_REJECTED)
        ended = self._ended.get(request.command)
        if ended is None or now - ended.at >= REPEAT_WINDOW or ended.request != request or not request.repeated:
            return None
        return ack(request, ended.result)

    def cancel(self, command: int, received: Received, now: float) -> list[Outgoing]:
        """Cancel a command; its client and the sender of the cancel get CANCELLED."""
        running = self._running.pop(command, None)
        if running is None:
            ended = self._ended.get(command)
            return [_ack_to(command, ended.result, received)] if ended and now - ended.at < REPEAT_WINDOW else []
        running.job.cancel(now)
        replies = [self._end(running.request, Result.CANCELLED, now)]
        if (received.system, received.component) != (running.request.system, running.request.component):
            replies.append(_ack_to(command, Result.CANCELLED, received))
        return replies

    def tick(self, now: float) -> list[Outgoing]:
        """Run all jobs; return their progress and results."""
        replies = []
        for command, running in list(self._running.items()):
            result = running.job.step(now)
            if result is not None:
                del self._running[command]
                replies.append(self._end(running.request, result, now))
            elif now - running.reported_at >= PROGRESS_PERIOD:
                running.reported_at = now
                replies.append(_progress_ack(running.request, running.job))
        return replies

    def _end(self, request: CommandRequest, result: Result, now: float) -> Outgoing:
        self._ended[request.command] = _EndedCommand(request, result, now)
        return ack(request, result)


def ack(request: CommandRequest, result: Result, progress: int = 0, *, why: int = 0) -> Outgoing:
    """Return COMMAND_ACK to the sender of a request. `why`: its result_param2."""
    answer = CommandAck(request.command, result, progress, why, request.system, request.component)
    return Outgoing(answer, request.peer)


def _ack_to(command: int, result: Result, received: Received) -> Outgoing:
    return Outgoing(CommandAck(command, result, 0, 0, received.system, received.component), received.peer)


def _progress_ack(request: CommandRequest, job: CommandJob) -> Outgoing:
    return ack(request, Result.IN_PROGRESS, PROGRESS_UNKNOWN if job.percent is None else job.percent)
