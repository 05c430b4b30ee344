"""The options of `vehicle`: the table of options, their types and the text of --help.

To add an option, add a row to OPTIONS (or SIMULATION_OPTIONS) and use its value in vehicle/cli/main.py.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from typing import Any

from link.endpoint import EndpointError, endpoint_help, parse_endpoint
from link.runtime.command_line import CommandLineParser
from link.transport.faults.settings import CUT_AFTER
from vehicle.cli import subcommands
from vehicle.motors.drivers import DRIVERS
from vehicle.params import PARAMETERS, ParamError, Params, suggest_parameter

GROUND_STATION = "udpout:127.0.0.1:14550"
"""The default link, to a ground station on this machine: 14550 is the usual port."""

USAGE = """\
usage: mavhelm vehicle --sim [ENDPOINT ...]         a simulated rover, for a ground station on this machine
       mavhelm vehicle --config rover.toml          a rover with motors, as configured in the file
       mavhelm vehicle ENDPOINT ... --motors NAME   the same without a file, for drivers that need no settings
       mavhelm vehicle --help                       all options, with examples
"""

EXAMPLES = """\
examples:
  mavhelm vehicle --sim                            simulated rover; open `mavhelm` beside it
  mavhelm vehicle --sim udpout:192.168.1.20:14550  ... for a ground station on another machine
  mavhelm vehicle --sim --param SPEED_MAX=3 --param DRIVE_TYPE=2   ... a faster one that steers like a car
  mavhelm vehicle --sim --loss 20 --delay 200 --jitter 50 --cut 3  ... over a bad network: docs/simulator.md
  mavhelm vehicle --sim --param DRIVE_TYPE=4       ... one with mecanum wheels (3: omni), that also moves sideways
  mavhelm vehicle --sim --camera                   ... with a camera that sees a drawn world: docs/camera.md
  mavhelm vehicle init                             write rover.toml, with every setting and its description
  mavhelm vehicle check                            check rover.toml and the hardware; nothing moves
  mavhelm vehicle doctor                           the same with permissions, ports, power, clock, disk and service
  mavhelm vehicle --config rover.toml              run with this file; options take precedence over it
  mavhelm vehicle udpin:0.0.0.0:14550 --motors my_car:Motors       use your own motor driver

subcommands, each with its own --help:
{subcommands}

endpoints:
{endpoints}

motor drivers (--motors):
{drivers}
  MODULE:CLASS   a driver of your own

exit codes: 0 requested stop (SIGTERM, Ctrl-C, SIGHUP), 1 a fault, also a link that cannot be opened, 2 an error on the
command line or in the file, 7 `mavhelm vehicle doctor` found a fault, 80 to 82 a ground station requested a restart of
this program, a reboot of the computer, or its shutdown (REBOOT_ENABLE, docs/pi.md).
Before the program ends for any reason, the motors are set to neutral and disabled.
"""


def _driver_lines() -> str:
    return "\n".join(f"  {name:<14} {entry.title}" for name, entry in DRIVERS.items())


class _Version(argparse.Action):
    """Shows the version. Its import takes longer than the rest of the parser, so it is done only here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            sys.stdout.write(f"mavhelm vehicle {version('mavhelm')}\n")
        except PackageNotFoundError:
            sys.stdout.write("mavhelm vehicle, not installed: run from source\n")
        parser.exit()


