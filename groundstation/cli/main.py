"""Command line of the ground station: checks the arguments before the screen opens, then runs the UI."""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from platformdirs import user_log_path

from groundstation.cli.terminal import needs_ascii
from groundstation.cli.unknown_options import describe_unknown
from groundstation.cli.verb_help import VERB_HELP, verb_help
from groundstation.client import StationClient, StationError
from groundstation.input.keymap import KEYMAPS, KeymapError
from groundstation.input.keymap_file import load_keymap
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from link.endpoint import EndpointError, endpoint_help, parse_endpoint
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser

DEFAULT_ENDPOINT = "udpin:127.0.0.1:14550"
"""The port that vehicles and simulators usually send to; this machine only, because MAVLink has no password."""

MIN_TERMINAL_SIZE = (40, 10)
"""Columns and rows below which not even the message fits that the terminal is too small."""

EXAMPLES = f"""\
examples:
  groundstation --sitl                     start a simulated rover and drive it
  groundstation                            wait for a vehicle on {DEFAULT_ENDPOINT}
  groundstation udpin:0.0.0.0:14550        the same, from any machine of the network
  groundstation udpout:192.168.1.20:14550  send first, to a vehicle that listens
  groundstation --style latch --speed 0.3  a key drives until the next key, slowly
  groundstation --keys teleop              the keys of teleop_twist_keyboard
  groundstation --keys my.toml             your own keys; see below

first drive: hold `r` for a second to arm, hold `i` (or w, or the up arrow) to drive, release to stop;
one press of `r` disarms. Space stops, `!` is the emergency stop on every screen, `?` shows all keys, Ctrl-Q quits.
Keys drive on the Drive screen only. F6 lists all alerts and messages, F3 every MAVLink message,
Ctrl-G goes to the other screens, Escape back.

verbs, which open no screen (groundstation VERB --help):
{verb_help()}

endpoints:
{endpoint_help()}

key map file (--keys my.toml): replaces the keys of the actions it names
  base = "standard"            # or "teleop"
  [keys]
  "drive.forward" = ["e", "up"]

status line: link: four bars up to 2 % loss, three up to 10 %, two up to 25 %; loss: lost frames of the last 5 s;
rtt: round trip to the vehicle; sent: demands per second; cmd: age of the demand that the motors obey;
key→motor: time from a changed demand to the vehicle that applies it; tty: round trip to this terminal;
pre-arm: the vehicle's checks before arming; gps: fix and satellites; batt: voltage and charge

size: 80x24 and more; below that a strip with what a driver must see; below 40x10 keys neither drive nor arm.

key release: terminals with the kitty keyboard protocol report it, and driving ends with the key.
In others, and inside tmux, driving ends when the key has stopped repeating; the screen shows the time.
With that protocol a Cyrillic or Greek keyboard drives by the position of its keys; elsewhere choose a Latin layout.

exit codes: 0 after a session, 1 if the station crashed, 2 for wrong arguments, 128 + n after signal n
"""


class UsageError(Exception):
    """A mistake on the command line; the message is one line for the user."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the ground station. Returns 0 after a session, 2 for wrong arguments, 1 when the station crashed.

    A verb returns a code of groundstation/verbs/exit_codes.py.
    """
    stdio.ensure_open()
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments and arguments[0] in VERB_HELP:
        from groundstation.verbs.main import run as run_verb  # loads the dialect, which the screen does without

        return run_verb(arguments)
    parser, names = _parser()
    options, unknown = parser.parse_known_args(parser.reject_empty(arguments))
    if unknown:
        parser.error(describe_unknown(unknown, names))
    try:
        return _run(options, names)
    except (UsageError, EndpointError, KeymapError, StationError) as error:
        print(f"groundstation: {error}", file=sys.stderr)
        return 2


def _run(options: argparse.Namespace, names: Sequence[str]) -> int:
    keymap = load_keymap(options.keys)
    endpoints = options.endpoints or ([] if options.sitl else [DEFAULT_ENDPOINT])
    for endpoint in endpoints:
        _check_endpoint(endpoint, names)
    _check_terminal()
    log_file = _log_file(options.log_file)
    client = StationClient.start(
        endpoints,
        system=options.system,
        style=options.style,
        speed=options.speed,
        sitl=options.sitl,
        log_file=log_file,
        param_docs=_docs_file(options.param_docs),
        terminal=_terminal_path(),
        meanwhile=_import_screen,
    )
    try:
        from groundstation.ui.run import run

        ascii_only = needs_ascii() if options.ascii is None else options.ascii
        return run(client, keymap=keymap, log_file=log_file, ascii_only=ascii_only)
    finally:
        client.close()
        report_armed(client.left_armed)


