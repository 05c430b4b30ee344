"""Runs one verb: parses its arguments, opens the links, waits for the vehicle."""

from __future__ import annotations

import argparse
import asyncio
import logging
import math
import os
import signal
import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from msgspec.structs import replace

from dialects.extra.errors import DialectError
from dialects.extra.option import use_dialect, used_dialect
from groundstation.config.defaults import DEFAULT_ENDPOINT, ENDPOINT_VARIABLE
from groundstation.formats.errors import FileFormatError
from groundstation.station_socket.about import explain_taken
from groundstation.station_socket.hello import HELLO_WITHIN, VERB, Hello
from groundstation.station_socket.verb_run import VERSION, AskedGroup, RunVerb
from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.client.companion import RunCompanion, local_companion
from groundstation.verbs.client.station_choice import AUTO, StationLink, find_station, station_choice
from groundstation.verbs.common.arguments import seconds, system_id, vehicle_id
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.common.loading import load
from groundstation.verbs.common.nearest import describe_unknown
from groundstation.verbs.common.output import Output, ring_bell
from groundstation.verbs.session.endpoints import choose_endpoints, config_error, link_error, remember
from groundstation.verbs.session.stop_ways import STOP_WITHIN, stop_by_any_way
from groundstation.verbs.session.vehicle_choice import choose_group
from groundstation.verbs.table import VERBS
from groundstation.verbs.verb import format_examples
from link.endpoint import EndpointError
from link.runtime import startup_gc, stdio
from link.runtime.command_line import CommandLineParser
from link.runtime.event_loop import run_loop

if TYPE_CHECKING:
    from groundstation.config.groups import VehicleGroup
    from groundstation.speech.voice import Voice
    from groundstation.verbs.common.channel import CompanionChannel
    from groundstation.verbs.session.core import VerbCore
    from groundstation.verbs.session.demand_guard import DemandGuard
    from groundstation.verbs.session.doctor_session import DoctorSession
    from groundstation.verbs.session.session import VerbSession
    from groundstation.verbs.session.station_seat import StationSeat
    from link.link_signing import LinkSigning
    from link.runner import Runner

SYSTEM = 254
"""Our MAVLink system id: not the 255 of a ground station that drives beside, whose commands would then be ours too."""

demand_guard = LazyModule("session.demand_guard")

STOP_WAIT = 30.0
"""s for which a stop is sent to a vehicle that is not heard: a radio link may be cut for some seconds."""

HELD = "--station {pid} goes through it"
"""What to do where a station of one's own has the port or device that a verb opens."""

NO_STATION = "no ground station of yours runs here: start `mavhelm` in a terminal first"

HELP_ALL = "all vehicles that are heard, at once; prints a table, and the exit code is the worst"
HELP_GROUP = "several vehicles: a name of [groups] in the config file, system ids as 1-20,31, or a pattern of names"

EPILOG = f"""\
exit codes: 0 done and confirmed; 1 this program failed; 2 wrong arguments; 3 no vehicle within --wait; 4 refused;
5 no answer; 6 not in control; 7 differs, is not so, or no such thing; 8 partly done; 128 + n after signal n

It goes through the ground station that runs here, if there is one (--station). Endpoints, or names of the config
file, come from -e, else from {ENDPOINT_VARIABLE} (separated by spaces), else from `open` in the config file; else it
is the endpoint used last, else {DEFAULT_ENDPOINT}.
"""


