"""The rover daemon: links, rover, motors and signals joined in one process; what is decided is decided in the cores.

Whatever ends it (a signal, a broken driver, a fault in our own code) the order is the same: motors neutral and without
power, last messages, exit code with one line. Exit codes: 0 asked to stop, 1 a fault, 2 the user's mistake, 80 to 82
what a ground station asked for (vehicle/leaving.py).
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import logging
import signal
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dialects.enums import DriveType
from link.endpoint import EndpointError
from link.link import LinkError
from link.loop import run_loop
from link.runner import Runner, open_links
from link.tape import Tape
from vehicle.heard import HEARD
from vehicle.leaving import Leave
from vehicle.lock import MotorLock
from vehicle.machine import Machine
from vehicle.mixer import MIXERS
from vehicle.motor_copy import copied
from vehicle.motors import USUAL_PARAMS, MotorError, Motors, UnknownDriverError, open_motors, stop_input
from vehicle.motors.log import LoggedMotors, MotorLog
from vehicle.motors.simulated import SimulatedMotors
from vehicle.notify import Notifier
from vehicle.param_store import ParamStore
from vehicle.params import ParamError, Params, in_force
from vehicle.plan_store import PlanStore
from vehicle.recorder import VehicleRecorder
from vehicle.rover import Rover
from vehicle.sensors import NoSensors, Sensors
from vehicle.sensors.suite import SensorSettings, open_sensors
from vehicle.sim.battery import Battery
from vehicle.sim.body import Home, SimulatedBody
from vehicle.sim.chassis import CHASSIS, Frame
from vehicle.sim.truth import WatchedBody

log = logging.getLogger(__name__)

PERIOD = 0.02
"""s, the control cycle: 50 Hz is what servos and controllers of this size take, and ten times the driver's own rate."""

COMPONENT = 1
"""MAV_COMP_ID_AUTOPILOT1: ground stations take only this one for a vehicle."""

STOPPED, FAULT, MISTAKE = 0, 1, 2
"""Exit codes."""

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Asked to stop: by the service manager, by Ctrl-C, by a terminal that was closed."""


@dataclass(frozen=True, slots=True)
class Simulation:
    """Wishes for the simulated rover."""

    home: Home = field(default_factory=Home)
    battery: float = 1.0
    """Charge at the start, 0..1."""
    seed: int = 1
    """Of the sensors' noise."""
    truth: str | None = None
    """File to append to where it really is."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What the command line or a file asks for."""

    endpoints: tuple[str, ...]
    motors: Mapping[str, Any] = field(default_factory=lambda: {"driver": "simulated"})
    """The driver's name as `driver`, and its settings; a simulation has its own."""
    config: Path | None = None
    """The file that says so; safe-stop is told the same one."""
    sensors: SensorSettings | None = None
    """None: a rover that measures nothing. A simulation has its own."""
    simulation: Simulation | None = None
    pinned: Mapping[str, float] = field(default_factory=dict)
    """Parameters that the file of settings sets, and no ground station changes."""
    params: Mapping[str, float] = field(default_factory=dict)
    """Parameters of this run."""
    motor_log: str | None = None
    state: Path | None = None
    """Folder that keeps what ground stations set; None: nothing is kept."""
    logs: Path | None = None
    """Folder of telemetry logs; None: nothing is recorded."""


class SettingsError(Exception):
    """What was asked for cannot be had; the text is one line."""


def run(settings: Settings) -> int:
    """Run until asked to stop; the exit code. What goes wrong becomes one line of the log."""
    try:
        return run_loop(_serve(settings))
    except (SettingsError, EndpointError, LinkError, ParamError, UnknownDriverError) as error:
        log.error("%s", error)
        return MISTAKE
    except MotorError as error:
        log.error("motor driver: %s", error, exc_info=True)
        return FAULT
    except Exception as error:
        log.critical("%s (--log-file keeps the details)", _told(error), exc_info=True)
        return FAULT


def _told(error: Exception) -> str:
    """A fault in one line. The machine stopped the motors before it let it through, or noted that it could not."""
    notes = getattr(error, "__notes__", [])
    state = f"motors may still turn, cut their power: {'; '.join(notes)}" if notes else "motors neutral"
    return f"{state}; stopped by a fault in the program: {type(error).__name__}: {error}"


async def _serve(settings: Settings) -> int:
    now = asyncio.get_running_loop().time()
    with contextlib.ExitStack() as opened:
        keeper = None if settings.state is None else ParamStore(settings.state)
        params = _params(settings, keeper)
        if keeper is not None:
            opened.callback(keeper.close)
        plans = None if settings.state is None else PlanStore(settings.state)
        if plans is not None:
            opened.callback(plans.close)
            for damage in plans.damage.values():
                log.warning("%s", damage)
        notifier = Notifier()
        opened.callback(notifier.close)
        system = int(params["MAV_SYSID"])
        recorder = _recorder(settings, system, opened)
        rover = Rover(params, now=now, wall_clock=time.time(), keeper=keeper, plan_keeper=plans, recording=recorder)
        cycles = Cycles(rover, notifier)
        machine = _build(settings, params, rover, opened, cycles.completed)
        tape = recorder.tape if recorder else None
        try:
            return await _drive(machine, settings.endpoints, system, notifier, cycles, tape)
        except BaseException as error:
            machine.abandon(error, asyncio.get_running_loop().time())
            raise
        finally:
            machine.close()


