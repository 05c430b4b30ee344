"""The command line of the vehicle: turns options and configuration file into RunSettings for the daemon."""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from link.endpoint import ZENOH, parse_endpoint
from link.runtime import startup_gc, stdio, without_openssl
from link.runtime.command_line import CommandLineParser
from vehicle.cli import subcommands
from vehicle.cli.options import (
    GROUND_STATION,
    SIMULATION_OPTIONS,
    USAGE,
    build_parser,
    join_home_option,
)

if TYPE_CHECKING:
    from link.transport.faults.settings import FaultSettings
    from vehicle.camera.settings import CameraSettings
    from vehicle.config.config import Config
    from vehicle.config.run_settings import RunSettings

# The daemon, its loop and the dialect are imported only to run: --help and usage errors respond at once.


def main(argv: Sequence[str] | None = None) -> int:
    """Run the vehicle or a subcommand and return the exit code."""
    stdio.ensure_open()
    return stdio.run_program("mavhelm vehicle", lambda: _run_arguments(list(sys.argv[1:] if argv is None else argv)))


def _run_arguments(arguments: list[str]) -> int:
    if not arguments:
        sys.stderr.write(USAGE)
        return 2
    if arguments[0] in subcommands.SUBCOMMANDS:
        return subcommands.run(arguments)
    try:
        parser = build_parser()
        parser.reject_unknown_options(arguments)
        parser.reject_unknown_word(arguments, subcommands.SUBCOMMANDS)
        options = parser.parse_intermixed_args(join_home_option(parser.reject_empty(arguments)))
        with startup_gc.paused():
            return _run(options, parser)
    except KeyboardInterrupt:  # before the daemon handles signals; no motor is open yet
        return 0


def _run(options: argparse.Namespace, parser: CommandLineParser) -> int:
    without_openssl.load()
    from vehicle.runtime import daemon
    from vehicle.runtime.log import DaemonLog

    config = _load_config(options, parser)
    settings = _build_settings(options, config, parser)
    verbose = options.verbose or config.log.verbose
    problem = None
    try:
        log = DaemonLog(options.log_file or config.log.file, verbose=verbose)
    except OSError as error:
        if options.log_file:
            parser.error(f"log file {options.log_file}: {error.strerror}")
        log, problem = DaemonLog(verbose=verbose), error.strerror  # a read-only card must not stop a service
    try:
        if problem:
            logging.getLogger(__name__).warning("log.file %s: %s; continuing without it", config.log.file, problem)
        if unused := _unused_keys(options):
            logging.getLogger(__name__).warning(
                "keys in %s are not used: a simulation without --state has none", unused
            )
        return daemon.run(settings)
    finally:
        log.close()


def _load_config(options: argparse.Namespace, parser: CommandLineParser) -> Config:
    """Load the configuration file and apply the options of the command line, which take precedence."""
    from msgspec.structs import replace

    from vehicle.config.config import Config, Identity, RoverConfigError, load

    try:
        config = Config() if options.config is None else load(options.config)
    except RoverConfigError as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    if options.motors:
        config = replace(config, motors={"driver": options.motors})
    if options.system is not None:
        params = {name: value for name, value in config.params.items() if name != "MAV_SYSID"}
        config = replace(config, identity=Identity(options.system), params=params)
    if options.allow_unsigned:
        if config.signing.required:
            parser.error("--allow-unsigned contradicts signing.required of the configuration file")
        config = replace(config, signing=replace(config.signing, allow_unsigned=True))
    default = (GROUND_STATION,) if options.sim else ()
    return replace(config, endpoints=tuple(options.endpoints) or config.endpoints or default)


