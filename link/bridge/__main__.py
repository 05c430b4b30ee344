"""Command line of the bridge: parses and checks the arguments, opens the transports, runs bridge.py."""

from __future__ import annotations

import argparse
import asyncio
import gc
import logging
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from typing import Any

from dialects.enums import Severity
from dialects.extra.errors import DialectError
from dialects.extra.option import use_dialect
from link.bridge.bridge import Bridge
from link.bridge.recorder import RecorderError, open_recorder
from link.bridge.screens import StatusLogger, StatusWriter, print_json
from link.bridge.status import BridgeStatus
from link.endpoint import EndpointError, endpoint_help, parse_endpoint, parse_endpoints
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser
from link.tlog.recorder import Recorder
from link.transport.transport import LinkError, Transport
from link.transport.transports import open_transports

log = logging.getLogger(__name__)

EXAMPLES = """\
examples:
  mavhelm bridge serial:/dev/ttyAMA0:57600 udpin:0.0.0.0:14550         an autopilot, for many ground stations
  mavhelm bridge serial:/dev/ttyACM0:921600 udpout:192.168.1.20:14550 udpin:127.0.0.1:14551
  mavhelm bridge udpin:0.0.0.0:14550 tcpin:0.0.0.0:5760 --json --tlog logs
  mavhelm bridge doctor serial:/dev/ttyAMA0:57600 udpin:0.0.0.0:14550  what arrives, where it would go; sends nothing
  mavhelm bridge fleet --help                                          vehicles and ground stations over the internet:
  mavhelm bridge router --help                                         certificates, and the router

endpoints (two or more):
{endpoints}

exit codes: 0 stopped by a signal (SIGTERM, Ctrl-C, SIGHUP), 2 usage error.
"""

SUBCOMMANDS = {
    "doctor": "link.bridge.doctor.command",
    "router": "link.bridge.fleet.router_command",
    "fleet": "link.bridge.fleet.fleet_command",
}
"""First argument that does something else than join endpoints -> the module with its `run`."""
SWITCH_INTERVAL = 0.0005
"""s that the table's thread may hold up the loop at a time; Python's default of 5 ms would show in the latency."""


class _Version(argparse.Action):
    """Looks the version up only on request."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import version

        print(f"mavhelm bridge {version('mavhelm')}")
        parser.exit()


def main(argv: Sequence[str] | None = None) -> int:
    """Run the bridge; return the exit code."""
    stdio.ensure_open()
    return stdio.run_program("mavhelm bridge", lambda: _run(list(sys.argv[1:] if argv is None else argv)))


def _run(arguments: list[str]) -> int:
    if arguments[:1] and arguments[0] in SUBCOMMANDS:
        run: Callable[[Sequence[str]], int] = import_module(SUBCOMMANDS[arguments[0]]).run
        return run(arguments[1:])
    parser = build_parser()
    parser.reject_unknown_options(arguments)
    parser.reject_unknown_word(arguments, SUBCOMMANDS)
    options = parser.parse_args(parser.reject_empty(arguments))
    _check(options.endpoints, parser)
    stdio.log_plainly(logging.StreamHandler(), logging.INFO, "bridge: %(message)s")
    try:
        for note in use_dialect(options.dialect):
            log.log(logging.WARNING if note.severity <= Severity.WARNING else logging.INFO, note.text)
        with ExitStack() as stack:
            asyncio.run(_serve(options, stack))
    except (DialectError, LinkError, RecorderError) as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    except KeyboardInterrupt:  # before the loop handles signals
        return 0
    return 0


async def _serve(options: argparse.Namespace, stack: ExitStack) -> None:
    transports = open_transports(options.endpoints)
    recorder = _recorder(options.tlog, transports, stack)
    bridge = Bridge(transports, _screen(options, stack), recorder=recorder, join=not options.one_frame)
    loop = asyncio.get_running_loop()
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        loop.add_signal_handler(number, bridge.stop)
    sys.setswitchinterval(SWITCH_INTERVAL)
    gc.collect()
    gc.freeze()  # a full collection would delay frames by 20 ms
    log.info("ready, %s", " + ".join(options.endpoints))
    await bridge.run()
    log.info("stopped")


def _recorder(folder: Path | None, transports: Sequence[Transport], stack: ExitStack) -> Recorder | None:
    if folder is None:
        return None
    try:
        path, recorder = open_recorder(folder)
    except RecorderError:
        for transport in transports:
            transport.close()
        raise
    stack.callback(recorder.close)
    log.info("recording to %s", path)
    return recorder


def _screen(options: argparse.Namespace, stack: ExitStack) -> Callable[[BridgeStatus], None]:
    """Return the status output: a table on a terminal, else a log of problems, with --json also JSON."""
    if sys.stdout.isatty() and not options.quiet and not options.json:
        return StatusWriter(_live_table(stack)).update
    logger = StatusLogger()
    if not options.json:
        return logger.update
    screen = StatusWriter(print_json)

    def both(status: BridgeStatus) -> None:
        screen.update(status)
        logger.update(status)

    return both


def _live_table(stack: ExitStack) -> Callable[[BridgeStatus], None]:
    from rich.console import Console

    from link.bridge.table import LiveTable

    table = LiveTable(Console())
    stack.callback(table.close)
    return table.update


def _check(endpoints: Sequence[str], parser: CommandLineParser) -> None:
    if len(endpoints) < 2:
        parser.error("two endpoints or more are needed, for example serial:/dev/ttyAMA0:57600 udpin:0.0.0.0:14550")
    try:
        parse_endpoints(endpoints)
    except EndpointError as error:
        parser.error(str(error))


def _endpoint(text: str) -> str:
    try:
        return parse_endpoint(text).text
    except EndpointError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def build_parser() -> CommandLineParser:
    """Return the parser of the options."""
    parser = CommandLineParser(
        prog="mavhelm bridge",
        description="Joins MAVLink endpoints: forwards frames by system and component id and changes none.",
        epilog=EXAMPLES.format(endpoints=endpoint_help()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("endpoints", nargs="*", metavar="ENDPOINT", type=_endpoint, help="one end of the bridge")
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("--json", action="store_true", help="print the status as one line of JSON a second")
    shown.add_argument("--quiet", action="store_true", help="no table; log problems only")
    parser.add_argument("--tlog", metavar="DIR", type=Path, help="record all frames to a telemetry log in DIR")
    parser.add_argument(
        "--one-frame",
        action="store_true",
        help="send each frame in its own datagram, for receivers that read only the first frame",
    )
    parser.add_argument(
        "--dialect",
        metavar="FILE.xml",
        help="definitions of a vehicle that sends messages of its own: verify them, and route them by their target",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    return parser


if __name__ == "__main__":
    sys.exit(main())
