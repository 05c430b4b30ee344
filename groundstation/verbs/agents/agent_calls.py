"""AgentCalls: runs the tools of one agent in the station. What changes something waits for the key of a person.

Each call is a verb of its own. A reading tool and a stop run at once; the station lets such a verb send questions and
stops only. The verb of a proposal begins when the key is held, and is cancelled when the permission ends.
"""

from __future__ import annotations

import argparse
import asyncio
import logging
import time
from collections.abc import Callable
from typing import Any

from msgspec.structs import replace

from dialects.printable import printable
from groundstation.formats.errors import FileFormatError
from groundstation.station.agents.proposals import Proposal, ProposalStage, Ticket
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.agents.arguments import InvalidArgumentError, check_arguments
from groundstation.verbs.agents.bounded_output import BoundedOutput, clean
from groundstation.verbs.agents.tools import TOOLS, Tool, ToolEffect
from groundstation.verbs.common.channel import ChannelEndedError
from groundstation.verbs.common.endings import wait_for_ends
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.lazy import LazyAttribute, LazyCall
from groundstation.verbs.line.parser import LineParser
from groundstation.verbs.main import build_parser, check_options, choose_action
from groundstation.verbs.performing import build_session, perform
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.session.station_seat import StationSeat
from groundstation.verbs.table import VERBS

log = logging.getLogger(__name__)

MOST_CALLS = 16
"""Calls of one agent at once."""
TEXTS = 60
"""Lines of the log that one call returns."""
LONGEST_READING = 20.0
"""s for a reading tool."""
LOOK_PERIOD = 0.1
"""s between looks whether a vehicle that drives itself stands."""
STANDS, STANDS_FOR = 0.05, 2.0
"""m/s, and s below it, after which a vehicle that drives itself has arrived."""


