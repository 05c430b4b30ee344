"""The command line of the ground station: judges what the user typed before the screen opens, then hands over."""

from __future__ import annotations

import argparse
import errno
import shutil
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from platformdirs import user_log_path

from groundstation.client import StationClient, StationError
from groundstation.input.keymap import KEYMAPS, KeymapError
from groundstation.input.keymap_file import load_keymap
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from link.endpoint import EndpointError, endpoint_help, parse_endpoint
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser

DEFAULT_ENDPOINT = "udpin:127.0.0.1:14550"
"""The port that vehicles and simulators send to by custom; of this machine only, because MAVLink has no password."""

MIN_TERMINAL_SIZE = (40, 10)
"""Columns and rows below which not even the message fits that the terminal is too small."""

EXAMPLES = f"""\
examples:
  groundstation --sitl                     start a simulated rover and drive it
  groundstation                            wait for a vehicle on {DEFAULT_ENDPOINT}
  groundstation udpin:0.0.0.0:14550        the same, from any machine of the network
  groundstation udpout:192.168.1.20:14550  send first, to a vehicle that listens
  groundstation --style latch --speed 0.3  the article's way of driving, slowly
  groundstation --keys teleop              the keys of teleop_twist_keyboard
  groundstation --keys my.toml             your own; see below

first drive: `r` then `y` arms, hold `i` (or w, or the up arrow) to drive, let go to stop,
`r` disarms. Space stops, `!` is the emergency stop everywhere, `?` shows all keys, Ctrl-Q leaves.

endpoints:
{endpoint_help()}

key map file (--keys my.toml): replaces the keys of the actions it names
  base = "standard"            # or "teleop"
  [keys]
  "drive.forward" = ["e", "up"]
"""


class UsageError(Exception):
    """The user's mistake, in one line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the ground station. 0 after a session, 2 after a mistake of the user's, 1 when the station broke."""
    stdio.ensure_open()
    parser = _parser()
    options = parser.parse_args(parser.reject_empty(sys.argv[1:] if arguments is None else arguments))
    try:
        return _run(options)
    except (UsageError, EndpointError, KeymapError, StationError) as error:
        print(f"groundstation: {error}", file=sys.stderr)
        return 2


def _run(options: argparse.Namespace) -> int:
    keymap = load_keymap(options.keys)
    endpoints = options.endpoints or ([] if options.sitl else [DEFAULT_ENDPOINT])
    for endpoint in endpoints:
        parse_endpoint(endpoint)
    _check_terminal()
    log_file = _log_file(options.log_file)
    client = StationClient.start(
        endpoints,
        system=options.system,
        style=options.style,
        speed=options.speed,
        sitl=options.sitl,
        log_file=log_file,
    )
    try:
        from groundstation.ui.app import run  # half a second that a mistake need not wait for

        return run(client, keymap=keymap, log_file=log_file)
    finally:
        client.close()


def _check_terminal() -> None:
    for name, stream in (("input", sys.stdin), ("output", sys.stdout)):
        if stream is None or not stream.isatty():
            raise UsageError(f"standard {name} is not a terminal: run it in one, without a pipe or redirection")
    columns, rows = shutil.get_terminal_size()
    if columns < MIN_TERMINAL_SIZE[0] or rows < MIN_TERMINAL_SIZE[1]:
        raise UsageError(
            f"the terminal is {columns}x{rows}: make it at least {MIN_TERMINAL_SIZE[0]}x{MIN_TERMINAL_SIZE[1]}, better 80x24"
        )


def _log_file(wanted: Path | None) -> Path | None:
    """The user's file, which must work, or the default one, without which we can live (a read-only home)."""
    path = wanted or user_log_path("mavhelm") / "groundstation.log"
    try:
        if wanted is None:
            path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_fifo():
            raise OSError(errno.EINVAL, "a pipe; name a file")  # a reader is waited for, without a word
        with path.open("a", encoding="utf-8"):
            return path.absolute()
    except OSError as error:
        if wanted is None:
            return None
        raise UsageError(f"log file {path}: {error.strerror}") from error


def _system_id(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= 255):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 255")
    return int(text)


def _speed(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not LOWEST_LIMIT <= value <= HIGHEST_LIMIT:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from {LOWEST_LIMIT} to {HIGHEST_LIMIT}")
    return value


def _parser() -> CommandLineParser:
    parser = CommandLineParser(
        prog="groundstation",
        description="Drive a MAVLink rover from the terminal.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("endpoints", nargs="*", metavar="ENDPOINT", help=f"where vehicles are (default: {DEFAULT_ENDPOINT})")
    add("--sitl", action="store_true", help="start a simulated rover, and end it with the ground station")
    add("--keys", default="standard", metavar="NAME|FILE", help=f"key map: {', '.join(KEYMAPS)} or a TOML file")
    add("--style", choices=[style.value for style in Style], default=Style.HOLD.value,
        help="hold: drive while a key is held (default); latch: until the next key; step: 10 %% a press")  # fmt: skip
    add("--speed", type=_speed, default=0.6, metavar="FRACTION", help="limit of the sticks, 0.1 to 1 (default: 0.6)")
    add("--system", type=_system_id, default=255, metavar="ID", help="our MAVLink system id (default: 255)")
    add("--log-file", type=Path, metavar="FILE", help=f"default: {user_log_path('mavhelm') / 'groundstation.log'}")
    add("--version", action="version", version=f"%(prog)s {version('mavhelm')}")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