def run(arguments: Sequence[str]) -> int:
    """Run the verb that `arguments` start with; return the exit code."""
    parser = build_parser(arguments[0])
    options, unknown = parser.parse_known_args(parser.reject_empty(arguments[1:]))
    if unknown:
        parser.error(describe_unknown(unknown))
    output = Output(f"{arguments[0]} {options.action}".strip(), as_json=options.json, quiet=options.quiet)
    logging.basicConfig(handlers=[logging.NullHandler()])  # what is worth knowing is printed
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a transfer ends in order, and can be resumed
    caught: list[int] = []
    try:
        use_dialect(options.dialect)
        action = choose_action(arguments[0], options)
        options.words = tuple(arguments)
        group = choose_group(output.verb, action, options)
        options.given = None if action.prepare is None else action.prepare(options)
        output.voice = _open_voice(options)
        code = run_loop(
            _run_offline(action, options, output, caught)
            if action.offline
            else _run(action, options, output, caught, group)
        )
        sys.stdout.flush()
    except config_error() as error:
        for problem in error.problems:
            output.error(problem)
        return int(ExitCode.USAGE)
    except (VerbError, FileFormatError, DialectError, EndpointError, link_error()) as error:
        output.error(explain_taken(str(error), HELD))
        return int(error.code if isinstance(error, VerbError) else ExitCode.USAGE)
    except (KeyboardInterrupt, asyncio.CancelledError):
        return 128 + (caught[0] if caught else signal.SIGINT)
    except OSError as error:  # of the output: full, or closed by its reader
        return stdio.end_output(error, lambda reason: output.error(f"output: {reason}"))
    finally:
        output.clear_progress()
        if output.voice is not None:
            output.voice.close()
    return code


def _open_voice(options: argparse.Namespace) -> Voice | None:
    """Return what speaks and rings for --speak and --bell. Raises VerbError."""
    speak, bell = bool(getattr(options, "speak", False)), bool(getattr(options, "bell", False))
    if not speak and not bell:
        return None
    from groundstation.speech.programs import find_program, missing_program
    from groundstation.speech.voice import Voice

    if speak and find_program() is None:
        raise VerbError(ExitCode.USAGE, missing_program())
    return Voice.open(speak=speak, ring=ring_bell if bell else None)


def choose_action(verb: str, options: argparse.Namespace) -> VerbAction:
    """Return the action that the options name."""
    action = VERBS[verb].actions[options.action]
    if action.only_reads(options):
        action = replace(action, watches=True, needs_session=False, shows_neutral=False)
    return action


def check_options(action: VerbAction, options: argparse.Namespace) -> None:
    """Check what argparse cannot. Raises VerbError, FileFormatError, ConfigError.

    It is done where the verb runs, because it imports the module of the verb.
    """
    if action.check is not None:
        action.check(options)


async def _run_offline(action: VerbAction, options: argparse.Namespace, output: Output, caught: list[int]) -> int:
    """Run an action that needs no vehicle."""
    check_options(action, options)
    _cancel_on_signals(caught)
    startup_gc.resume()
    return await action.run(None, options, output)


async def _run(
    action: VerbAction, options: argparse.Namespace, output: Output, caught: list[int], group: VehicleGroup | None
) -> int:
    """Run the action, for all vehicles of a group if there is one; a stop past a station that hangs.

    A signal cancels it, so that it ends in order, and is noted in `caught`.
    """
    _cancel_on_signals(caught)
    if not action.stops or options.through != AUTO:
        return await _run_once(action, options, output, group, options.through)
    until = asyncio.get_running_loop().time() + (options.timeout or STOP_WAIT)

    async def attempt(through: str, endpoints: Sequence[str]) -> int:
        ours = argparse.Namespace(**vars(options))  # those of a station take the place of some
        ours.endpoints = list(endpoints) or options.endpoints
        return await _run_once(action, ours, output, group, through, STOP_WITHIN)

    return await stop_by_any_way(attempt, output.note, until)


async def _run_once(
    action: VerbAction,
    options: argparse.Namespace,
    output: Output,
    group: VehicleGroup | None,
    through: str,
    patience: float = math.inf,
) -> int:
    """Do so once, in a station, or in this process. A station may be silent for `patience` s, or for HANGS_AFTER."""
    station, endpoints = _find_way(action, options, output, through, min(patience, HELLO_WITHIN))
    if station is None:
        if action.stops:  # its other ways are tried at once
            return await _run_here(action, options, output, group, endpoints)
        from groundstation.verbs.session.running import run_when_port_free

        return await run_when_port_free(lambda: _run_here(action, options, output, group, endpoints))
    from groundstation.verbs.client.verb_client import HANGS_AFTER, VerbClient  # a verb with links does without

    startup_gc.resume()
    client = VerbClient(station, output, min(patience, HANGS_AFTER))
    ended = await client.run(ask_for_verb(options, group), _companion_of(action, options, output))
    if options.endpoints and ended.vehicle:
        remember(endpoints, ended.vehicle)
    return ended.code


