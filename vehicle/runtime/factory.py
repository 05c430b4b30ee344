"""The parts of a vehicle from its settings: parameters, motors, sensors, recorder; simulated or real. No loop."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable
from dataclasses import replace

from msgspec import to_builtins

from dialects.enums import DriveType
from vehicle.accessories.accessory_set import Rack
from vehicle.accessories.output import Output, Pulses
from vehicle.accessories.settings import outputs_of
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.commands.dispatch import COMPONENT
from vehicle.config.conflicts import clashes, motors_among
from vehicle.config.run_settings import Settings, SettingsError, Simulation
from vehicle.control_loop import Machine
from vehicle.drive.mixer import MIXERS
from vehicle.motors import USUAL_PARAMS, Motors, open_motors, proof, stop_input
from vehicle.motors.log import LoggedMotors, MotorLog
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params, in_force
from vehicle.rover import Rover
from vehicle.runtime.lock import MotorLock
from vehicle.sensors import NoSensors, Sensors
from vehicle.sensors.suite import open_sensors
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody
from vehicle.sim.chassis import CHASSIS, Frame
from vehicle.sim.truth import WatchedBody
from vehicle.storage.motor_copy import copied
from vehicle.storage.param_store import ParamStore
from vehicle.storage.recorder import VehicleRecorder

log = logging.getLogger(__name__)

SIMULATED = (
    *(Output("relay", number, SimulatedAccessory) for number in (0, 1)),
    *(Output("servo", number, SimulatedAccessory, pulses=Pulses(1000, 1500, 2000)) for number in (9, 10)),
)
"""Accessories of a simulation that was told of none: so that there are some to try."""


def params_of(settings: Settings, keeper: ParamStore | None) -> Params:
    """Defaults, a known car's, what was kept, the file of settings, this run: the later wins. Raises ParamError."""
    usual = {} if settings.simulation else USUAL_PARAMS.get(settings.motors["driver"], {})
    given, kept = {**settings.pinned, **settings.params}, keeper.values if keeper else {}
    params, left_out = in_force(given, kept=kept, usual=usual, pinned=settings.pinned.keys(), run=settings.params)
    for problem in left_out:
        log.warning("a kept parameter is not used: %s", problem)
    params.damage = keeper.damage if keeper else None
    if params.damage:
        consequence = "all parameters that were set have their defaults, and nobody can arm until one is set"
        log.warning("%s: %s: %s", settings.state, params.damage, consequence)
    return params


def rack_of(settings: Settings, params: Params) -> Rack:
    """The accessories, not open yet. Raises SettingsError where one of them might be a motor."""
    outputs = outputs_of(settings.accessories)
    problems = motors_among(outputs, DriveType(int(params["DRIVE_TYPE"])))
    if settings.simulation is None:  # the file was right with the motors that it names, which need not be these
        problems += clashes({"motors": settings.motors, "accessories": to_builtins(settings.accessories)})
    if problems:
        raise SettingsError(problems[0])
    if settings.simulation is not None:
        outputs = [replace(output, make=SimulatedAccessory) for output in outputs]
        return Rack(outputs or SIMULATED)
    return Rack(outputs)


def recorder_of(settings: Settings, system: int, opened: contextlib.ExitStack) -> VehicleRecorder | None:
    if settings.logs is None:
        return None
    recorder = VehicleRecorder(settings.logs, system=system, component=COMPONENT)
    opened.callback(recorder.close)
    return recorder


def build(
    settings: Settings,
    params: Params,
    rover: Rover,
    opened: contextlib.ExitStack,
    completed: Callable[[float], None],
    rack: Rack,
) -> Machine:
    """The rover in its body, with its accessories open; what must be closed after the motors is in `opened`. Raises
    MotorError, SettingsError."""
    if settings.simulation is None:
        motors, sensors = _body(settings, opened)
    else:
        motors, sensors = _simulated_body(settings.simulation, params)
    try:
        logged = _logged(motors, settings.motor_log)
        prove = proof(motors)
        machine = Machine(rover, logged, sensors, stop_input=stop_input(motors), prove=prove, completed=completed)
        opened.callback(rack.close)
        rack.open()
        return machine
    except BaseException:
        motors.close()
        raise


def _body(settings: Settings, opened: contextlib.ExitStack) -> tuple[Motors, Sensors]:
    opened.callback(MotorLock(settings.motors).close)
    accessories = {name: tables for name, tables in to_builtins(settings.accessories).items() if tables}
    parts = {"motors": dict(settings.motors), "accessories": accessories}
    opened.enter_context(copied(parts, settings.config))
    own = {key: value for key, value in settings.motors.items() if key != "driver"}
    motors = open_motors(settings.motors["driver"], own)
    if settings.sensors is None:
        return motors, NoSensors()
    try:
        sensors = open_sensors(settings.sensors)
        opened.callback(sensors.close)
        return motors, sensors
    except BaseException:
        motors.close()
        raise


def _simulated_body(simulation: Simulation, params: Params) -> tuple[Motors, Sensors]:
    kind = DriveType(int(params["DRIVE_TYPE"]))
    motors = SimulatedMotors(len(MIXERS[kind].motors))
    frame = Frame(top_speed=params["SPEED_MAX"], track_width=params["TRACK_WIDTH"], wheelbase=params["WHEELBASE"])
    body = SimulatedBody(
        lambda: motors.outputs,
        chassis=CHASSIS[kind](frame),
        battery=Battery(simulation.battery),
        home=simulation.home,
        seed=simulation.seed,
    )
    return motors, _watched(body, simulation.truth)


def _watched(body: SimulatedBody, path: str | None) -> Sensors:
    return body if path is None else WatchedBody(body, _lines("truth", path), time.monotonic_ns)


def _logged(motors: Motors, path: str | None) -> Motors:
    return motors if path is None else LoggedMotors(motors, _lines("motor", path), time.monotonic_ns)


def _lines(what: str, path: str) -> Callable[[str], None]:
    """What appends lines to a file."""
    try:
        return MotorLog(path).write
    except OSError as error:
        raise SettingsError(f"{what} log {path}: {error.strerror}") from error