def build_parser() -> CommandLineParser:
    """Return the parser of `vehicle` without a subcommand."""
    parser = CommandLineParser(
        prog="mavhelm vehicle",
        usage=USAGE.removeprefix("usage: ").rstrip(),
        description="The rover daemon: controlled by one ground station over MAVLink, it drives the motors safely.",
        epilog=EXAMPLES.format(
            endpoints=endpoint_help(), drivers=_driver_lines(), subcommands=subcommands.help_lines()
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    for name, option in (OPTIONS | SIMULATION_OPTIONS).items():
        parser.add_argument(name, **option)
    return parser


def join_home_option(arguments: list[str]) -> list[str]:
    """Join --home and its value with "=": argparse would parse a southern latitude as an option otherwise."""
    if "--home" not in arguments[:-1]:
        return arguments
    at = arguments.index("--home")
    return [*arguments[:at], f"--home={arguments[at + 1]}", *arguments[at + 2 :]]


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
        raise argparse.ArgumentTypeError(f"unknown parameter {name!r}; {suggest_parameter(name)}")
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


def _between(least: float, most: float, what: str) -> Callable[[str], float]:
    """Return a type of argparse: a number in this range, `what` in its message."""

    def parse(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not least <= number <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is not {what} from {least:g} to {most:g}")
        return number

    return parse


OPTIONS: dict[str, dict[str, Any]] = {
    "endpoints": {"nargs": "*", "metavar": "ENDPOINT", "type": _endpoint,
                  "help": f"link to ground stations; with --sim {GROUND_STATION} by default"},
    "--config": {"metavar": "FILE", "help": "configuration file; `mavhelm vehicle init` writes a template"},
    "--sim": {"action": "store_true", "help": "simulate motors, chassis, battery and sensors"},
    "--motors": {"metavar": "NAME", "help": "motor driver"},
    "--announce": {"action": "store_true",
                   "help": "announce endpoints that listen on the network (mDNS); needs the extra [discovery]"},
    "--allow-unsigned": {"action": "store_true",
                         "help": "let everybody in the network drive who has no key; see docs/security.md"},
    "--system": {"metavar": "N", "type": _system, "help": "MAVLink system id, 1 to 255 (default 1)"},
    "--param": {"metavar": "NAME=VALUE", "type": _param, "action": "append", "default": [],
                "help": "set a parameter; repeatable"},
    "--state": {"metavar": "FOLDER", "help": "save parameters and plans there; without it a simulation saves none"},
    "--tlog": {"metavar": "FOLDER", "help": "record each drive there (default: logs in the folder of --state)"},
    "--motor-log": {"metavar": "FILE", "help": "append each change of the motors: CLOCK_MONOTONIC ns, throttles"},
    "--log-file": {"metavar": "FILE",
                   "help": "append the log with times and tracebacks; stderr has the brief one. At 10 MB it becomes "
                   "FILE.1, and a new one begins"},
    "--verbose": {"action": "store_true", "help": "log more details"},
    "--version": {"action": _Version, "nargs": 0, "help": "show the version and exit"},
}  # fmt: skip
"""Name -> arguments of argparse, in the order of --help."""

SIMULATION_OPTIONS: dict[str, dict[str, Any]] = {
    "--home": {"metavar": "LAT,LON", "type": _home, "help": "start of the simulated rover, degrees"},
    "--sim-battery": {"metavar": "CHARGE", "type": _charge, "help": "charge of its battery, 0 to 1 (default 1)"},
    "--sim-seed": {"metavar": "N", "type": int, "help": "seed of noise, --loss and --jitter (default 1)"},
    "--sim-truth": {"metavar": "FILE",
                    "help": "append its true position and speed: CLOCK_MONOTONIC ns, m, m, rad, m/s; with --walls "
                    "also the m to the nearest one, 0 in contact"},
    "--walls": {"metavar": "FILE", "help": "walls around it (GeoJSON), and a sensor that sees them"},
    "--camera": {"action": "store_true", "default": None,
                 "help": "stream what it would see, as a camera does, while a ground station watches; needs ffmpeg"},
    "--loss": {"metavar": "PERCENT", "type": _between(0, 100, "a loss in percent"),
               "help": "lose so many of the frames of its links, each way"},
    "--delay": {"metavar": "MS", "type": _between(0, 60_000, "a delay in ms"), "help": "deliver frames late, each way"},
    "--jitter": {"metavar": "MS", "type": _between(0, 60_000, "a jitter in ms"),
                 "help": "vary the delay by up to this, up and down; frames stay in order"},
    "--cut": {"metavar": "S", "type": _between(0.1, 3600, "a time in s"),
              "help": f"cut its links for S seconds each time the wheels have turned for {CUT_AFTER:g} s"},
}  # fmt: skip
"""Options for --sim only, as OPTIONS."""
