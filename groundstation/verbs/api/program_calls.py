"""ProgramCalls: runs the calls of a program with one session, and tells it the state of the vehicle.

One call that changes something runs at a time; those that only watch run beside it. A stop ends a call that drives and
does not wait. A call that drives ends with neutral when the program does not say within SILENCE that it waits for it:
it is stopped, hangs, or has ended.
"""

from __future__ import annotations

import argparse
import asyncio
import logging
from functools import cache
from typing import Any

import msgspec

from dialects import messages as m
from groundstation.formats.errors import FileFormatError
from groundstation.rover.protocol import SILENCE, STATE_PERIOD, CurrentState, Ended, Ready, TextEvent
from groundstation.verbs.action import VerbAction
from groundstation.verbs.api.call_output import CallOutput
from groundstation.verbs.api.state import build_state
from groundstation.verbs.common.channel import ChannelEndedError
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.loading import load
from groundstation.verbs.control import arm, drive, turn  # noqa: F401  # a call that drives waits for no import
from groundstation.verbs.control.driving import leave
from groundstation.verbs.line.parser import LineParser
from groundstation.verbs.main import build_parser, check_options, choose_action
from groundstation.verbs.performing import perform
from groundstation.verbs.session.session import VerbSession
from link.core import Received
from link.runtime.command_line import CommandLineParser

log = logging.getLogger(__name__)

DRIVING = frozenset({"drive", "takeoff", "turn"})
"""Verbs that move the vehicle while they run."""
LOOK_PERIOD = 0.05
"""s between looks whether the program still waits."""