def _import_screen() -> None:
    """Import the screen, which takes 0.2 s: after the arguments are checked, and while the station starts."""
    import groundstation.ui.run  # noqa: F401


def report_armed(lines: Sequence[str]) -> None:
    """Print which vehicles are left armed; the terminal may be closed."""
    with contextlib.suppress(OSError):
        for line in lines:
            print(f"groundstation: {line}", file=sys.stderr, flush=True)


def _check_endpoint(text: str, names: Sequence[str]) -> None:
    if f"--{text}" in names:
        raise UsageError(f"{text!r} is not an endpoint: did you mean --{text}?")
    if ":" not in text and "/" not in text:
        raise UsageError(f"{text!r} is not an endpoint such as {DEFAULT_ENDPOINT} (groundstation --help lists them)")
    parse_endpoint(text)


def _check_terminal() -> None:
    if os.environ.get("TERM") == "dumb":
        raise UsageError(
            "TERM=dumb cannot place text on the screen: run groundstation in a terminal such as xterm or tmux"
        )
    for name, stream in (("input", sys.stdin), ("output", sys.stdout)):
        if stream is None or not stream.isatty():
            raise UsageError(
                f"standard {name} is not a terminal: run groundstation in one, without a pipe or redirection"
            )
    columns, rows = shutil.get_terminal_size()
    least_columns, least_rows = MIN_TERMINAL_SIZE
    if columns < least_columns or rows < least_rows:
        raise UsageError(
            f"the terminal is {columns}x{rows}: make it at least {least_columns}x{least_rows}, better 80x24"
        )


def _terminal_path() -> str | None:
    """Return the path of the terminal; None where it has none, as in some containers."""
    try:
        return os.ttyname(sys.stdout.fileno())
    except OSError:
        return None


def _log_file(requested: Path | None) -> Path | None:
    """Return the requested log file, or the default one, or None if the default cannot be written.

    Raises UsageError if the requested file cannot be written.
    """
    path = requested or user_log_path("mavhelm") / "groundstation.log"
    try:
        if requested is None:
            path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_fifo():
            raise OSError(errno.EINVAL, "a pipe; name a file")  # opening it would block until a reader comes
        with path.open("a", encoding="utf-8"):
            return path.absolute()
    except OSError as error:
        if requested is None:
            return None
        raise UsageError(f"log file {path}: {error.strerror}") from error


def _docs_file(requested: Path | None) -> Path | None:
    """Return the file with texts of parameters. Raises UsageError if it cannot be read."""
    if requested is None:
        return None
    try:
        with requested.open("rb"):
            return requested.absolute()
    except OSError as error:
        raise UsageError(f"--param-docs {requested}: {error.strerror}") from error


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


class _Version(argparse.Action):
    """Prints the version. Looking it up takes 30 ms, so only here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the version and exit."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('mavhelm')}")
        parser.exit()


def _parser() -> tuple[CommandLineParser, list[str]]:
    """Return the parser and the names of all options."""
    parser = CommandLineParser(
        prog="groundstation",
        description="Drive a MAVLink rover from the terminal.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    actions = (
        add("endpoints", nargs="*", metavar="ENDPOINT", help=f"where vehicles are (default: {DEFAULT_ENDPOINT})"),
        add("--sitl", action="store_true", help="start a simulated rover, and end it with the ground station"),
        add("--keys", default="standard", metavar="NAME|FILE", help=f"key map: {', '.join(KEYMAPS)} or a TOML file"),
        add("--style", choices=[style.value for style in Style], default=Style.HOLD.value,
            help="hold: drive while a key is held (default); latch: until the next key; step: 10 %% a press"),
        add("--speed", type=_speed, default=0.6, metavar="FRACTION",
            help="limit of the sticks, 0.1 to 1 (default: 0.6)"),
        add("--system", type=_system_id, default=255, metavar="ID", help="our MAVLink system id (default: 255)"),
        add("--log-file", type=Path, metavar="FILE", help=f"default: {user_log_path('mavhelm') / 'groundstation.log'}"),
        add("--param-docs", type=Path, metavar="FILE",
            help="texts of parameters: apm.pdef.xml, apm.pdef.json or PX4's parameters.json "
            "(default: these in the configuration folder)"),
        add("--ascii", action=argparse.BooleanOptionalAction, default=None,
            help="draw with ASCII characters only (default: where the locale is not UTF-8, and with TERM=linux)"),
        add("--version", action=_Version, nargs=0, help="show the version and exit"),
    )  # fmt: skip
    return parser, ["--help", *(name for action in actions for name in action.option_strings)]


if __name__ == "__main__":
    raise SystemExit(main())
