"""`mavhelm vehicle check`: check the configuration file and the hardware. Nothing moves: the motors have no power."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec

from dialects.enums import DriveType
from link.endpoint import Side
from link.protocol.link_events import CONNECTING
from link.transport.transport import LinkError, Transport
from link.transport.transports import open_transports
from vehicle.accessories import OFF
from vehicle.accessories.output import AccessorySpec
from vehicle.accessories.settings import build_specs
from vehicle.config.config import Config, RoverConfigError, load
from vehicle.config.conflicts import find_motor_conflicts
from vehicle.config.effective_params import EffectiveParams, load_effective_params
from vehicle.drive.mixer import MIXERS
from vehicle.hardware.error_text import format_error
from vehicle.motors import MotorError, arming_check
from vehicle.motors.drivers import open_motors
from vehicle.params import Params
from vehicle.runtime.lock import InUseError, MotorLock
from vehicle.sensors.encoders import Encoders
from vehicle.sensors.gps import GpsdClient
from vehicle.sensors.pi_health import PiHealth
from vehicle.sensors.power import PowerMonitor
from vehicle.sensors.ranging.sources import RangeSensor, open_lidar, open_rangefinder
from vehicle.storage.dir_check import write_problem
from vehicle.storage.recorder import LOGS

GPS_WAIT = 3.0
"""s for a first report: gpsd responds at once, and receivers report once per second."""
RANGE_WAIT = 2.0
"""s for a first measurement: a lidar needs a second until it turns."""
POLL = 0.1
"""s between two polls."""
BUSY_ERRNOS = (errno.EADDRINUSE, errno.EBUSY, errno.EAGAIN)
"""Errors of the kernel for a port that another program has open."""


class CheckResult(msgspec.Struct, frozen=True):
    """The result for one item."""

    item: str
    ok: bool
    detail: str
    user_error: bool = False
    """The failure is caused by the file, not by the hardware."""
    busy: bool = False
    """The failure is that another program, maybe the vehicle itself, uses the hardware."""

    def __str__(self) -> str:
        return f"{'ok  ' if self.ok else 'FAIL'}  {self.item}: {self.detail}"


def run_checks(path: str, state: str | None = None) -> Iterator[CheckResult]:
    """Yield the results one by one; only those of the file if it has errors. `state` overrides the state folder."""
    try:
        config = load(path)
    except RoverConfigError as error:
        yield from (CheckResult("settings", False, problem, user_error=True) for problem in error.problems)
        return
    yield CheckResult("settings", True, path)
    effective = load_effective_params(config, state)
    yield _parameters(config, effective)
    yield _folder("state", effective.folder, "state or --state")
    if effective.params["LOG_BACKEND_TYPE"]:
        logs = Path(config.log.tlog) if config.log.tlog else effective.folder / LOGS
        yield _folder("log.tlog", logs, "log.tlog")
    yield from _links(config)
    if config.motors:
        yield _try("motors", lambda: _motors(config, effective.params))
    else:
        yield CheckResult("motors", False, 'none; add [motors] and driver = "NAME"', user_error=True)
    yield from _accessories(config, effective.params)
    yield from _sensors(config)
    for name, log in (("log.file", config.log.file), ("log.motors", config.log.motors)):
        if log is not None:
            yield _try(name, lambda log=Path(log): _log_file(log))  # type: ignore[misc]


def _accessories(config: Config, params: Params) -> Iterator[CheckResult]:
    """Open each relay with its safe state, and each servo without pulses, so that it does not move."""
    specs = build_specs(config.accessories)
    for problem in find_motor_conflicts(specs, DriveType(int(params["DRIVE_TYPE"]))):
        yield CheckResult("settings", False, problem, user_error=True)
    for spec in specs:
        yield _try(spec.name, lambda spec=spec: _accessory(spec, config.motors))  # type: ignore[misc]


def _accessory(spec: AccessorySpec, motors: Mapping[str, Any]) -> str:
    value = spec.safe if spec.kind == "relay" else OFF
    with contextlib.ExitStack() as opened:
        if motors:  # setting up a board that a running vehicle uses would interrupt its motors
            opened.callback(MotorLock(motors).close)
        try:
            spec.make(value).close()
        except Exception as error:  # a driver may raise anything
            raise _CheckError(format_error(error)) from error
    return f"{spec.driver}, {spec.format_value(value)}"


def _sensors(config: Config) -> Iterator[CheckResult]:
    sensors = config.sensors
    if sensors.battery is not None:
        battery = PowerMonitor(sensors.battery)
        yield _try("sensors.battery", lambda: _battery(battery))
    if sensors.gps is not None:
        yield _try("sensors.gps", lambda: asyncio.run(_gps(config)))
    if sensors.encoders is not None:
        yield _try("sensors.encoders", lambda: _encoders(config))
    for index, each in enumerate(sensors.rangefinders):
        yield _try(f"sensors.rangefinders[{index}]", lambda each=each: _range(open_rangefinder(each)))  # type: ignore[misc]
    if (lidar := sensors.lidar) is not None:
        yield _try("sensors.lidar", lambda: _range(open_lidar(lidar)))
    if sensors.computer:
        yield _try("sensors.computer", _computer)


class _CheckError(Exception):
    """The check failed; the text is one line."""


def _try(item: str, attempt: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(item, True, attempt())
    except (MotorError, OSError, ImportError, LinkError, _CheckError) as error:
        return CheckResult(item, False, format_error(error), busy=_is_busy(error))


def _is_busy(error: Exception) -> bool:
    cause = error.__cause__
    return isinstance(error, InUseError) or (isinstance(cause, OSError) and cause.errno in BUSY_ERRNOS)


def _links(config: Config) -> Iterator[CheckResult]:
    if not config.endpoints:
        detail = 'none; add the link to the ground station: endpoints = ["udpin:0.0.0.0:14550"]'
        yield CheckResult("endpoints", False, detail, user_error=True)
    for endpoint in config.endpoints:
        yield _try(f"endpoint {endpoint}", lambda endpoint=endpoint: _link(endpoint))  # type: ignore[misc]


def _link(endpoint: str) -> str:
    [transport] = open_transports([endpoint], Side.VEHICLE)
    if connects := _is_connecting(transport):
        asyncio.run(_connect(transport))
    else:
        transport.close()
    if transport.problem:
        raise _CheckError(transport.problem.removeprefix(f"{endpoint}: ").removesuffix("; trying again"))
    return "connects" if connects else "opens"


def _is_connecting(transport: Transport) -> bool:
    return transport.problem == f"{transport.endpoint.text}: {CONNECTING}"


async def _connect(transport: Transport) -> None:
    """Wait until the transport is connected or has failed, then close it."""
    transport.start(asyncio.get_running_loop(), lambda _: None, lambda _: None)
    while True:
        await asyncio.sleep(POLL)
        if not _is_connecting(transport):
            transport.close()
            return


def _folder(item: str, folder: Path, setting: str) -> CheckResult:
    problem = write_problem(folder, setting)
    detail = f"{folder} {'is writable' if folder.exists() else 'can be created'}"
    return CheckResult(item, not problem, problem or detail)


def _log_file(path: Path) -> str:
    if path.is_dir() or not path.parent.is_dir():
        raise _CheckError(f"{path} is a folder" if path.is_dir() else f"no folder {path.parent}; create it")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise _CheckError(f"{path} is not writable by this user")
    return f"{path} is writable"


def _parameters(config: Config, effective: EffectiveParams) -> CheckResult:
    problem = effective.damage or "; ".join(f"a saved one is not used: {each}" for each in effective.left_out)
    counts = f"{len(config.params)} from the file, {effective.saved_count} saved in {effective.folder}"
    return CheckResult("parameters", not problem, f"{counts}: {problem}" if problem else counts)


def _motors(config: Config, params: Params) -> str:
    kind = DriveType(int(params["DRIVE_TYPE"]))
    names = MIXERS[kind].motors
    wanted = len(names)
    with contextlib.ExitStack() as opened:
        opened.callback(MotorLock(config.motors).close)
        motors = open_motors(config.motors["driver"], {k: v for k, v in config.motors.items() if k != "driver"})
        opened.callback(motors.close)
        motors.set((0.0,) * motors.count)
        motors.disable()
        arming_check(motors)()
        if motors.count != wanted:
            raise _CheckError(f"the driver has {motors.count} motors, DRIVE_TYPE {kind:d} needs {wanted}")
        version = getattr(motors, "version", None)
        notes = f"; version {version()}" if version is not None else ""
        reversed_ = [name for number, name in enumerate(names, start=1) if params[f"MOT{number}_REVERSED"]]
        notes += f"; reversed: {', '.join(reversed_)}" if reversed_ else ""
        return f"{config.motors['driver']} with {motors.count} motors, neutral and without power{notes}"


def _battery(monitor: PowerMonitor) -> str:
    try:
        power = monitor.sample()
    finally:
        monitor.close()
    return f"{power.voltage:.2f} V, {power.current:.2f} A"


async def _gps(config: Config) -> str:
    assert config.sensors.gps is not None
    gps, loop = GpsdClient(config.sensors.gps), asyncio.get_running_loop()
    try:
        end = loop.time() + GPS_WAIT
        while loop.time() < end:
            await asyncio.sleep(POLL)
            if gps.fault:
                raise _CheckError(gps.fault)
            if reading := gps.latest(loop.time()):
                return f"fix type {reading.fix.fix_type}, {reading.sky.satellites or 0} satellites"
        raise _CheckError("gpsd responds, but reports no position: is a receiver connected to it?")
    finally:
        gps.close()


def _encoders(config: Config) -> str:
    assert config.sensors.encoders is not None
    encoders = Encoders(config.sensors.encoders)
    encoders.close()
    return f"{len(config.sensors.encoders.wheels)} wheels; turn one by hand while the vehicle runs to see it count"


def _range(source: RangeSensor) -> str:
    """Wait for a measurement."""
    try:
        end = time.monotonic() + RANGE_WAIT
        while (reading := source.latest(time.monotonic())) is None:
            if time.monotonic() > end:
                raise _CheckError(source.fault or "measures nothing")
            time.sleep(POLL)
    finally:
        source.close()
    distances = [cone.distance for cone in reading.scan if cone.distance is not None and not cone.is_clear]
    if not any(cone.distance is not None for cone in reading.scan):
        raise _CheckError(f"{source.name} measures nothing: is it covered?")
    return f"{source.name}: {f'nearest obstacle {min(distances):.2f} m' if distances else 'no obstacle in range'}"


def _computer() -> str:
    health = PiHealth().sample()
    if health.under_voltage:
        raise _CheckError("under-voltage: the supply or its cable is too weak")
    temperature = "temperature unknown" if health.temperature is None else f"{health.temperature:.0f} degrees C"
    return f"{temperature}, {'supply voltage not monitored' if health.under_voltage is None else 'supply voltage ok'}"