async def _run_here(
    action: VerbAction,
    options: argparse.Namespace,
    output: Output,
    group: VehicleGroup | None,
    endpoints: Sequence[str],
) -> int:
    """Run the action in this process, with links of its own."""
    from groundstation.station.driving.proofs import SessionProofs
    from groundstation.verbs.performing import build_session, perform  # a verb that a station runs does without
    from groundstation.verbs.session.core import VerbCore
    from groundstation.verbs.session.kept_session import choose_identity
    from groundstation.verbs.session.running import run_over

    ids, kept = choose_identity(action, options.system, time.monotonic())
    tap = action.tap(options, ids)
    signing = None if getattr(options, "unsigned", False) else _open_signing()
    guard: DemandGuard | None = None
    if action.guarded(options):  # before the links are open
        guard = demand_guard.DemandGuard(ids, signing.signing if signing else None)

    def build_core() -> VerbCore:
        now = asyncio.get_running_loop().time()
        core = VerbCore.alone(ids, options.vehicle, kept.number, endpoints, now)
        core.standstill = core.standstill if guard is None else guard.standstill
        return core

    session = build_session(action, options, output, endpoints, build_core, (ids, SessionProofs(kept.number)))

    def found(name: str) -> None:
        if options.endpoints:
            remember(endpoints, name)

    async def script(runner: Runner) -> int:
        session.flush, session.observe = runner.flush, runner.observe
        may_prove = kept.may_prove if kept.follows else None
        async with local_companion(_companion_of(action, options, output)) as session.companion:
            work = perform(session, action, options, output, group, may_prove, found)
            return await (seat.run(work) if (seat := _take_seat(session, action, runner)) else work)

    startup_gc.resume()
    try:
        async with asyncio.timeout(None if action.own_timeout or group is not None else options.timeout):
            return await run_over(
                endpoints,
                session.station,
                script,
                ids=ids,
                signing=signing,
                log_tap=tap,
                guard=guard,
                driven=session.driven,
            )
    except TimeoutError:
        raise VerbError(ExitCode.NO_ANSWER, f"not done within {options.timeout:g} s") from None
    finally:
        kept.end(time.monotonic())
        if guard is not None:
            guard.close()


def _take_seat(session: VerbSession | DoctorSession, action: VerbAction, runner: Runner) -> StationSeat | None:
    """Return the seat of a verb in the OperatorCore of this process; None: it is that core itself."""
    from groundstation.verbs.session.station_seat import StationSeat

    if session.core is session.station:
        return None
    needs = action.needs_session
    seat = StationSeat(session.station, session.core, "a verb", runner.flush, needs_session=needs, alone=True)
    session.flush = seat.flush
    return seat


def _companion_of(action: VerbAction, options: argparse.Namespace, output: Output) -> RunCompanion | None:
    companion = action.companion
    if companion is None:
        return None

    async def run(channel: CompanionChannel) -> None:
        await load(companion)
        await companion(options, output, channel)

    return run


def ask_for_verb(options: argparse.Namespace, group: VehicleGroup | None) -> RunVerb:
    """Return what asks a station to run the verb."""
    vehicles = None if group is None else AskedGroup(group.listed, group.others, group.patterns)
    return RunVerb(options.words, vehicles, options.given, used_dialect())


def _find_way(
    action: VerbAction, options: argparse.Namespace, output: Output, through: str, within: float
) -> tuple[StationLink | None, Sequence[str]]:
    """Return the station that the verb goes through, or None, and the endpoints. Raises VerbError, EndpointError."""

    def choose() -> list[str]:
        return choose_endpoints(options.endpoints, options.config, os.environ, note=output.note, reserved=VERBS)

    endpoints = choose() if options.endpoints or os.environ.get(ENDPOINT_VARIABLE) else []
    hello = Hello(VERB, VERSION, f"mavhelm {output.verb}", follows=action.follows)
    station = find_station(through, endpoints, hello, output.note, within)
    if station is not None:
        return station, station.endpoints
    if action.in_station:
        raise VerbError(ExitCode.NO_VEHICLE, NO_STATION)
    check_options(action, options)
    return None, endpoints or choose()