class AgentCalls:
    """The calls of one agent, to which `session.companion` leads."""

    def __init__(self, session: VerbSession) -> None:
        self._session, self._station = session, session.station
        self._book = session.station.proposals
        self._who = session.program
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._tickets: dict[int, Ticket] = {}

    async def run(self) -> None:
        """Handle calls until the agent ends; what runs ends with it. Raises VerbError."""
        try:
            while True:
                self._handle(await self._session.companion.receive())
        except ChannelEndedError:
            pass
        finally:
            for number, ticket in list(self._tickets.items()):
                self._book.finish(ticket, "the agent has ended", self._session.now)
                self._tickets.pop(number, None)
            for task in list(self._tasks.values()):
                task.cancel()
            await wait_for_ends(set(self._tasks.values()))

    def _handle(self, value: Any) -> None:
        """Handle what the companion has read, as plain values."""
        match value:
            case {"type": "alive"}:
                for ticket in self._tickets.values():
                    self._book.hear(ticket, self._session.now)
            case {"type": "named", "name": str(name)}:
                self._who = f"{self._session.program} '{printable(name)[:40]}'"
            case {"type": "cancel", "id": int(number)} if number in self._tasks:
                if number in self._tickets:
                    self._book.finish(self._tickets[number], "the agent has cancelled it", self._session.now)
                self._tasks[number].cancel()
            case {"type": "call", "id": int(number), "tool": str(name), "arguments": given} if (
                number not in self._tasks
            ):
                if len(self._tasks) >= MOST_CALLS:
                    self._answer(number, f"{MOST_CALLS} calls run already: wait for their end")
                    return
                task = asyncio.ensure_future(self._call(number, name, given))
                self._tasks[number] = task
                task.add_done_callback(lambda _: self._tasks.pop(number, None))

    def _answer(self, number: int, error: str, fields: dict[str, Any] | None = None) -> None:
        self._session.companion.send({"type": "ended", "id": number, "error": error, "fields": fields or {}})

    async def _call(self, number: int, name: str, given: object) -> None:
        """Run one call to its end, and answer it."""
        output = BoundedOutput(name)
        error = ""
        try:
            tool = TOOLS.get(name)
            if tool is None:
                raise InvalidArgumentError("no such tool")
            values = check_arguments(tool.all_arguments, given)
            error = await self._run(number, name, tool, values, output)
        except asyncio.CancelledError:
            error = "cancelled"
        except (InvalidArgumentError, VerbError, FileFormatError) as failure:
            error = str(failure)
            self._book.note_call(self._who, f"{printable(name)[:30]}: {error[:50]}", "", self._session.now)
        except Exception as failure:  # of the verb: it must not end the connection
            log.exception("a call of an agent failed")
            error = f"{type(failure).__name__}: {failure}"
        self._answer(number, printable(error), output.build())

    async def _run(self, number: int, name: str, tool: Tool, values: dict[str, Any], output: BoundedOutput) -> str:
        """Run a tool; return why it has failed, or ""."""
        now = self._session.now
        if tool.effect is ToolEffect.PROPOSE:
            return await self._propose(number, tool, values, output)
        words = tool.words(values)
        self._book.note_call(self._who, " ".join(words) or name, values["reason"], now)
        if not words:
            self._read_station(name, output)
            return ""
        if tool.effect is ToolEffect.STOP:
            self._end_what_runs(name)
        async with asyncio.timeout(LONGEST_READING):
            action, options = await asyncio.to_thread(_parse, _for_vehicle(words, values["vehicle"] or self._selected))
            return await self._run_action(action, options, output, lambda now: False)

    def _read_station(self, name: str, output: BoundedOutput) -> None:
        now = self._session.now
        if name == "texts":
            for line in self._station.log.build_lines(now, time.time())[-TEXTS:]:
                output.record(**clean(line))
            return
        shown = self._book.view(now)
        if shown is not None:
            output.record(**clean(shown))

    def _end_what_runs(self, name: str) -> None:
        shown = self._book.shown
        if shown is not None and shown.stage is ProposalStage.RUNNING:
            self._book.finish(shown, f"an agent has called {name}", self._session.now)

    @property
    def _selected(self) -> int | None:
        selected = self._station.fleet.selected
        return None if selected is None else selected.state.system

    # ---- proposals ----

    async def _propose(self, number: int, tool: Tool, values: dict[str, Any], output: BoundedOutput) -> str:
        words, system = tool.words(values), values["vehicle"] or self._selected
        if system is None:
            return "no vehicle is heard"
        action, options = await asyncio.to_thread(_parse, _for_vehicle(words, system))
        proposal = Proposal(
            self._who, tool.text(values), values["reason"], system,
            values["seconds"] + tool.lead if tool.seconds is None else tool.seconds, values["wait_seconds"],
            values.get("max_meters"),
        )  # fmt: skip
        ticket = self._book.propose(proposal, self._session.now)
        if isinstance(ticket, str):
            return ticket
        changed = asyncio.Event()
        ticket.changed = changed.set
        self._tickets[number] = ticket
        try:
            await changed.wait()
            if ticket.stage is ProposalStage.RUNNING:
                await self._perform(ticket, tool, action, options, output, changed)
        finally:
            self._book.finish(ticket, "the agent has ended", self._session.now)
            self._tickets.pop(number, None)
        return "" if ticket.done else ticket.why

    async def _perform(
        self,
        ticket: Ticket,
        tool: Tool,
        action: VerbAction,
        options: argparse.Namespace,
        output: BoundedOutput,
        changed: asyncio.Event,
    ) -> None:
        """Do what was proposed until it is done, or the permission ends."""
        changed.clear()
        work = asyncio.ensure_future(self._work(ticket, tool, action, options, output))
        ended = asyncio.ensure_future(changed.wait())
        try:
            await asyncio.wait({work, ended}, return_when=asyncio.FIRST_COMPLETED)
            if work.done():
                error = _failure_of(work)
                self._book.finish(ticket, error or "done as proposed", self._session.now, done=not error)
        finally:
            for each in (work, ended):
                each.cancel()
            await wait_for_ends({work, ended})

    async def _work(
        self, ticket: Ticket, tool: Tool, action: VerbAction, options: argparse.Namespace, output: BoundedOutput
    ) -> str:
        error = await self._run_action(action, options, output, lambda now: self._book.may_run(ticket, now))
        contact = self._station.fleet.get(ticket.proposal.system)
        if not error and tool.travels and contact is not None:
            await self._travel(contact.state)
        return error

    async def _travel(self, state: VehicleState) -> None:
        """Wait until a vehicle that drives itself stands, or does not drive itself any more."""
        stood_since = self._session.now
        while state.drives_itself and self._session.now - stood_since < STANDS_FOR:
            await asyncio.sleep(LOOK_PERIOD)
            if abs(state.speed or 0.0) > STANDS:
                stood_since = self._session.now

    # ---- verbs ----

    async def _run_action(
        self, action: VerbAction, options: argparse.Namespace, output: BoundedOutput, is_permitted: _IsPermitted
    ) -> str:
        """Run a verb in a seat of its own; return why it has failed, or ""."""
        station = self._station
        ids, endpoints = station.parts.ids, station.station_info.endpoints
        options.system = ids[0]
        session = build_session(
            action, options, output, endpoints,  # type: ignore[arg-type]
            lambda: VerbCore(station, options.vehicle), (ids, station.parts.proofs),
        )  # fmt: skip
        seat = StationSeat(
            station,
            session.core,
            self._who,
            self._session.flush,
            needs_session=not action.watches and not action.stops,
            silence=self._session.silence,
            is_permitted=is_permitted,
            speak=session.speak,
        )
        session.flush = seat.flush
        code = await seat.run(perform(session, action, options, output, None, None, lambda _: None))  # type: ignore[arg-type]
        failed = code not in (ExitCode.DONE, ExitCode.DIFFERS)
        return (output.last_note or f"exit code {code}") if failed else ""


_IsPermitted = Callable[[float], bool]


def _failure_of(work: asyncio.Future[str]) -> str:
    if work.cancelled():
        return "cancelled"
    failure = work.exception()
    return work.result() if failure is None else str(failure) or type(failure).__name__


def _for_vehicle(words: tuple[str, ...], system: int | None) -> tuple[str, ...]:
    """Return the words of a verb with its vehicle; what stands behind "--" is no option."""
    if system is None or words[0] in ("links", "vehicles"):
        return words
    at = 1 if ONLY in VERBS[words[0]].actions else 2
    return (*words[:at], "-v", str(system), *words[at:])


def _parse(words: tuple[str, ...]) -> tuple[VerbAction, argparse.Namespace]:
    """Parse a command line of TOOLS, and load its verb. Raises VerbError."""
    options = build_parser(words[0], LineParser).parse_args(words[1:])
    action = choose_action(words[0], options)
    options.words, options.given = words, None
    if action.prepare is not None:
        options.given = action.prepare(options)
    check_options(action, options)
    if isinstance(action.run, LazyAttribute | LazyCall):
        action = replace(action, run=action.run.resolve())
    return action, options
