"""Commands that take a while: IN_PROGRESS, news of the progress, and one final COMMAND_ACK; COMMAND_CANCEL ends them.

Rules (mavlink.io/en/services/command.html, "long running commands"): one of a kind at a time, another one meanwhile is
TEMPORARILY_REJECTED; a cancelled one ends with CANCELLED, and a cancel that finds nothing to do is ignored.

To make a command one of these, let its handler's `run` (link/services/command/server.py) return a Job instead of a Result
once the work has begun, and a Result where it is refused. The server does the rest:

    class Survey:                                           # fits Job
        percent = None                                      # or 0..100
        def step(self, now): return Result.ACCEPTED if now >= self._end else None
        def cancel(self, now): self._readings.clear()

    Handler(lambda request, now: Survey(...) if allowed else Result.DENIED)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from dialects.enums import Result
from dialects.messages import CommandAck
from link.core import Outgoing, Received
from link.services.command.request import CommandRequest

PROGRESS_PERIOD = 0.5
"""s between two words of the progress: the client waits longer than its usual patience after each."""
REPEAT_WINDOW = 3.0
"""s after the beginning, and after the end, in which the command or its cancel said again is answered as the first was:
answers get lost. Later it is a new wish, unless it says itself that it is a repeat."""
PROGRESS_UNKNOWN = 255
"""`progress` of COMMAND_ACK where nobody knows."""


class CommandJob(Protocol):
    """A command at work."""

    @property
    def percent(self) -> int | None:
        """How far it is, 0..100; None where nobody knows."""

    def step(self, now: float) -> Result | None:
        """Each cycle: None while it goes on, at its end the final result, and no call after that."""

    def cancel(self, now: float) -> None:
        """Stop, now; no call of `step` after that. Anybody may ask for it, as for every stop."""


@dataclass(slots=True)
class _Running:
    request: CommandRequest
    job: CommandJob
    began: float
    told: float


@dataclass(frozen=True, slots=True)
class _EndedCommand:
    request: CommandRequest
    result: Result
    at: float


class CommandJobs:
    """The long running commands of a server, at most one of a kind."""

    def __init__(self) -> None:
        self._running: dict[int, _Running] = {}
        self._ended: dict[int, _EndedCommand] = {}

    def begin(self, request: CommandRequest, job: CommandJob, now: float) -> Outgoing:
        """It is under way."""
        self._running[request.command] = _Running(request, job, now, now)
        return _progress_ack(request, job)

    def reply_to_repeat(self, request: CommandRequest, now: float) -> Outgoing | None:
        """To a command that is under way, or a repeat of one that has just ended; None where it is to be run."""
        running = self._running.get(request.command)
        if running is not None:
            again = running.request == request and (request.repeated or now - running.began < REPEAT_WINDOW)
            return _progress_ack(request, running.job) if again else ack(request, Result.TEMPORARILY_REJECTED)
        ended = self._ended.get(request.command)
        if ended is None or now - ended.at >= REPEAT_WINDOW or ended.request != request or not request.repeated:
            return None
        return ack(request, ended.result)

    def cancel(self, command: int, received: Received, now: float) -> list[Outgoing]:
        """Stop it; its client and who cancelled it hear of it. Nothing where nothing of the kind is under way."""
        running = self._running.pop(command, None)
        if running is None:
            ended = self._ended.get(command)
            return [_ack_to(command, ended.result, received)] if ended and now - ended.at < REPEAT_WINDOW else []
        running.job.cancel(now)
        words = [self._end(running.request, Result.CANCELLED, now)]
        if (received.system, received.component) != (running.request.system, running.request.component):
            words.append(_ack_to(command, Result.CANCELLED, received))
        return words

    def tick(self, now: float) -> list[Outgoing]:
        """What is worth telling."""
        words = []
        for command, running in list(self._running.items()):
            result = running.job.step(now)
            if result is not None:
                del self._running[command]
                words.append(self._end(running.request, result, now))
            elif now - running.told >= PROGRESS_PERIOD:
                running.told = now
                words.append(_progress_ack(running.request, running.job))
        return words

    def _end(self, request: CommandRequest, result: Result, now: float) -> Outgoing:
        self._ended[request.command] = _EndedCommand(request, result, now)
        return ack(request, result)


def ack(request: CommandRequest, result: Result, progress: int = 0) -> Outgoing:
    """COMMAND_ACK to the sender of a request."""
    answer = CommandAck(request.command, result, progress, 0, request.system, request.component)
    return Outgoing(answer, request.peer)


def _ack_to(command: int, result: Result, received: Received) -> Outgoing:
    return Outgoing(CommandAck(command, result, 0, 0, received.system, received.component), received.peer)


def _progress_ack(request: CommandRequest, job: CommandJob) -> Outgoing:
    return ack(request, Result.IN_PROGRESS, PROGRESS_UNKNOWN if job.percent is None else job.percent)