def _params(settings: Settings, keeper: ParamStore | None) -> Params:
    """Defaults, a known car's, what was kept, the file of settings, this run: the later wins. Raises ParamError."""
    usual = {} if settings.simulation else USUAL_PARAMS.get(settings.motors["driver"], {})
    given, kept = {**settings.pinned, **settings.params}, keeper.values if keeper else {}
    params, left_out = in_force(given, kept=kept, usual=usual, pinned=settings.pinned.keys())
    for problem in left_out:
        log.warning("a kept parameter is not used: %s", problem)
    params.damage = keeper.damage if keeper else None
    if params.damage:
        log.warning("%s: all parameters that were set have their defaults, and nobody can arm", params.damage)
    return params


class Cycles:
    """What follows from a completed control cycle: the watchdog is fed, and a wish to leave is heard."""

    def __init__(self, rover: Rover, notifier: Notifier) -> None:
        self.ending: Ending | None = None
        self._rover = rover
        self._notifier = notifier

    def completed(self, now: float) -> None:
        """One more."""
        self._notifier.alive(now)
        leave = self._rover.leaving(now)
        if leave is not None and self.ending is not None:
            self.ending.leave(leave)


def _recorder(settings: Settings, system: int, opened: contextlib.ExitStack) -> VehicleRecorder | None:
    if settings.logs is None:
        return None
    recorder = VehicleRecorder(settings.logs, system=system, component=COMPONENT)
    opened.callback(recorder.close)
    return recorder


async def _drive(
    machine: Machine,
    endpoints: Sequence[str],
    system: int,
    notifier: Notifier,
    cycles: Cycles,
    tape: Tape | None,
) -> int:
    links = open_links(endpoints, system=system, component=COMPONENT, wanted=HEARD)
    runner = Runner(machine, links, period=PERIOD, tape=tape)
    ending = Ending(machine, runner, notifier.stopping)
    cycles.ending = ending
    ending.listen(asyncio.get_running_loop())
    gc.collect()
    gc.freeze()  # a collection of 100 000 start-up objects takes 35 ms, longer than a control cycle
    status = f"system {system}, {', '.join(endpoints)}"
    log.info("ready, %s", status)
    notifier.ready(status)
    return await ending.wait()


class Ending:
    """How the run ends from outside the cores: asked by a signal, or by a fault in a callback of the loop."""

    def __init__(self, machine: Machine, runner: Runner, stopping: Callable[[], None] = lambda: None) -> None:
        """`stopping` is called once the motors stand."""
        self._stopping = stopping
        self._machine = machine
        self._runner = runner
        self._reason: str | None = None
        self._fault: Exception | None = None
        self._code = STOPPED

    def listen(self, loop: asyncio.AbstractEventLoop) -> None:
        """Take signals and what callbacks raise."""
        for number in SIGNALS:
            loop.add_signal_handler(number, self._end, f"stopped by {number.name}, motors neutral")
        loop.set_exception_handler(lambda _, context: self._end("", context.get("exception"), context["message"]))

    async def wait(self) -> int:
        """Run until the end. Raises what went wrong."""
        await self._runner.run()
        if self._fault is not None:
            raise self._fault
        log.info("%s", self._reason)
        return self._code

    def leave(self, leave: Leave) -> None:
        """A ground station asked for it."""
        if self._reason is None:
            self._code = int(leave)
        self._end(f"{leave.words} as a ground station asked, motors neutral")

    def _end(self, reason: str, fault: Exception | None = None, message: str = "") -> None:
        """The same order as everywhere: motors, last messages (Runner.run sends them), end."""
        if self._reason is not None:
            return
        self._reason = reason
        self._fault = fault or (RuntimeError(message) if message else None)
        try:
            self._machine.shutdown(asyncio.get_running_loop().time())
        except Exception as error:
            self._fault = MotorError(f"the motors did not stop when told, cut their power: {error}")
        self._stopping()
        self._runner.stop()


def _build(
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
        return Machine(rover, logged, sensors, stop_input=stop_input(motors), completed=completed)
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
    if path is None:
        return body
    try:
        return WatchedBody(body, MotorLog(path).write, time.monotonic_ns)
    except OSError as error:
        raise SettingsError(f"truth log {path}: {error.strerror}") from error


def _logged(motors: Motors, path: str | None) -> Motors:
    if path is None:
        return motors
    try:
        return LoggedMotors(motors, MotorLog(path).write, time.monotonic_ns)
    except OSError as error:
        raise SettingsError(f"motor log {path}: {error.strerror}") from error
