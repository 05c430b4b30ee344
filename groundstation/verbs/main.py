"""Runs one verb: parses its arguments, opens the links, waits for the vehicle."""

from __future__ import annotations

import argparse
import asyncio
import logging
import os
import signal
import sys
import time
from collections.abc import Mapping, Sequence

from dialects.extra.errors import DialectError
from dialects.extra.option import use_dialect
from groundstation.config.config_file import ConfigError
from groundstation.config.effective import (
    ENDPOINT_VARIABLE,
    environment_endpoints,
    load_config,
    merge,
    resolve_endpoints,
)
from groundstation.config.settings import DEFAULT_ENDPOINT
from groundstation.formats.errors import FileFormatError
from groundstation.recent.recent_file import RecentFile
from groundstation.verbs.arguments import seconds, system_id
from groundstation.verbs.completion import SHELLS, build_script
from groundstation.verbs.core import COMPONENT, WATCHER
from groundstation.verbs.demand_guard import DemandGuard
from groundstation.verbs.exit_codes import ExitCode, VerbError
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession, run_session
from groundstation.verbs.station_session import StationSession, run_station
from groundstation.verbs.table import ONLY, VERBS, VerbAction
from link.endpoint import EndpointError
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser
from link.runtime.event_loop import run_loop
from link.transport.transport import LinkError

SYSTEM = 254
"""Our MAVLink system id: not the 255 of a ground station that drives beside, whose commands would then be ours too."""

EPILOG = f"""\
exit codes: 0 done and confirmed; 1 this program failed; 2 wrong arguments; 3 no vehicle within --wait; 4 refused;
5 no answer; 6 not in control; 7 differs, is not so, or no such thing; 8 partly done; 128 + n after signal n

A port that a running ground station listens on is taken: connect the verb by another link of the vehicle, or by
`bridge`. Endpoints, or names of the config file, come from -e, else from {ENDPOINT_VARIABLE} (separated by spaces),
else from `open` in the config file; else it is the endpoint used last, else {DEFAULT_ENDPOINT}.
"""


def run(arguments: Sequence[str]) -> int:
    """Run the verb that `arguments` start with; return the exit code."""
    parser = build_parser(arguments[0])
    options = parser.parse_args(parser.reject_empty(arguments[1:]))
    output = Output(f"{arguments[0]} {options.action}".strip(), as_json=options.json, quiet=options.quiet)
    logging.basicConfig(handlers=[logging.NullHandler()])  # what is worth knowing is printed
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a transfer ends in order, and can be resumed
    caught: list[int] = []
    try:
        use_dialect(options.dialect)
        action = VERBS[arguments[0]][options.action]
        if action.check is not None:
            action.check(options)
        code = run_loop(_run(action, options, output, caught))
        sys.stdout.flush()
    except ConfigError as error:
        for problem in error.problems:
            output.error(problem)
        return int(ExitCode.USAGE)
    except (VerbError, FileFormatError, DialectError, EndpointError, LinkError) as error:
        output.error(str(error))
        return int(error.code if isinstance(error, VerbError) else ExitCode.USAGE)
    except (KeyboardInterrupt, asyncio.CancelledError):
        return 128 + (caught[0] if caught else signal.SIGINT)
    except OSError as error:  # of the output: full, or closed by its reader
        stdio.discard_output()
        output.error(f"output: {error.strerror or error}")
        return int(ExitCode.BROKEN)
    return code


async def _run(action: VerbAction, options: argparse.Namespace, output: Output, caught: list[int]) -> int:
    """Run the action. A signal cancels it, so that it ends in order, and is noted in `caught`."""
    recent = RecentFile()
    endpoints = choose_endpoints(options.endpoints, options.config, os.environ, recent)
    if recent.warning:
        output.note(recent.warning)
    _cancel_on_signals(caught)
    ids = (options.system, WATCHER if action.watches else COMPONENT)
    guard = DemandGuard(ids) if action.guarded(options) else None  # before the links are open

    async def script(session: VerbSession) -> int:
        await _prepare(session, action, options, " ".join(endpoints))
        if action.finds and options.endpoints:
            recent.update(lambda known: known.add_all(endpoints, time.time(), session.vehicle.name))
        return await action.run(session, options, output)

    async def alone(session: StationSession) -> int:
        return await action.run(session, options, output)

    try:
        async with asyncio.timeout(None if action.own_timeout else options.timeout):
            if action.station:
                return await run_station(endpoints, options.system, getattr(options, "station", 0), alone)
            return await run_session(endpoints, ids, options.vehicle, script, output.progress, guard)
    except TimeoutError:
        raise VerbError(ExitCode.NO_ANSWER, f"not done within {options.timeout:g} s") from None
    finally:
        if guard is not None:
            guard.close()