def _open_signing() -> LinkSigning | None:
    """Return what signs the frames of a verb that has links of its own. Raises VerbError."""
    from groundstation.connect.signing import SigningError, open_signing  # a verb through a station does without

    try:
        return open_signing(time.monotonic())
    except SigningError as error:
        raise VerbError(ExitCode.USAGE, str(error)) from None


def _cancel_on_signals(caught: list[int]) -> None:
    """Let SIGTERM and SIGHUP cancel this task, as asyncio does with SIGINT."""
    task = asyncio.current_task()
    assert task is not None

    def cancel(number: int) -> None:
        caught.append(number)
        task.cancel()

    for number in (signal.SIGTERM, signal.SIGHUP):
        asyncio.get_running_loop().add_signal_handler(number, cancel, number)


def build_parser(verb: str, kind: type[CommandLineParser] = CommandLineParser) -> CommandLineParser:
    """Return the parser for the arguments behind a verb."""
    row = VERBS[verb]
    epilog = f"{format_examples(row.examples)}\n\n{EPILOG}"
    parser = kind(prog=f"mavhelm {verb}", epilog=epilog, formatter_class=_HELP)
    if ONLY in row.actions:
        _add_arguments(parser, row.actions[ONLY])
        parser.set_defaults(action=ONLY)
        return parser
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=kind)
    for name, action in row.actions.items():
        examples = [each for each in row.examples if each.command.split()[2] == name]
        epilog = f"{format_examples(examples)}\n\n{EPILOG}"
        known = actions.add_parser(name, aliases=action.aliases, help=action.help, epilog=epilog, formatter_class=_HELP)
        known.set_defaults(action=name)  # also for an alias
        _add_arguments(known, action)
    return parser


def _add_arguments(parser: argparse.ArgumentParser, action: VerbAction) -> None:
    parser.set_defaults(reserved=VERBS)  # no endpoint in the config file may have the name of a verb
    parser.description = f"{action.help[0].upper()}{action.help[1:]}."
    for argument, settings in action.arguments:
        parser.add_argument(argument, **settings)
    if not action.offline:
        _add_common(parser, action)
    _add_local(parser)


_HELP = argparse.RawDescriptionHelpFormatter


def _add_common(parser: argparse.ArgumentParser, action: VerbAction) -> None:
    add = parser.add_argument
    add(
        "-e",
        "--endpoint",
        dest="endpoints",
        action="append",
        metavar="ENDPOINT|NAME",
        help="where the vehicle is; more than once for several links",
    )
    add("--config", metavar="FILE", help="config file with names of endpoints")
    add("-v", "--vehicle", type=vehicle_id, metavar="ID", help="its system id or name (default: the only vehicle)")
    add("--all", action="store_true", help=HELP_ALL if action.many else argparse.SUPPRESS)
    add("--group", metavar="GROUP", help=HELP_GROUP if action.many else argparse.SUPPRESS)
    wait = STOP_WAIT if action.stops else 10.0
    add("--wait", type=seconds, default=wait, metavar="S", help=f"for the vehicle's heartbeat (default: {wait:g})")
    add(
        "--station",
        dest="through",
        type=station_choice,
        default=AUTO,
        metavar="auto|only|never|PID",
        help="go through the station that runs here (auto: if one does)",
    )
    add("--timeout", type=seconds, metavar="S", help="end after this time in any case")
    add("--system", type=system_id, default=SYSTEM, metavar="ID", help=f"our system id (default: {SYSTEM})")


def _add_local(parser: argparse.ArgumentParser) -> None:
    """Add the options that a verb without a vehicle has as well."""
    add = parser.add_argument
    add("--dialect", metavar="FILE.xml", help="definitions of a vehicle that sends messages of its own")
    add("--json", action="store_true", help="print one JSON object a line")
    add("-q", "--quiet", action="store_true", help="print no progress and no notes")  # fmt: skip
