"""The options of `mavhelm`: those of the table of settings, and a few that hold for one run only."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Collection, Mapping
from typing import Any

import msgspec

from groundstation.cli.help_page import HelpPage
from groundstation.config.defaults import DEFAULT_ENDPOINT
from groundstation.config.settings import ROWS, SettingRow, Settings
from groundstation.web.launch import DEFAULT_PORT
from link.endpoint import endpoint_help
from link.runtime.command_line import CommandLineParser

_EPILOG = """\
examples:
  mavhelm --sitl                     start a simulated rover and drive it
  mavhelm --sitl --camera            ... one with a camera; the key f drives by its picture
  mavhelm                            choose what to connect to: vehicles heard, recent endpoints, serial ports
  mavhelm udpin:0.0.0.0:14550        wait for vehicles, from any machine of the network
  mavhelm udpout:192.168.1.20:14550  send first, to a vehicle that listens
  mavhelm --style latch --speed 0.3  a key drives until the next key, slowly
  mavhelm --keys teleop              the keys of teleop_twist_keyboard
  mavhelm --keys my.toml             your own keys; see below
  mavhelm --gamepad any              a gamepad drives as well; docs/gamepad.md
  mavhelm --dialect mine.xml         name the messages of your vehicle's dialect; see below

first drive: hold `r` for a second to arm, hold `i` (or w, or the up arrow) to drive, release to stop;
one press of `r` disarms. Space stops, `!` is the emergency stop on every screen, `?` shows all keys, Ctrl-Q quits.
Keys drive on the Drive screen only. F6 lists all alerts and messages, F3 every MAVLink message,
Ctrl-G goes to the other screens, Escape back.

verbs, which open no screen (mavhelm VERB --help):
{verbs}

endpoints:
{endpoints}

key map file (--keys my.toml): replaces the keys of the actions it names
  base = "standard"            # or "teleop"
  [keys]
  "drive.forward" = ["e", "up"]

dialect file (--dialect mine.xml): MAVLink definitions in XML, read at each start and not compiled. It may include
the definitions that come with pymavlink, such as common.xml; --dialect ardupilotmega.xml names one of them.

status line: link: four bars up to 2 % loss, three up to 10 %, two up to 25 %; loss: lost frames of the last 5 s;
rtt: round trip to the vehicle; sent: demands per second; cmd: age of the newest demand it has taken;
key→motor: time from a changed demand to the vehicle that applies it; tty: round trip to this terminal;
pre-arm: the vehicle's checks before arming; gps: fix and satellites; batt: voltage and charge

size: 80x24 and more; below that a strip with what a driver must see; below 40x10 keys neither drive nor arm.

key release: terminals with the kitty keyboard protocol report it, and driving ends with the key.
In others, and inside tmux, driving ends when the key has stopped repeating; the screen shows the time.
With that protocol a Cyrillic or Greek keyboard drives by the position of its keys; elsewhere choose a Latin layout.

