"""Builds the parts of a vehicle from its settings: parameters, motors, sensors, recorder; simulated or real."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable, Sequence
from functools import lru_cache

from msgspec import to_builtins
from msgspec.structs import replace

from dialects.enums import DriveType
from link.transport.faults.faulty_transport import LinkFaults
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.accessories.output import AccessorySpec, PulseRange
from vehicle.accessories.settings import build_specs
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.camera.camera import Camera
from vehicle.camera.scene import Pose
from vehicle.commands.context import COMPONENT
from vehicle.config.conflicts import find_conflicts, find_motor_conflicts
from vehicle.config.merge import merge_params
from vehicle.config.run_settings import SIMULATION_PARAMS, RunSettings, SettingsError, Simulation
from vehicle.control_loop import ControlLoop
from vehicle.drive.mixer import MIXERS
from vehicle.motors import Motors, arming_check, estop_reader
from vehicle.motors.drivers import open_motors, profile_params
from vehicle.motors.log import LoggedMotors, MotorLog
from vehicle.motors.simulated import SimulatedMotors
from vehicle.navigation.geo import Origin
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.runtime.camera_link import CameraLink
from vehicle.runtime.lock import MotorLock
from vehicle.runtime.walls_file import read_walls
from vehicle.sensors import NoSensors, Sensors
from vehicle.sensors.suite import open_sensors
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody
from vehicle.sim.chassis import CHASSIS, ChassisDimensions
from vehicle.sim.truth import RecordedBody
from vehicle.sim.walls import Segment, Surroundings, Walls
from vehicle.storage.motor_copy import settings_copy
from vehicle.storage.param_store import ParamStore
from vehicle.storage.recorder import VehicleRecorder

log = logging.getLogger(__name__)

SIMULATED_ACCESSORIES = (
    *(AccessorySpec("relay", number, SimulatedAccessory) for number in (0, 1)),
    *(AccessorySpec("servo", number, SimulatedAccessory, pulses=PulseRange(1000, 1500, 2000)) for number in (9, 10)),
)
"""Accessories of a simulation without configured ones."""


def build_params(settings: RunSettings, store: ParamStore) -> Params:
    """Merge defaults, those of a known car, saved, configured and this run's parameters; later values take precedence.

    Raises ParamError.
    """
    usual = SIMULATION_PARAMS if settings.simulation else profile_params(settings.motors["driver"])
    given, kept = {**settings.pinned, **settings.params}, store.values
    params, left_out = merge_params(given, kept=kept, usual=usual, pinned=settings.pinned.keys(), run=settings.params)
    for problem in left_out:
        log.warning("a saved parameter is not used: %s", problem)
    params.mark_damaged(store.damage)
    if params.damage:
        consequence = "all saved parameters have their defaults, and arming is denied until one is set"
        log.warning("%s: %s: %s", settings.state, params.damage, consequence)
    return params


def build_accessories(settings: RunSettings, params: Params) -> AccessorySet:
    """Return the accessories, not open yet. Raises SettingsError if one of them conflicts with a motor."""
    specs = build_specs(settings.accessories)
    problems = find_motor_conflicts(specs, DriveType(int(params["DRIVE_TYPE"])))
    if settings.simulation is None:  # the file was checked with its own motors; --motors may name others
        problems += find_conflicts({"motors": settings.motors, "accessories": to_builtins(settings.accessories)})
    if problems:
        raise SettingsError(problems[0])
    if settings.simulation is not None:
        specs = [replace(spec, make=SimulatedAccessory) for spec in specs]
        return AccessorySet(specs or SIMULATED_ACCESSORIES)
    return AccessorySet(specs)


def build_faults(settings: RunSettings) -> LinkFaults | None:
    """Return the faults of a simulated rover's links, None without any."""
    faults = settings.simulation.faults if settings.simulation else None
    return None if faults is None else LinkFaults(faults)


def build_recorder(settings: RunSettings, system: int, opened: contextlib.ExitStack) -> VehicleRecorder | None:
    """Return the recorder, which `opened` closes; None if nothing is recorded."""
    if settings.logs is None:
        return None
    recorder = VehicleRecorder(settings.logs, system=system, component=COMPONENT)
    opened.callback(recorder.close)
    return recorder


