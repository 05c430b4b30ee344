"""`vehicle check`: is the file of settings right, and does the hardware answer? Nothing moves: no motor gets power."""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dialects.enums import DriveType
from link.protocol.link_events import CONNECTING
from link.transport.transport import LinkError, Transport
from link.transport.transports import open_transports
from vehicle.accessories import OFF
from vehicle.accessories.output import AccessorySpec
from vehicle.accessories.settings import build_specs
from vehicle.config.config import Config, ConfigError, load
from vehicle.config.conflicts import find_motor_conflicts
from vehicle.config.effective_params import EffectiveParams, load_effective_params
from vehicle.drive.mixer import MIXERS
from vehicle.hardware.error_text import format_error
from vehicle.motors import MotorError, arming_check
from vehicle.motors.drivers import open_motors
from vehicle.params import Params
from vehicle.runtime.lock import MotorLock
from vehicle.sensors.encoders import Encoders
from vehicle.sensors.gps import GpsdClient
from vehicle.sensors.pi_health import PiHealth
from vehicle.sensors.power import PowerMonitor
from vehicle.storage.dir_check import write_problem
from vehicle.storage.recorder import LOGS

GPS_WAIT = 3.0
"""s for a first report: gpsd answers at once, receivers give one each second."""
POLL = 0.1
"""s"""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """One item: what, whether it is well, and what was seen."""

    item: str
    ok: bool
    detail: str
    mistake: bool = False
    """It is not well because of the file, whatever the hardware does."""

    def __str__(self) -> str:
        return f"{'ok  ' if self.ok else 'FAIL'}  {self.item}: {self.detail}"


def run_checks(path: str, state: str | None = None) -> Iterator[CheckResult]:
    """Item by item as they are tried; the file alone where it has mistakes. `state`: folder of kept parameters."""
    try:
        config = load(path)
    except ConfigError as error:
        yield from (CheckResult("settings", False, problem, mistake=True) for problem in error.problems)
        return
    yield CheckResult("settings", True, path)
    known = load_effective_params(config, state)
    yield _parameters(config, known)
    yield _folder("state", known.folder, "state or --state")
    if known.params["LOG_BACKEND_TYPE"]:
        logs = Path(config.log.tlog) if config.log.tlog else known.folder / LOGS
        yield _folder("log.tlog", logs, "log.tlog")
    yield from _links(config)
    if config.motors:
        yield _tried("motors", lambda: _motors(config, known.params))
    else:
        yield CheckResult("motors", False, 'none; add [motors] and driver = "NAME"', mistake=True)
    yield from _accessories(config, known.params)
    yield from _sensors(config)
    for name, log in (("log.file", config.log.file), ("log.motors", config.log.motors)):
        if log is not None:
            yield _tried(name, lambda log=Path(log): _log_file(log))  # type: ignore[misc]


def _accessories(config: Config, params: Params) -> Iterator[CheckResult]:
    """Each is opened as it is when it is safe; a servo without pulses, so that it does not move."""
    outputs = build_specs(config.accessories)
    for problem in find_motor_conflicts(outputs, DriveType(int(params["DRIVE_TYPE"]))):
        yield CheckResult("settings", False, problem, mistake=True)
    for output in outputs:
        yield _tried(output.name, lambda output=output: _accessory(output, config.motors))  # type: ignore[misc]


def _accessory(output: AccessorySpec, motors: Mapping[str, Any]) -> str:
    value = output.safe if output.kind == "relay" else OFF
    with contextlib.ExitStack() as opened:
        if motors:  # a board that another vehicle drives by would be set up anew under its motors
            opened.callback(MotorLock(motors).close)
        try:
            output.make(value).close()
        except Exception as error:  # anybody's driver may raise anything
            raise _AbsentError(format_error(error)) from error
    return f"{output.driver}, {output.format_value(value)}"


def _sensors(config: Config) -> Iterator[CheckResult]:
    sensors = config.sensors
    if sensors.battery is not None:
        battery = PowerMonitor(sensors.battery)
        yield _tried("sensors.battery", lambda: _battery(battery))
    if sensors.gps is not None:
        yield _tried("sensors.gps", lambda: asyncio.run(_gps(config)))
    if sensors.encoders is not None:
        yield _tried("sensors.encoders", lambda: _encoders(config))
    if sensors.computer:
        yield _tried("sensors.computer", _computer)