def _build_settings(options: argparse.Namespace, config: Config, parser: CommandLineParser) -> RunSettings:
    from vehicle.config.run_settings import SIMULATION_PARAMS, RunSettings, Simulation
    from vehicle.sim.body import SimulatedHome

    _reject_conflicts(options, config, parser)
    simulation = Simulation(
        home=SimulatedHome(*options.home) if options.home else SimulatedHome(),
        battery=1.0 if options.sim_battery is None else options.sim_battery,
        seed=1 if options.sim_seed is None else options.sim_seed,
        truth=options.sim_truth,
        walls=options.walls,
        faults=_build_faults(options, config, parser),
    )
    pinned = dict(config.params)
    if config.identity.system is not None:
        pinned["MAV_SYSID"] = config.identity.system
    return RunSettings(
        endpoints=config.endpoints,
        motors=config.motors,
        accessories=config.accessories,
        config=Path(options.config) if options.config else None,
        sensors=config.sensors,
        simulation=simulation if options.sim else None,
        camera=_choose_camera(options, config),
        pinned=pinned,
        params={**(SIMULATION_PARAMS if options.sim else {}), **dict(options.param)},
        motor_log=options.motor_log or config.log.motors,
        state=_state_folder(options, config),
        logs=_log_folder(options, config),
        signing=config.signing,
        announce=options.announce or config.announce,
    )


def _choose_camera(options: argparse.Namespace, config: Config) -> CameraSettings:
    """Return the camera of the file; of a simulation the drawn one, if --camera asks for it."""
    from vehicle.camera.settings import SIMULATED_CAMERA, CameraSettings

    if options.sim:
        return SIMULATED_CAMERA if options.camera else CameraSettings()
    return config.camera


def _build_faults(options: argparse.Namespace, config: Config, parser: CommandLineParser) -> FaultSettings | None:
    """Return the faults that --loss, --delay, --jitter and --cut ask for; None without any of them."""
    from link.transport.faults.settings import FaultSettings

    if all(each is None for each in (options.loss, options.delay, options.jitter, options.cut)):
        return None
    for text in config.endpoints:
        if parse_endpoint(text).scheme == ZENOH:
            parser.error(f"--loss, --delay, --jitter and --cut do not work on {text}: use udp, tcp or serial")
    return FaultSettings(
        loss=(options.loss or 0.0) / 100,
        delay=(options.delay or 0.0) / 1000,
        jitter=(options.jitter or 0.0) / 1000,
        cut=options.cut or 0.0,
        seed=1 if options.sim_seed is None else options.sim_seed,
    )


def _state_folder(options: argparse.Namespace, config: Config) -> Path | None:
    """Return the state folder; None for a simulation without --state, which saves nothing."""
    if options.state or options.sim:
        return Path(options.state) if options.state else None
    if config.state:
        return Path(config.state)
    from vehicle.storage.motor_copy import default_state_folder

    return default_state_folder()


def _unused_keys(options: argparse.Namespace) -> Path | None:
    """Return the key file that a simulation without --state leaves alone; None without one."""
    if not options.sim or options.state:
        return None
    from link.signing.key_file import FILE
    from vehicle.storage.motor_copy import default_state_folder

    path = default_state_folder() / FILE
    return path if path.exists() else None


def _log_folder(options: argparse.Namespace, config: Config) -> Path | None:
    """Return the folder of telemetry logs; None for a simulation without --tlog and --state, which records nothing."""
    folder = options.tlog or (None if options.sim else config.log.tlog)
    if folder:
        return Path(folder)
    from vehicle.storage.recorder import LOGS

    state = _state_folder(options, config)
    return None if state is None else state / LOGS


def _reject_conflicts(options: argparse.Namespace, config: Config, parser: CommandLineParser) -> None:
    if options.sim and options.motors:
        parser.error("--sim has its own motors: omit --motors or --sim")
    if options.sim:
        return
    if not config.motors:
        parser.error("no motors: use --config FILE or --motors NAME for real ones, or --sim for a simulated rover")
    if not config.endpoints:
        parser.error(f"no endpoint: add the link to the ground station, for example {GROUND_STATION}")
    for name in SIMULATION_OPTIONS:
        if getattr(options, name.removeprefix("--").replace("-", "_")) is not None:
            parser.error(f"{name} is for --sim only")