async def _prepare(session: VerbSession, action: VerbAction, options: argparse.Namespace, where: str) -> None:
    """Do what the action needs before it runs."""
    if action.finds:
        await session.find_vehicle(options.wait, options.vehicle, where)
    if action.takes_part:
        await session.take_part()
    if action.shows_neutral:
        await session.show_neutral()


def _cancel_on_signals(caught: list[int]) -> None:
    """Let SIGTERM and SIGHUP cancel this task, as asyncio does with SIGINT."""
    task = asyncio.current_task()
    assert task is not None

    def cancel(number: int) -> None:
        caught.append(number)
        task.cancel()

    for number in (signal.SIGTERM, signal.SIGHUP):
        asyncio.get_running_loop().add_signal_handler(number, cancel, number)


def choose_endpoints(
    texts: Sequence[str] | None, config: str | None, environment: Mapping[str, str], recent: RecentFile
) -> list[str]:
    """Return the endpoints of -e, of MAVHELM_ENDPOINT, of the config file, or the one used last.

    The config file is read only where it matters: a mistake in it does not keep a verb from a vehicle that -e names.
    Raises ConfigError, EndpointError.
    """
    texts = texts or environment_endpoints(environment)
    if texts and all(":" in text for text in texts):
        return list(texts)
    effective = merge(load_config(config, environment, VERBS), environment, {"open": texts} if texts else {})
    if not texts and "open" not in effective.sources:
        return [recent.load().last or DEFAULT_ENDPOINT]
    return resolve_endpoints(effective.settings.open, effective.settings)


def build_parser(verb: str) -> CommandLineParser:
    """Return the parser for the arguments behind a verb."""
    parser = CommandLineParser(prog=f"groundstation {verb}", epilog=EPILOG, formatter_class=_HELP)
    if ONLY in VERBS[verb]:
        _add_arguments(parser, VERBS[verb][ONLY])
        parser.set_defaults(action=ONLY)
        return parser
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=CommandLineParser)
    for name, action in VERBS[verb].items():
        _add_arguments(actions.add_parser(name, help=action.help, epilog=EPILOG, formatter_class=_HELP), action)
    return parser


def _add_arguments(parser: argparse.ArgumentParser, action: VerbAction) -> None:
    parser.description = f"{action.help[0].upper()}{action.help[1:]}."
    for argument, settings in action.arguments:
        parser.add_argument(argument, **settings)
    _add_common(parser)


_HELP = argparse.RawDescriptionHelpFormatter


def _add_common(parser: argparse.ArgumentParser) -> None:
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
    add("-v", "--vehicle", type=system_id, metavar="ID", help="its system id (default: the only vehicle)")
    add("--wait", type=seconds, default=10.0, metavar="S", help="for the vehicle's heartbeat (default: 10)")
    add("--timeout", type=seconds, metavar="S", help="end after this time in any case")
    add("--system", type=system_id, default=SYSTEM, metavar="ID", help=f"our system id (default: {SYSTEM})")
    add("--dialect", metavar="FILE.xml", help="definitions of a vehicle that sends messages of its own")
    add("--json", action="store_true", help="print one JSON object a line")
    add("-q", "--quiet", action="store_true", help="print no progress and no notes")  # fmt: skip


def build_completion_parser() -> CommandLineParser:
    """Return the parser of `completion`."""
    parser = CommandLineParser(
        prog="groundstation completion",
        description="Print a script that completes verbs, options and names in a shell.",
        epilog='bash: eval "$(groundstation completion bash)" in ~/.bashrc; zsh likewise; '
        "fish: groundstation completion fish | source",
    )
    parser.add_argument("shell", choices=SHELLS)
    return parser


def run_completion(arguments: Sequence[str], helps: Mapping[str, str]) -> int:
    """Print the script for a shell; return the exit code."""
    parser = build_completion_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    try:
        sys.stdout.write(build_script(options.shell, helps))
        sys.stdout.flush()
    except OSError as error:
        stdio.discard_output()
        sys.stderr.write(f"groundstation: output: {error.strerror or error}\n")
        return int(ExitCode.BROKEN)
    return int(ExitCode.DONE)
