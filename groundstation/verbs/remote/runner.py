"""Runs one verb of a shell in the process of the station."""

from __future__ import annotations

import argparse
import asyncio
import logging
from collections.abc import Awaitable, Callable

from msgspec.structs import astuple, replace

from dialects.extra.errors import DialectError
from dialects.extra.option import used_dialect
from groundstation.config.groups import VehicleGroup
from groundstation.formats.errors import FileFormatError
from groundstation.station.operator_core import OperatorCore
from groundstation.station_socket.verb_run import FileAnswered, FileAsked, Printed, RunVerb, VerbEnded
from groundstation.verbs.action import VerbAction
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.lazy import LazyAttribute, LazyCall
from groundstation.verbs.line.parser import LineParser
from groundstation.verbs.main import build_parser, check_options, choose_action
from groundstation.verbs.performing import build_session, perform
from groundstation.verbs.remote.sent_output import SentOutput
from groundstation.verbs.remote.shell_files import ShellFiles
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.doctor_session import DoctorSession
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.session.station_seat import StationSeat

log = logging.getLogger(__name__)


class ShellVerb:
    """One verb of a shell. `name` is what others call it, `follows`: it may prove the session of the verb before.

    `flush` sends what the station has queued, `send` what the verb prints, `ask_for_file` what is done with a file of
    the user; `companion` leads to the verb's companion. `silence`: s without a word of the shell.
    """

    def __init__(
        self,
        station: OperatorCore,
        name: str,
        *,
        follows: bool,
        flush: Callable[[], None],
        send: Callable[[Printed], None],
        ask_for_file: Callable[[FileAsked], Awaitable[FileAnswered]],
        companion: CompanionChannel,
        silence: Callable[[float], float],
    ) -> None:
        self._station, self._name, self._follows = station, name, follows
        self._flush, self._send, self._silence = flush, send, silence
        self._files, self._companion = ShellFiles(ask_for_file), companion
        self._vehicle = ""

    async def run(self, asked: RunVerb) -> VerbEnded:
        """Run it to its end. A mistake in the verb is logged, and ends the verb alone."""
        output = SentOutput(asked.words[0], as_json=False, send=self._send)
        try:
            action, options = await asyncio.to_thread(_parse, asked)  # it imports the modules of the verb
            verb = f"{asked.words[0]} {options.action}".strip()
            output = SentOutput(verb, as_json=options.json, send=self._send)
            group = None if asked.group is None else VehicleGroup(*astuple(asked.group))
            code = await self._run_within(group, action, options, output)
        except (VerbError, FileFormatError, DialectError) as error:
            output.error(str(error))
            code = error.code if isinstance(error, VerbError) else ExitCode.USAGE
        except Exception as error:  # of the verb: it must not end the station
            log.exception("a verb failed")
            output.error(f"the verb failed in the station: {type(error).__name__}: {error}")
            code = ExitCode.BROKEN
        return VerbEnded(int(code), self._vehicle)

    async def _run_within(
        self, group: VehicleGroup | None, action: VerbAction, options: argparse.Namespace, output: SentOutput
    ) -> int:
        try:
            async with asyncio.timeout(None if action.own_timeout or group is not None else options.timeout):
                return await self._run(group, action, options, output)
        except TimeoutError:
            raise VerbError(ExitCode.NO_ANSWER, f"not done within {options.timeout:g} s") from None

    async def _run(
        self, group: VehicleGroup | None, action: VerbAction, options: argparse.Namespace, output: SentOutput
    ) -> int:
        session = self._build_session(action, options, output)
        seat = StationSeat(
            self._station,
            session.core,
            self._name,
            self._flush,
            needs_session=not action.watches,
            follows=self._follows,
            moves=action.shows_neutral or action.guarded(options),
            silence=self._silence,
            speak=session.speak,
        )
        session.flush = seat.flush
        may_prove = (lambda now: True) if self._follows else None  # the station sees to that no other one does
        return await seat.run(perform(session, action, options, output, group, may_prove, self._note_vehicle))

    def _build_session(
        self, action: VerbAction, options: argparse.Namespace, output: SentOutput
    ) -> VerbSession | DoctorSession:
        station = self._station
        ids, endpoints = station.parts.ids, station.station_info.endpoints
        options.system = ids[0]

        def build_core() -> VerbCore:
            core = VerbCore(station, options.vehicle)
            tap = action.tap(options, ids)
            if tap is not None:
                core.record(tap)
            return core

        session = build_session(action, options, output, endpoints, build_core, (ids, station.parts.proofs))
        session.files, session.companion = self._files, self._companion
        session.program, session.silence = self._name, self._silence
        return session

    def _note_vehicle(self, name: str) -> None:
        self._vehicle = name


def _parse(asked: RunVerb) -> tuple[VerbAction, argparse.Namespace]:
    """Parse a command line that the shell has parsed before, and load the verb. Raises VerbError."""
    words = asked.words
    options = build_parser(words[0], LineParser).parse_args(words[1:])
    if asked.dialect not in ("", used_dialect()):
        hint = "start the station with the same --dialect, or take --station never"
        raise VerbError(ExitCode.USAGE, f"{options.dialect}: the station does not know this dialect: {hint}")
    options.given = asked.given
    action = choose_action(words[0], options)
    check_options(action, options)
    if isinstance(action.run, LazyAttribute | LazyCall):
        action = replace(action, run=action.run.resolve())
    return action, options
