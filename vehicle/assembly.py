"""The parts of a vehicle from its settings: parameters, motors, sensors, recorder; simulated or real. No loop."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable

from dialects.enums import DriveType
from vehicle.answers import COMPONENT
from vehicle.lock import MotorLock
from vehicle.machine import Machine
from vehicle.mixer import MIXERS
from vehicle.motor_copy import copied
from vehicle.motors import USUAL_PARAMS, Motors, open_motors, proof, stop_input
from vehicle.motors.log import LoggedMotors, MotorLog
from vehicle.motors.simulated import SimulatedMotors
from vehicle.param_store import ParamStore
from vehicle.params import Params, in_force
from vehicle.recorder import VehicleRecorder
from vehicle.rover import Rover
from vehicle.run_settings import Settings, SettingsError, Simulation
from vehicle.sensors import NoSensors, Sensors
from vehicle.sensors.suite import open_sensors
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody
from vehicle.sim.chassis import CHASSIS, Frame
from vehicle.sim.truth import WatchedBody

log = logging.getLogger(__name__)


def params_of(settings: Settings, keeper: ParamStore | None) -> Params:
    """Defaults, a known car's, what was kept, the file of settings, this run: the later wins. Raises ParamError."""
    usual = {} if settings.simulation else USUAL_PARAMS.get(settings.motors["driver"], {})
    given, kept = {**settings.pinned, **settings.params}, keeper.values if keeper else {}
    params, left_out = in_force(given, kept=kept, usual=usual, pinned=settings.pinned.keys())
    for problem in left_out:
        log.warning("a kept parameter is not used: %s", problem)
    params.damage = keeper.damage if keeper else None
    if params.damage:
        consequence = "all parameters that were set have their defaults, and nobody can arm until one is set"
        log.warning("%s: %s: %s", settings.state, params.damage, consequence)
    return params


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
) -> Machine:
    """The rover in its body; what must be closed after the motors is in `opened`. Raises MotorError, SettingsError."""
    if settings.simulation is None:
        motors, sensors = _body(settings, opened)
    else:
        motors, sensors = _simulated_body(settings.simulation, params)
    try:
        logged = _logged(motors, settings.motor_log)
        return Machine(rover, logged, sensors, stop_input=stop_input(motors), prove=proof(motors), completed=completed)
    except BaseException:
        motors.close()
        raise


def _body(settings: Settings, opened: contextlib.ExitStack) -> tuple[Motors, Sensors]:
    opened.callback(MotorLock(settings.motors).close)
    opened.enter_context(copied(settings.motors, settings.config))
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