def build_control_loop(
    settings: RunSettings,
    params: Params,
    rover: Rover,
    opened: contextlib.ExitStack,
    completed: Callable[[float], None],
    rack: AccessorySet,
    start_camera: Callable[[Callable[[], Pose]], None] = lambda pose: None,
) -> ControlLoop:
    """Return the rover with motors, sensors and opened accessories. Raises MotorError, SettingsError.

    `opened` closes what must be closed after the motors. `start_camera` gets what tells where the rover is.
    """
    if settings.simulation is None:
        motors, sensors = _open_hardware(settings, opened)
        pose: Callable[[], Pose] = Pose
    else:
        motors, body = _build_simulation(settings.simulation, params)
        sensors, pose = _with_truth_log(body, settings.simulation.truth), _find_pose(body)
    try:
        start_camera(pose)
        logged = _with_motor_log(motors, settings.motor_log)
        prove = arming_check(motors)
        control_loop = ControlLoop(
            rover, logged, sensors, stop_input=estop_reader(motors), prove=prove, completed=completed
        )
        opened.callback(rack.close)
        rack.open()
        return control_loop
    except BaseException:
        motors.close()
        raise


def _open_hardware(settings: RunSettings, opened: contextlib.ExitStack) -> tuple[Motors, Sensors]:
    opened.callback(MotorLock(settings.motors).close)
    accessories = {name: tables for name, tables in to_builtins(settings.accessories).items() if tables}
    tables = {"motors": dict(settings.motors), "accessories": accessories}
    opened.enter_context(settings_copy(tables, settings.config))
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


def _find_pose(body: SimulatedBody) -> Callable[[], Pose]:
    return lambda: Pose(round(body.motion.north, 4), round(body.motion.east, 4), round(body.motion.yaw, 5))


def build_camera(settings: RunSettings) -> Camera | None:
    """Return the camera as the core sees it, None without one."""
    return None if settings.camera.kind == "none" else Camera(settings.camera)


def start_camera(
    settings: RunSettings, camera: Camera, pose: Callable[[], Pose], opened: contextlib.ExitStack
) -> CameraLink | None:
    """Start the process of the camera, which `opened` ends. The rover drives without one, too."""
    try:
        link = CameraLink(camera, pose, _find_walls(settings.simulation))
    except OSError as error:
        log.warning("camera: its process did not start: %s", error.strerror)
        return None
    opened.callback(link.close)
    return link


def _build_simulation(simulation: Simulation, params: Params) -> tuple[Motors, SimulatedBody]:
    kind = DriveType(int(params["DRIVE_TYPE"]))
    motors = SimulatedMotors(len(MIXERS[kind].motors))
    frame = ChassisDimensions(
        top_speed=params["SPEED_MAX"], track_width=params["TRACK_WIDTH"], wheelbase=params["WHEELBASE"]
    )
    body = SimulatedBody(
        lambda: motors.outputs,
        chassis=CHASSIS[kind](frame),
        battery=Battery(simulation.battery),
        home=simulation.home,
        seed=simulation.seed,
        surroundings=_build_surroundings(simulation, params),
    )
    return motors, body


def _build_surroundings(simulation: Simulation, params: Params) -> Surroundings | None:
    if simulation.walls is None:
        return None
    walls = Walls(_find_walls(simulation))
    return Surroundings(walls, simulation.seed, length=params["BODY_LENGTH"], width=params["BODY_WIDTH"])


def _find_walls(simulation: Simulation | None) -> Sequence[Segment]:
    if simulation is None or simulation.walls is None:
        return ()
    return _read_walls(simulation.walls, simulation.home.latitude, simulation.home.longitude)


@lru_cache(1)
def _read_walls(path: str, latitude: float, longitude: float) -> tuple[Segment, ...]:
    """Read the walls once for the range sensors and for the camera: a pipe cannot be read twice."""
    return tuple(read_walls(path, Origin(latitude, longitude)))


def _with_truth_log(body: SimulatedBody, path: str | None) -> Sensors:
    return body if path is None else RecordedBody(body, _line_writer("truth", path), time.monotonic_ns)


def _with_motor_log(motors: Motors, path: str | None) -> Motors:
    return motors if path is None else LoggedMotors(motors, _line_writer("motor", path), time.monotonic_ns)


def _line_writer(what: str, path: str) -> Callable[[str], None]:
    """Return the function that appends lines to a file. Raises SettingsError."""
    try:
        return MotorLog(path).write
    except OSError as error:
        raise SettingsError(f"{what} log {path}: {error.strerror}") from error
