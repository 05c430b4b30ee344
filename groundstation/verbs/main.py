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
5 no answer; 7 differs, not ready, or no such thing; 8 partly done

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
    try:
        use_dialect(options.dialect)
        code = run_loop(_run(VERBS[arguments[0]][options.action], options, output))
        sys.stdout.flush()
    except ConfigError as error:
        for problem in error.problems:
            output.error(problem)
        return int(ExitCode.USAGE)
    except (VerbError, FileFormatError, DialectError, EndpointError, LinkError) as error:
        output.error(str(error))
        return int(error.code if isinstance(error, VerbError) else ExitCode.USAGE)
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except OSError as error:  # of the output: full, or closed by its reader
        stdio.discard_output()
        output.error(f"output: {error.strerror or error}")
        return int(ExitCode.BROKEN)
    return code


async def _run(action: VerbAction, options: argparse.Namespace, output: Output) -> int:
    recent = RecentFile()
    endpoints = choose_endpoints(options.endpoints, options.config, os.environ, recent)
    if recent.warning:
        output.note(recent.warning)

    async def script(session: VerbSession) -> int:
        await session.find_vehicle(options.wait, options.vehicle, " ".join(endpoints))
        if options.endpoints:
            recent.update(lambda known: known.add_all(endpoints, time.time(), session.vehicle.name))
        return await action.run(session, options, output)

    async def alone(session: StationSession) -> int:
        return await action.run(session, options, output)

    try:
        async with asyncio.timeout(options.timeout):
            if action.station:
                return await run_station(endpoints, options.system, getattr(options, "station", 0), alone)
            return await run_session(endpoints, options.system, options.vehicle, script, output.progress)
    except TimeoutError:
        raise VerbError(ExitCode.NO_ANSWER, f"not done within {options.timeout:g} s") from None


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
    add("-v", "--vehicle", type=_system_id, metavar="ID", help="its system id (default: the only vehicle)")
    add("--wait", type=_seconds, default=10.0, metavar="S", help="for the vehicle's heartbeat (default: 10)")
    add("--timeout", type=_seconds, metavar="S", help="end after this time in any case")
    add("--system", type=_system_id, default=SYSTEM, metavar="ID", help=f"our system id (default: {SYSTEM})")
    add("--dialect", metavar="FILE.xml", help="definitions of a vehicle that sends messages of its own")
    add("--json", action="store_true", help="print one JSON object a line")
    add("-q", "--quiet", action="store_true", help="print no progress and no notes")  # fmt: skip


def _system_id(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) <= 3 and 1 <= int(text) <= 255):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 255")
    return int(text)


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 < value <= 86_400:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds above 0")
    return value
