"""`mavhelm replay`: a telemetry log in the screens."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from groundstation.cli.console import docs_file, import_screen, open_screen, terminal_path
from groundstation.cli.local.lesson_options import add_lesson, continue_lesson
from groundstation.cli.local.runner import load_settings, run_local
from groundstation.cli.options import REPLAY_SETTINGS, add_config, add_settings
from groundstation.cli.verb_help import local_examples
from groundstation.client import StationClient
from groundstation.watchdog.terminal_guard import guard_terminal
from link.runtime.command_line import CommandLineParser

SPEEDS = (0.25, 32.0)
"""Slowest and fastest."""


EPILOG = """\
FILE is a telemetry log (.tlog) of this program, MAVProxy, QGroundControl or Mission Planner; damaged parts are left out
and named. Nothing is ever sent: the program that reads the log has no links. All screens show the moment of the log;
Ctrl-G 0 has the timeline, the events and the keys: p plays, the arrows move, / searches, : goes to a time.

times: 12:04:10 by the clock of the log, 1:23 from its start, +30 from its first vehicle

exit codes: 0 after a session, 2 for wrong arguments or a file that is not a telemetry log, 128 + n after signal n
"""


def build_replay_parser() -> CommandLineParser:
    """Return the parser."""
    parser = CommandLineParser(
        prog="mavhelm replay",
        description="Show a telemetry log in the screens.",
        epilog=f"{local_examples('replay')}\n\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="telemetry log (.tlog)")
    parser.add_argument("--at", default="", metavar="TIME", help="time at which it begins")
    parser.add_argument(
        "--speed",
        dest="factor",
        type=_factor,
        default=1.0,
        metavar="X",
        help="speed of playing, 0.25 to 32 (default: 1)",
    )
    add_lesson(parser)
    add_settings(parser, REPLAY_SETTINGS)
    add_config(parser)
    return parser


def _factor(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not SPEEDS[0] <= value <= SPEEDS[1]:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.25 to 32")
    return value


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm replay`; return the exit code."""
    return run_local(build_replay_parser(), arguments, _replay)


def _replay(options: argparse.Namespace) -> int:
    settings = load_settings(options).settings

    def start(log_file: Path | None) -> StationClient:
        return StationClient.start_replay(
            options.file.expanduser(),
            at=options.at,
            speed=options.factor,
            log_file=log_file,
            dialect=settings.dialect_path,
            param_docs=docs_file(settings.param_docs),
            meanwhile=import_screen,
        )

    with guard_terminal(terminal_path()):  # the process that reads the log has no watchdog
        return open_screen(settings, start, "replay", lesson=continue_lesson(options))