class ProgramCalls:
    """The calls of one program, which `session.companion` leads to."""

    def __init__(self, session: VerbSession, options: argparse.Namespace) -> None:
        self._session, self._stay_armed = session, bool(options.stay_armed)
        self._began = session.began
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._driving: dict[int, asyncio.Task[None]] = {}
        self._changing = asyncio.Lock()
        self._waited_at: dict[int, float] = {}
        """Call that drives -> when the program has said last that it waits for it."""
        self._stand_still: set[int] = set()
        """Calls for which it has not."""
        self._armed_here = False
        self._ends = False

    async def run(self) -> None:
        """Handle calls until the program ends; then neutral, and disarm what it has armed. Raises VerbError."""
        session = self._session
        session.goes_on = True
        session.core.taps.append(self._tap)
        self._send(Ready(session.vehicle.system, session.vehicle.name))
        beside = [asyncio.ensure_future(each) for each in (self._publish(), self._watch())]
        try:
            while True:
                self._handle(await session.companion.receive())
        except ChannelEndedError:
            pass
        finally:
            self._ends = True
            for task in (*beside, *self._tasks.values()):
                task.cancel()
            await asyncio.wait({*beside, *self._tasks.values()})
            session.goes_on = False
            await leave(session, disarm=self._armed_here and not self._stay_armed)

    def _send(self, value: object) -> None:
        self._session.companion.send(msgspec.to_builtins(value))

    def _handle(self, value: Any) -> None:
        """Handle what the companion has read, as plain values."""
        match value:
            case {"type": "waiting", **rest}:
                number = rest.get("id")
                for each in self._waited_at if number is None else self._waited_at.keys() & {number}:
                    self._waited_at[each] = self._session.now
            case {"type": "cancel", "id": int(number)}:
                if number in self._tasks:
                    self._tasks[number].cancel()
            case {"type": "call", "id": int(number), "words": [*words], "given": given}:
                task = asyncio.ensure_future(self._call(number, words, given))
                self._tasks[number] = task
                task.add_done_callback(lambda _: self._tasks.pop(number, None))

    # ---- what the program sees ----

    async def _publish(self) -> None:
        while True:
            self._send_state()
            await asyncio.sleep(STATE_PERIOD)

    def _send_state(self) -> None:
        self._send(CurrentState(build_state(self._session.contact, self._session.now)))

    def _tap(self, received: Received, now: float) -> None:
        message = received.message
        if isinstance(message, m.StatusText) and received.system == self._session.vehicle.system:
            self._send(TextEvent(message.severity, message.text))

    # ---- calls ----

    async def _watch(self) -> None:
        """End what drives when the program does not wait for it any more."""
        while True:
            await asyncio.sleep(LOOK_PERIOD)
            for number, task in self._driving.items():
                if self._session.now - self._waited_at[number] > SILENCE:
                    self._stand_still.add(number)
                    task.cancel()

    async def _call(self, number: int, words: list[str], given: Any) -> None:
        """Run one call to its end, and tell the program."""
        output = CallOutput(number, words[0], self._send)
        text = ""
        try:
            code = await self._run(number, words, given, output)
        except asyncio.CancelledError:
            if self._ends:  # the program gets the reason of that
                return
            code = int(ExitCode.BROKEN)
            text = f"the program stood still for {SILENCE:g} s: neutral" if number in self._stand_still else "cancelled"
            self._stand_still.discard(number)
        except (VerbError, FileFormatError) as error:
            code, text = int(error.code if isinstance(error, VerbError) else ExitCode.USAGE), str(error)
        except Exception as error:  # of the verb: it must not end the connection
            log.exception("a call failed")
            code, text = int(ExitCode.BROKEN), f"{type(error).__name__}: {error}"
        self._send_state()  # the program sees what its call has done: the mode of a stop, for example
        self._send(Ended(number, code, text or (output.error_text if code else ""), output.fields))

    async def _run(self, number: int, words: list[str], given: Any, output: CallOutput) -> int:
        action, options = await asyncio.to_thread(_parse, words, self._session.vehicle.system)
        options.given = given
        check_options(action, options)
        await load(action.run)
        if action.watches:
            return await self._perform(action, options, output)
        if action.stops:
            await self._end_driving()
            self._session.began = self._began
            return await self._perform(action, options, output)
        async with self._changing:
            self._session.began = self._session.now  # --wait counts from here
            if words[0] not in DRIVING:
                return await self._perform(action, options, output)
            return await self._drive(number, action, options, output)

    async def _drive(self, number: int, action: VerbAction, options: argparse.Namespace, output: CallOutput) -> int:
        task = asyncio.current_task()
        assert task is not None
        self._waited_at[number] = self._session.now
        self._session.core.standstill.forget()  # of the time before: neutral is shown again first
        self._driving[number] = task
        try:
            return await self._perform(action, options, output)
        finally:
            del self._driving[number], self._waited_at[number]

    async def _end_driving(self) -> None:
        driving = list(self._driving.values())
        for task in driving:
            task.cancel()
        if driving:
            await asyncio.wait(driving)

    async def _perform(self, action: VerbAction, options: argparse.Namespace, output: CallOutput) -> int:
        was_armed = self._session.vehicle.armed
        code = await perform(self._session, action, options, output, None, None, lambda _: None)  # type: ignore[arg-type]
        if self._session.vehicle.armed and not was_armed and output.verb == "arm":
            self._armed_here = True
        self._armed_here &= self._session.vehicle.armed
        return code


@cache
def parser_of(verb: str) -> CommandLineParser:
    """Return the parser of a verb: each call is parsed where the files of the user are, and where it runs."""
    return build_parser(verb, LineParser)


def _parse(words: list[str], vehicle: int) -> tuple[VerbAction, argparse.Namespace]:
    """Parse the words of a call. Raises VerbError."""
    options = parser_of(words[0]).parse_args(words[1:])
    action = choose_action(words[0], options)
    if action.offline or action.examines or action.companion is not None:
        raise VerbError(ExitCode.USAGE, f"{words[0]} is not for programs: run `mavhelm {words[0]}`")
    if options.endpoints or options.vehicle or options.all or options.group:
        raise VerbError(
            ExitCode.USAGE, f"{words[0]}: the connection has one vehicle, {vehicle}; no -e, -v, --all, --group"
        )
    options.vehicle, options.words = vehicle, tuple(words)
    return action, options