class _AbsentError(Exception):
    """It does not answer."""


def _tried(item: str, attempt: Callable[[], str]) -> CheckResult:
    try:
        return CheckResult(item, True, attempt())
    except (MotorError, OSError, ImportError, LinkError, _AbsentError) as error:
        return CheckResult(item, False, format_error(error))


def _links(config: Config) -> Iterator[CheckResult]:
    if not config.endpoints:
        yield CheckResult(
            "endpoints", False, 'none; where is the ground station? endpoints = ["udpin:0.0.0.0:14550"]', mistake=True
        )
    for endpoint in config.endpoints:
        yield _tried(f"endpoint {endpoint}", lambda endpoint=endpoint: _link(endpoint))  # type: ignore[misc]


def _link(endpoint: str) -> str:
    [wire] = open_transports([endpoint])
    if connects := _connecting(wire):
        asyncio.run(_connected(wire))
    else:
        wire.close()
    if wire.problem:
        raise _AbsentError(wire.problem.removeprefix(f"{endpoint}: ").removesuffix("; trying again"))
    return "connects" if connects else "opens"


def _connecting(wire: Transport) -> bool:
    return wire.problem == f"{wire.endpoint.text}: {CONNECTING}"


async def _connected(wire: Transport) -> None:
    """Until it is, or says why not."""
    wire.start(asyncio.get_running_loop(), lambda _: None, lambda _: None)
    while True:
        await asyncio.sleep(POLL)
        if not _connecting(wire):
            wire.close()
            return


def _folder(item: str, folder: Path, setting: str) -> CheckResult:
    problem = write_problem(folder, setting)
    return CheckResult(
        item, not problem, problem or f"{folder} {'can be written' if folder.exists() else 'can be made'}"
    )


def _log_file(path: Path) -> str:
    if path.is_dir() or not path.parent.is_dir():
        raise _AbsentError(f"{path} is a folder" if path.is_dir() else f"there is no folder {path.parent}; make it")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise _AbsentError(f"{path} may not be written by this user")
    return f"{path} can be written"


def _parameters(config: Config, known: EffectiveParams) -> CheckResult:
    problem = known.damage or "; ".join(f"a kept one is not used: {each}" for each in known.left_out)
    seen = f"{len(config.params)} from the file, {known.saved_count} kept in {known.folder}"
    return CheckResult("parameters", not problem, f"{seen}: {problem}" if problem else seen)


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
            raise _AbsentError(f"the driver has {motors.count} motors, DRIVE_TYPE {kind:d} needs {wanted}")
        version = getattr(motors, "version", None)
        told = f", it calls itself {version()}" if version is not None else ""
        turned = [name for number, name in enumerate(names, start=1) if params[f"MOT{number}_REVERSED"]]
        told += f"; reversed: {', '.join(turned)}" if turned else ""
        return f"{config.motors['driver']} with {motors.count} motors, neutral and without power{told}"


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
                raise _AbsentError(gps.fault)
            if reading := gps.latest(loop.time()):
                return f"fix type {reading.fix.fix_type}, {reading.sky.satellites or 0} satellites"
        raise _AbsentError("gpsd is there, and says nothing of a position: is a receiver connected to it?")
    finally:
        gps.close()


def _encoders(config: Config) -> str:
    assert config.sensors.encoders is not None
    encoders = Encoders(config.sensors.encoders)
    encoders.close()
    return f"{len(config.sensors.encoders.wheels)} wheels; turn one by hand while the vehicle runs to see it count"


def _computer() -> str:
    health = PiHealth().sample()
    if health.under_voltage:
        raise _AbsentError("under-voltage: the supply or its cable is too weak")
    warmth = "temperature unknown" if health.temperature is None else f"{health.temperature:.0f} degrees"
    return f"{warmth}, {'supply not watched' if health.under_voltage is None else 'supply well'}"