exit codes: 0 after a session, 1 if the station crashed, 2 for wrong arguments, 128 + n after signal n
"""

REPLAY_SETTINGS = ("theme", "ascii", "reduce_motion", "keymap", "log_file", "folder", "dialect", "param_docs")
"""Settings that mean something without a vehicle."""


class _Version(argparse.Action):
    """Prints the version. Looking it up takes 30 ms, so only here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the version and exit."""
        from importlib.metadata import version

        sys.stdout.write(f"{parser.prog} {version('mavhelm')}\n")
        parser.exit()


class _FullHelp(argparse.Action):
    """Prints all options, verbs and endpoints. Loading the tables of verbs takes a while, so only here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the help and exit."""
        parser.epilog = build_epilog()
        parser.print_help()
        parser.exit()


def build_epilog() -> str:
    """Return what follows the options in --help-all."""
    from groundstation.cli.verb_help import verb_help

    return _EPILOG.format(verbs=verb_help(), endpoints=endpoint_help())


def build_parser() -> tuple[CommandLineParser, list[str]]:
    """Return the parser and the names of all options."""
    parser = CommandLineParser(
        prog="mavhelm",
        description="Drive a MAVLink rover from the terminal.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        add_help=False,
    )
    add = parser.add_argument
    actions = [
        add("-h", "--help", action=HelpPage, nargs=0, help="show a page of help and exit"),
        add("--help-all", action=_FullHelp, nargs=0, help="show this help with all options and exit"),
        add("endpoints", nargs="*", metavar="ENDPOINT|NAME",
            help=f"where vehicles are, or a name of the config file (default: {DEFAULT_ENDPOINT})"),
        add("--sitl", action="store_true", help="start a simulated rover, and end it with the ground station"),
        add("--camera", action="store_true",
            help="with --sitl: a rover with a camera, for the key f on Drive; needs ffmpeg"),
        add("--plain", action="store_true",
            help="print lines in place of a screen: what changes, and the vehicle's texts, beside a station that verbs "
            "in other shells go through; takes the options of `mavhelm status --watch`"),
        *add_settings(parser),
        add_config(parser),
        add("--version", action=_Version, nargs=0, help="show the version and exit"),
    ]  # fmt: skip
    return parser, [name for action in actions for name in action.option_strings if name.startswith("--")]


def add_config(parser: argparse.ArgumentParser) -> argparse.Action:
    """Add --config."""
    return parser.add_argument("--config", metavar="FILE", help="config file (`mavhelm config path` prints it)")


def add_port(parser: argparse.ArgumentParser) -> None:
    """Add the option for the port of `--web`."""
    parser.add_argument("--port", type=_port, default=DEFAULT_PORT, help=f"of --web (default: {DEFAULT_PORT})")


def _port(text: str) -> int:
    if not text.isascii() or not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 65535")
    return int(text)


def add_settings(parser: argparse.ArgumentParser, names: Collection[str] = tuple(ROWS)) -> list[argparse.Action]:
    """Add the options of the table of settings, or of some of them. What is not given is None."""
    return [_add_setting(parser, row) for name, row in ROWS.items() if row.option is not None and name in names]


def _add_setting(parser: argparse.ArgumentParser, row: SettingRow) -> argparse.Action:
    assert row.option is not None
    details: dict[str, Any] = {"metavar": row.option.metavar}
    if row.is_switch:
        details = {"action": argparse.BooleanOptionalAction}
    elif row.choices:
        details = {"choices": row.choices}
    else:
        details["type"] = _parse(row)
    return parser.add_argument(row.option.flag, dest=row.name, default=None, help=_help(row), **details)


def _help(row: SettingRow) -> str:
    text = row.help.rstrip(".").replace("%", "%%")
    text = text if text[1].isupper() else text[0].lower() + text[1:]
    allowed = f", {row.allowed}" if row.allowed.startswith("a number") else ""
    return f"{text}{allowed}{f' (default: {row.default_text})' if row.default_text else ''}"


def _parse(row: SettingRow) -> Callable[[str], Any]:
    def parse(text: str) -> Any:
        try:
            return row.convert(text, strict=False)
        except msgspec.ValidationError:
            raise argparse.ArgumentTypeError(row.refuse(text, repr(text))) from None

    return parse


def given_settings(options: argparse.Namespace) -> Mapping[str, Any]:
    """Return the settings that the command line gives."""
    found = {name: getattr(options, name, None) for name, row in ROWS.items() if row.option is not None}
    found["open"] = getattr(options, "endpoints", None) or None
    return {name: value for name, value in found.items() if value is not None}


def option_words(settings: Settings, names: Collection[str]) -> list[str]:
    """Return options that give another run of the program the same settings, as far as they differ from the defaults.

    Keys of the config file are left to that run: --keys would replace them.
    """
    found = {name: getattr(settings, name) for name in names if not (name == "keymap" and settings.keys)}
    changed = {name: value for name, value in found.items() if value != getattr(Settings(), name)}
    return [_option_word(ROWS[name], value) for name, value in changed.items() if value is not None]


def _option_word(row: SettingRow, value: Any) -> str:
    assert row.option is not None
    if row.is_switch:
        return row.option.flag if value else f"--no-{row.option.flag.removeprefix('--')}"
    return f"{row.option.flag}={value}"
