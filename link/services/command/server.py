"""The command protocol, both halves: COMMAND_LONG and COMMAND_INT, answered by COMMAND_ACK, never by silence.

Rules (mavlink.io/en/services/command.html): the client repeats with a rising `confirmation` until acknowledged; the
server acknowledges every command meant for it, UNSUPPORTED when it does not know it. A command for somebody else is
never acknowledged. What takes time: jobs.py. Repeats are run: a handler does no more at the second time, or
knows a repeat itself, as vehicle/commands/actuator_test.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from dialects.enums import Result
from dialects.messages import CommandAck, CommandCancel, CommandInt, CommandLong
from link.core import Outgoing, Peer, Received
from link.services.command.jobs import CommandJob, CommandJobs, ack

REPEAT_AFTER = 0.35
"""s without an answer before a command is sent again: longer than a loaded 57600 baud radio takes (0.18 s)."""
TRIES = 6
"""At 30 % loss each way all six fail once in 55 tries of the worst kind; a driver sees the failure after 2.1 s."""
PROGRESS_TIMEOUT = 3.0
"""s in which the same command from the same source is a repeat and not a new wish."""

Params = tuple[float, float, float, float, float, float, float]


def value_or_default(value: float, otherwise: float = 0.0) -> float:
    """A parameter that may be left out: COMMAND_LONG always has seven, and MAVSDK puts NaN where it says nothing."""
    return otherwise if math.isnan(value) else value


@dataclass(frozen=True, slots=True)
class CommandRequest:
    """A command as a handler sees it, whichever message brought it."""

    command: int
    params: Params
    """Parameters 1..7. From COMMAND_INT, 5 and 6 are `x` and `y` as numbers."""
    frame: int | None
    """MAV_FRAME of a COMMAND_INT; COMMAND_LONG has none."""
    x: int
    y: int
    is_int: bool
    system: int
    component: int
    peer: Peer
    introduced: bool
    may_ask: bool
    repeated: bool = field(default=False, compare=False)
    """It may be said again: `confirmation` says so, or it is a COMMAND_INT, which has none."""


class CommandReply(NamedTuple):
    """A result, with messages to send after its acknowledgement."""

    result: Result
    messages: tuple[Outgoing, ...] = ()


RunCommand = Callable[[CommandRequest, float], Result | CommandReply | CommandJob]
"""Run a command. Return its result, a reply with messages, or a job of jobs.py if the command takes time."""


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
        """Run or cancel a command. Return the acknowledgement and what follows it; nothing if it is not for us."""
        message = received.message
        if not isinstance(message, CommandLong | CommandInt | CommandCancel) or not self._for_us(message):
            return []
        if isinstance(message, CommandCancel):
            return self._jobs.cancel(message.command, received, now)
        return self._run(_request(message, received), now)

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
            return [ack(request, result.result), *result.messages]
        return [self._jobs.begin(request, result, now)]


def _comparable(param: float) -> float:
    """Every NaN as the same object, which tuples find equal: MAVSDK leaves NaN where it says nothing, and what is said
    again must be known again."""
    return math.nan if param != param else param


def _request(message: CommandLong | CommandInt, received: Received) -> CommandRequest:
    if isinstance(message, CommandInt):
        last: tuple[float, float, float] = (message.x, message.y, message.z)
        frame, x, y = message.frame, message.x, message.y
    else:
        last = (message.param5, message.param6, message.param7)
        frame, x, y = None, 0, 0
    one, two, three, four, five, six, seven = map(
        _comparable, (message.param1, message.param2, message.param3, message.param4, *last)
    )
    return CommandRequest(
        command=message.command,
        params=(one, two, three, four, five, six, seven),
        frame=frame,
        x=x,
        y=y,
        is_int=isinstance(message, CommandInt),
        system=received.system,
        component=received.component,
        peer=received.peer,
        introduced=received.introduced,
        may_ask=received.may_ask,
        repeated=isinstance(message, CommandInt) or message.confirmation > 0,
    )


@dataclass(frozen=True, slots=True)
class CommandOutcome:
    """How a command ended."""

    command: int
    params: Params
    target_system: int
    result: Result | None
    """None: nobody answered."""
    number: int | None = None
    """MAV_RESULT as it came, also where we do not know it."""


@dataclass(slots=True)
class _Waiting:
    command: int
    params: Params
    target: tuple[int, int]
    due: float
    sent: int = 0


class CommandClient:
    """Sends commands and repeats them until they are acknowledged.

    One command of a kind waits for a target at a time: MAVLink acknowledges the kind and not the instance, so that a
    newer one replaces the older.
    """

    def __init__(self, system: int, component: int) -> None:
        self._ids = (system, component)
        self._waiting: dict[tuple[int, int], _Waiting] = {}
        self._outbox: list[Outgoing] = []
        self._outcomes: list[CommandOutcome] = []

    def send(self, command: int, *params: float, target_system: int, target_component: int = 1, now: float) -> None:
        """Send a command with up to 7 parameters (missing ones are 0) and wait for its answer."""
        full: Params = (*params, *(0.0,) * (7 - len(params)))  # type: ignore[assignment]
        waiting = _Waiting(int(command), full, (target_system, target_component), now)
        self._waiting[target_system, int(command)] = waiting
        self._transmit(waiting, now)

    def cancel(self, command: int) -> None:
        """Stop repeating a command, whoever it was for."""
        self._waiting = {key: each for key, each in self._waiting.items() if each.command != command}

    def is_waiting(self, command: int, target_system: int) -> bool:
        """Has this system not answered a command of this kind yet?"""
        return (target_system, int(command)) in self._waiting

    def receive(self, received: Received, now: float) -> None:
        """Take a COMMAND_ACK; others are ignored."""
        message = received.message
        if not isinstance(message, CommandAck) or message.target_system not in (0, self._ids[0]):
            return
        waiting = self._waiting.get((received.system, message.command))
        if waiting is None:
            return
        if message.result == Result.IN_PROGRESS:
            waiting.sent, waiting.due = 1, now + PROGRESS_TIMEOUT
            return
        del self._waiting[received.system, message.command]
        known = Result(message.result) if message.result in Result._value2member_map_ else Result.FAILED
        self._outcomes.append(CommandOutcome(waiting.command, waiting.params, received.system, known, message.result))

    def tick(self, now: float) -> None:
        """Repeat what is overdue, give up what was repeated enough."""
        for key, waiting in list(self._waiting.items()):
            if now < waiting.due:
                continue
            if waiting.sent >= TRIES:
                del self._waiting[key]
                self._outcomes.append(CommandOutcome(waiting.command, waiting.params, key[0], None))
            else:
                self._transmit(waiting, now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[CommandOutcome]:
        """Commands that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _transmit(self, waiting: _Waiting, now: float) -> None:
        one, two, three, four, five, six, seven = waiting.params
        system, component = waiting.target
        message = CommandLong(system, component, waiting.command, waiting.sent, one, two, three, four, five, six, seven)
        self._outbox.append(Outgoing(message))
        waiting.sent += 1
        waiting.due = now + REPEAT_AFTER
