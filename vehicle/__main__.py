"""The command line of the vehicle: words in, Settings out. It only reads and refuses; daemon.py does the work."""

from __future__ import annotations

import argparse
import difflib
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from link.endpoint import EndpointError, endpoint_help, parse
from vehicle import verbs
from vehicle.motors import DRIVERS
from vehicle.params import PARAMETERS, ParamError, Params

if TYPE_CHECKING:
    from vehicle.config import Config
    from vehicle.daemon import Settings

# The daemon, its loop and the dialect are imported when there is something to run: --help and a mistake answer at once.

GROUND_STATION = "udpout:127.0.0.1:14550"
"""Where a ground station on this machine waits: 14550 is the port they all use."""

SIMULATION_PARAMS = {"FS_LOOP_TIMEOUT": 1.0}
"""A desktop is no real-time machine: a pause of 0.2 s, which a vehicle on wheels must not ignore, only annoys here."""

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
  {drivers}, or your own as MODULE:CLASS

exit codes: 0 asked to stop (SIGTERM, Ctrl-C, SIGHUP), 1 a fault, 2 a mistake on the command line, 80 to 82 a ground
station asked for a restart of this program, of the computer, or to shut it down (REBOOT_ENABLE, docs/pi.md).
Whatever ends it, the motors are neutral and without power first.
"""

SIMULATION_ONLY = ("home", "sim_battery", "sim_seed", "sim_truth")


class _Parser(argparse.ArgumentParser):
    """Says a mistake in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"vehicle: {message} (vehicle --help shows how)\n")


class _Version(argparse.Action):
    """Looks the version up only when asked: that import costs more than the rest of the parser."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"vehicle (mavhelm) {version('mavhelm')}")
        except PackageNotFoundError:
            print("vehicle (mavhelm), not installed: run from its source")
        parser.exit()


def main(argv: Sequence[str] | None = None) -> int:
    """Run the vehicle; the exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if not words:
        sys.stderr.write(USAGE)
        return 2
    if words[0] in verbs.VERBS:
        return verbs.run(words)
    try:
        parser = _parser()
        return _run(parser.parse_intermixed_args(_joined(words)), parser)
    except KeyboardInterrupt:  # before the daemon takes signals; no motor is open yet
        return 0


def _run(asked: argparse.Namespace, parser: _Parser) -> int:
    from vehicle import daemon
    from vehicle.log import Log

    config = _config(asked, parser)
    settings = _settings(asked, config, parser)
    path = asked.log_file or config.log.file
    try:
        log = Log(path, verbose=asked.verbose or config.log.verbose)
    except OSError as error:
        parser.error(f"log file {path}: {error.strerror}")
    try:
        return daemon.run(settings)
    finally:
        log.close()


def _config(asked: argparse.Namespace, parser: _Parser) -> Config:
    """What the file says, with the options of the command line in its place."""
    from msgspec.structs import replace

    from vehicle.config import Config, ConfigError, Identity, load

    try:
        config = Config() if asked.config is None else load(asked.config)
    except ConfigError as error:
        parser.exit(2, f"vehicle: {error}\n")
    if asked.motors:
        config = replace(config, motors={"driver": asked.motors})
    if asked.system is not None:
        params = {name: value for name, value in config.params.items() if name != "MAV_SYSID"}
        config = replace(config, identity=Identity(asked.system), params=params)
    default = (GROUND_STATION,) if asked.sim else ()
    return replace(config, endpoints=tuple(asked.endpoints) or config.endpoints or default)


def _settings(asked: argparse.Namespace, config: Config, parser: _Parser) -> Settings:
    from vehicle import daemon
    from vehicle.sim.body import Home

    _refuse_contradictions(asked, config, parser)
    simulation = daemon.Simulation(
        home=Home(*asked.home) if asked.home else Home(),
        battery=1.0 if asked.sim_battery is None else asked.sim_battery,
        seed=1 if asked.sim_seed is None else asked.sim_seed,
        truth=asked.sim_truth,
    )
    pinned = dict(config.params)
    if config.identity.system is not None:
        pinned["MAV_SYSID"] = config.identity.system
    return daemon.Settings(
        endpoints=config.endpoints,
        motors=config.motors,
        config=Path(asked.config) if asked.config else None,
        sensors=config.sensors,
        simulation=simulation if asked.sim else None,
        pinned=pinned,
        params={**(SIMULATION_PARAMS if asked.sim else {}), **dict(asked.param)},
        motor_log=asked.motor_log or config.log.motors,
        state=_state(asked, config),
        logs=_logs(asked, config),
    )


def _state(asked: argparse.Namespace, config: Config) -> Path | None:
    """Where parameters are kept. A simulation keeps nothing, unless it is told where."""
    if asked.state or asked.sim:
        return Path(asked.state) if asked.state else None
    if config.state:
        return Path(config.state)
    from vehicle.motor_copy import usual_state

    return usual_state()


def _logs(asked: argparse.Namespace, config: Config) -> Path | None:
    """Where drives are recorded. A simulation records nothing, unless it is told where."""
    folder = asked.tlog or (None if asked.sim else config.log.tlog)
    if folder:
        return Path(folder)
    state = _state(asked, config)
    return None if state is None else state / "logs"


def _refuse_contradictions(asked: argparse.Namespace, config: Config, parser: _Parser) -> None:
    if asked.sim and asked.motors:
        parser.error("--sim brings its own motors: leave out --motors, or leave out --sim")
    if asked.sim:
        return
    if not config.motors:
        parser.error("no motors: --config FILE or --motors NAME for real ones, or --sim for a simulated rover")
    if not config.endpoints:
        parser.error(f"no endpoint: where is the ground station? For example {GROUND_STATION}")
    for name in SIMULATION_ONLY:
        if getattr(asked, name) is not None:
            parser.error(f"--{name.replace('_', '-')} is for --sim only")


def _parser() -> _Parser:
    parser = _Parser(
        prog="vehicle",
        usage=USAGE.removeprefix("usage: ").rstrip(),
        description="The rover daemon: obeys one ground station over MAVLink and drives the motors, safely.",
        epilog=EXAMPLES.format(endpoints=endpoint_help(), drivers=", ".join(DRIVERS), verbs=verbs.help_lines()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    for name, options in OPTIONS.items():
        parser.add_argument(name, **options)
    return parser


def _joined(words: list[str]) -> list[str]:
    """argparse takes a southern latitude after --home for an option; joined by "=" it does not."""
    if "--home" not in words[:-1]:
        return words
    at = words.index("--home")
    return [*words[:at], f"--home={words[at + 1]}", *words[at + 2 :]]


def _endpoint(text: str) -> str:
    try:
        return parse(text).text
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


if __name__ == "__main__":
    sys.exit(main())
