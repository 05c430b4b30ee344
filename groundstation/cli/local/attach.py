"""`mavhelm attach`: a screen for a station that runs."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from groundstation.cli.console import open_screen, terminal_path
from groundstation.cli.local.lesson_options import add_lesson, continue_lesson
from groundstation.cli.local.runner import UsageError, load_settings, run_local
from groundstation.cli.options import add_config, add_settings
from groundstation.cli.verb_help import local_examples
from groundstation.client import StationClient, StationError
from groundstation.gamepad.tab_stick import inherit_stick
from groundstation.station_socket.about import describe_stations
from groundstation.station_socket.connect import running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.watchdog.terminal_guard import guard_terminal
from link.runtime.command_line import CommandLineParser

EPILOG = """\
The first screen of a station drives. Another one watches, and may stop; the key of `Take control` asks for the keys,
which the driver gives (Y) or keeps (N). Quitting leaves a station of `serve` running; one of `mavhelm --keep`
ends when its driver quits.

exit codes: 0 after a session, 2 for wrong arguments or no station, 128 + n after signal n
"""


def build_parser() -> CommandLineParser:
    """Return the parser."""
    parser = CommandLineParser(
        prog="mavhelm attach",
        description="Open a screen for a station that runs here.",
        epilog=f"{local_examples('attach')}\n\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("pid", nargs="?", type=_process_id, metavar="PID", help="its process id, where several run")
    parser.add_argument("--watch", action="store_true", help="begin without the keys, also if no other screen drives")
    add_lesson(parser)
    add_settings(parser)
    add_config(parser)
    return parser


def _process_id(text: str) -> int:
    if not (text.isascii() and text.isdecimal()):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not the number of a process: leave it out where one station runs"
        )
    return int(text)


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm attach`; return the exit code."""
    return run_local(build_parser(), arguments, _attach)


def _attach(options: argparse.Namespace) -> int:
    settings = load_settings(options).settings
    stick = inherit_stick()
    pid = choose_station(options.pid)

    def connect(log_file: Path | None) -> StationClient:
        return StationClient.attach(pid, f"screen on {_terminal_name()}", watches=options.watch)

    with guard_terminal(terminal_path()):  # the watchdog of the station knows the terminal of its first screen only
        lesson = continue_lesson(options)
        first = lesson.attempt.lesson.screen if lesson is not None else "drive"
        return open_screen(settings, connect, first, stick=stick, lesson=lesson)


def choose_station(wanted: int | None) -> int:
    """Return the process id of the station. Raises UsageError, StationError."""
    try:
        found = running_stations()
    except FolderError as error:
        raise StationError(str(error)) from error
    if not found:
        raise StationError("no station runs here: `mavhelm` or `mavhelm serve --headless` starts one")
    if wanted is None and len(found) > 1:
        raise UsageError(f"stations {describe_stations(found)} run here: name one, as in `attach {found[0]}`")
    return found[0] if wanted is None else wanted


def _terminal_name() -> str:
    """Return the terminal as `who` names it, e.g. "pts/4"."""
    try:
        return os.ttyname(0).removeprefix("/dev/")
    except OSError:
        return f"process {os.getpid()}"
