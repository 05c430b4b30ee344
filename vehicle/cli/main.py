"""The command line of the vehicle: words in, Settings out. It only reads and refuses; vehicle/runtime/daemon.py does the work."""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from link.runtime import stdio
from link.runtime.command_line import CommandLineParser
from vehicle.cli import subcommands
from vehicle.cli.options import GROUND_STATION, USAGE, build_parser, find_unknown_option, join_home_option

if TYPE_CHECKING:
    from vehicle.config.config import Config
    from vehicle.config.run_settings import RunSettings

# The daemon, its loop and the dialect are imported when there is something to run: --help and a mistake answer at once.

SIMULATION_PARAMS = {"FS_LOOP_TIMEOUT": 1.0}
"""A desktop is no real-time machine: a pause of 0.2 s, which a vehicle on wheels must not ignore, only annoys here."""

SIMULATION_ONLY = ("home", "sim_battery", "sim_seed", "sim_truth")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the vehicle; the exit code."""
    stdio.ensure_open()
    words = list(sys.argv[1:] if argv is None else argv)
    if not words:
        sys.stderr.write(USAGE)
        return 2
    if words[0] in subcommands.SUBCOMMANDS:
        return subcommands.run(words)
    try:
        parser = build_parser()
        if unknown := find_unknown_option(words):
            parser.error(unknown)
        return _run(parser.parse_intermixed_args(join_home_option(parser.reject_empty(words))), parser)
    except KeyboardInterrupt:  # before the daemon takes signals; no motor is open yet
        return 0


def _run(asked: argparse.Namespace, parser: CommandLineParser) -> int:
    from vehicle.runtime import daemon
    from vehicle.runtime.log import DaemonLog

    config = _config(asked, parser)
    settings = _settings(asked, config, parser)
    verbose = asked.verbose or config.log.verbose
    problem = None
    try:
        log = DaemonLog(asked.log_file or config.log.file, verbose=verbose)
    except OSError as error:
        if asked.log_file:
            parser.error(f"log file {asked.log_file}: {error.strerror}")
        log, problem = (
            DaemonLog(verbose=verbose),
            error.strerror,
        )  # a card that is read-only keeps no service from driving
    try:
        if problem:
            logging.getLogger(__name__).warning("log.file %s: %s; going on without it", config.log.file, problem)
        return daemon.run(settings)
    finally:
        log.close()


def _config(asked: argparse.Namespace, parser: CommandLineParser) -> Config:
    """What the file says, with the options of the command line in its place."""
    from msgspec.structs import replace

    from vehicle.config.config import Config, ConfigError, Identity, load

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


def _settings(asked: argparse.Namespace, config: Config, parser: CommandLineParser) -> RunSettings:
    from vehicle.config.run_settings import RunSettings, Simulation
    from vehicle.sim.body import SimulatedHome

    _refuse_contradictions(asked, config, parser)
    simulation = Simulation(
        home=SimulatedHome(*asked.home) if asked.home else SimulatedHome(),
        battery=1.0 if asked.sim_battery is None else asked.sim_battery,
        seed=1 if asked.sim_seed is None else asked.sim_seed,
        truth=asked.sim_truth,
    )
    pinned = dict(config.params)
    if config.identity.system is not None:
        pinned["MAV_SYSID"] = config.identity.system
    return RunSettings(
        endpoints=config.endpoints,
        motors=config.motors,
        accessories=config.accessories,
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
    from vehicle.storage.motor_copy import default_state_folder

    return default_state_folder()


def _logs(asked: argparse.Namespace, config: Config) -> Path | None:
    """Where drives are recorded. A simulation records nothing, unless it is told where."""
    folder = asked.tlog or (None if asked.sim else config.log.tlog)
    if folder:
        return Path(folder)
    from vehicle.storage.recorder import LOGS

    state = _state(asked, config)
    return None if state is None else state / LOGS


def _refuse_contradictions(asked: argparse.Namespace, config: Config, parser: CommandLineParser) -> None:
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
