"""The options of the vehicle: what each takes, and what --help says of it. What they mean together is __main__'s."""

from __future__ import annotations

import argparse
import difflib
import math
import sys
from collections.abc import Sequence
from typing import Any

from link.endpoint import EndpointError, endpoint_help, parse_endpoint
from link.runtime.command_line import CommandLineParser
from vehicle.cli import subcommands
from vehicle.motors.drivers import DRIVERS
from vehicle.params import PARAMETERS, ParamError, Params

GROUND_STATION = "udpout:127.0.0.1:14550"
"""Where a ground station on this machine waits: 14550 is the port they all use."""

USAGE = """\
usage: vehicle --sim [ENDPOINT ...]             a simulated rover, for a ground station on this machine
       vehicle --config rover.toml              a rover with motors, as the file says
       vehicle ENDPOINT ... --motors NAME       the same without a file, for drivers that need no settings
       vehicle --help                           all options, with examples
"""

EXAMPLES = """\
examples:
  vehicle --sim                                  simulated rover; open `groundstation` beside it
  vehicle --sim udpout:192.168.1.20:14550        ... for a ground station on another machine
  vehicle --sim --param SPEED_MAX=3 --param DRIVE_TYPE=2     ... a faster one that steers like a car
  vehicle --sim --param DRIVE_TYPE=4             ... one with mecanum wheels (3: omni), that also moves sideways
  vehicle init                                   write rover.toml, with every setting and what it does
  vehicle check                                  is it right, and does the hardware answer? Nothing moves
  vehicle --config rover.toml                    run with it; options here win over the file
  vehicle udpin:0.0.0.0:14550 --motors my_car:Motors         your own class drives the motors

more words, each with its own --help:
{verbs}

endpoints:
{endpoints}

motor drivers (--motors):
{drivers}
  MODULE:CLASS   a driver of your own

exit codes: 0 asked to stop (SIGTERM, Ctrl-C, SIGHUP), 1 a fault, also a link that cannot be had, 2 a mistake on the
command line or in the file, 80 to 82 a ground station asked for a restart of this program, of the computer, or to shut
it down (REBOOT_ENABLE, docs/pi.md).
Whatever ends it, the motors are neutral and without power first.
"""


def _driver_lines() -> str:
    return "\n".join(f"  {name:<14} {entry.title}" for name, entry in DRIVERS.items())


class _Version(argparse.Action):
    """Looks the version up only when asked: that import costs more than the rest of the parser."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            sys.stdout.write(f"vehicle (mavhelm) {version('mavhelm')}\n")
        except PackageNotFoundError:
            sys.stdout.write("vehicle (mavhelm), not installed: run from its source\n")
        parser.exit()


def build_parser() -> CommandLineParser:
    parser = CommandLineParser(
        prog="vehicle",
        usage=USAGE.removeprefix("usage: ").rstrip(),
        description="The rover daemon: obeys one ground station over MAVLink and drives the motors, safely.",
        epilog=EXAMPLES.format(endpoints=endpoint_help(), drivers=_driver_lines(), verbs=subcommands.help_lines()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    for name, options in OPTIONS.items():
        parser.add_argument(name, **options)
    return parser


def find_unknown_option(words: Sequence[str]) -> str | None:
    """Words on the first option that there is not; argparse would take its value for an endpoint and name that."""
    known = [*OPTIONS, "--help"]
    for word in words:
        name = word.partition("=")[0]
        if name.startswith("--") and name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            return f"unknown option {name}" + (f"; did you mean {near[0]}?" if near else "")
    return None


def join_home_option(words: list[str]) -> list[str]:
    """Argparse takes a southern latitude after --home for an option; joined by "=" it does not."""
    if "--home" not in words[:-1]:
        return words
    at = words.index("--home")
    return [*words[:at], f"--home={words[at + 1]}", *words[at + 2 :]]


def _endpoint(text: str) -> str:
    try:
        return parse_endpoint(text).text
    except EndpointError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _system(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= 255):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 255")
    return int(text)


def _param(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    name = name.strip().upper()
    if name not in PARAMETERS:
        near = difflib.get_close_matches(name, PARAMETERS, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(PARAMETERS)}"
        raise argparse.ArgumentTypeError(f"unknown parameter {name!r}; {hint}")
    try:
        Params({name: float(value)})
    except ParamError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    except ValueError:
        raise argparse.ArgumentTypeError(f"{name}: {value!r} is not a number; write {name}=VALUE") from None
    return name, float(value)


def _home(text: str) -> tuple[float, float]:
    try:
        latitude, longitude = (float(part) for part in text.split(","))
    except ValueError:
        latitude = math.nan
        longitude = math.nan
    if not (abs(latitude) < 90 and abs(longitude) <= 180):
        raise argparse.ArgumentTypeError(f"{text!r} is not LAT,LON in degrees, for example 52.5163,13.3777")
    return latitude, longitude


def _charge(text: str) -> float:
    try:
        charge = float(text)
    except ValueError:
        charge = math.nan
    if not 0.0 <= charge <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a charge from 0 to 1")
    return charge


OPTIONS: dict[str, dict[str, Any]] = {
    "endpoints": {"nargs": "*", "metavar": "ENDPOINT", "type": _endpoint,
                  "help": f"link to ground stations; with --sim {GROUND_STATION} by default"},
    "--config": {"metavar": "FILE", "help": "file of settings; `vehicle init` writes one"},
    "--sim": {"action": "store_true", "help": "simulate motors, chassis, battery and sensors"},
    "--motors": {"metavar": "NAME", "help": "motor driver"},
    "--system": {"metavar": "N", "type": _system, "help": "MAVLink system id, 1 to 255 (default 1)"},
    "--param": {"metavar": "NAME=VALUE", "type": _param, "action": "append", "default": [],
                "help": "set a parameter; repeatable"},
    "--state": {"metavar": "FOLDER", "help": "keep parameters and plans there; a simulation keeps none otherwise"},
    "--tlog": {"metavar": "FOLDER", "help": "record each drive there (default: logs in the folder of --state)"},
    "--motor-log": {"metavar": "FILE", "help": "append each change of the motors: CLOCK_MONOTONIC ns, throttles"},
    "--log-file": {"metavar": "FILE", "help": "append the log with times and tracebacks; stderr has the brief one"},
    "--verbose": {"action": "store_true", "help": "log more"},
    "--home": {"metavar": "LAT,LON", "type": _home, "help": "where the simulated rover starts, degrees"},
    "--sim-battery": {"metavar": "CHARGE", "type": _charge, "help": "its charge, 0 to 1 (default 1)"},
    "--sim-seed": {"metavar": "N", "type": int, "help": "of the noise of its sensors (default 1)"},
    "--sim-truth": {"metavar": "FILE", "help": "append where it really is: CLOCK_MONOTONIC ns, m, m, rad, m/s"},
    "--version": {"action": _Version, "nargs": 0, "help": "show the version and end"},
}  # fmt: skip
"""Every option, in the order of --help."""
