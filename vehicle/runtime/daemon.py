"""The rover daemon: connects links, rover, motors and signals in one process; decisions are made in the cores.

Whatever ends the daemon (a signal, a failed driver, an exception in the program), the order is the same: motors neutral
and without power, last messages, exit code and one line in the log. Exit codes: 0 requested stop, 1 fault, 2 user
error, which a restart cannot fix, 80 to 82 requests of a ground station (vehicle/commands/reboot.py).
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import Callable, Sequence

from dialects.enums import Severity
from link.endpoint import SERIAL, EndpointError, Side, parse_endpoint
from link.links import open_links
from link.protocol.log_tap import LogTap
from link.runner import Runner
from link.runtime import startup_gc
from link.runtime.command_line import USAGE_ERROR
from link.runtime.event_loop import run_loop, running_loop
from link.signing.key_file import FILE, KeyFileError
from link.signing.memory_file import FILE as MEMORY_FILE
from link.signing.memory_file import MemoryFileError
from link.transport.transport import Link, LinkError
from vehicle.camera.scene import Pose
from vehicle.commands.context import COMPONENT
from vehicle.commands.signing import Pairing
from vehicle.config.run_settings import RunSettings, SettingsError
from vehicle.control_loop import CYCLE, ControlLoop
from vehicle.motors import MotorError, UnknownDriverError
from vehicle.params import ParamError
from vehicle.rover import Rover
from vehicle.runtime.announcement import announce
from vehicle.runtime.factory import (
    build_accessories,
    build_camera,
    build_control_loop,
    build_faults,
    build_params,
    build_recorder,
    start_camera,
)
from vehicle.runtime.host_info import HostMonitor, read_uid
from vehicle.runtime.link_guards import LinkGuards
from vehicle.runtime.lock import lock_state_folder
from vehicle.runtime.shutdown import CycleObserver, Shutdown
from vehicle.runtime.systemd import Notifier
from vehicle.runtime.vehicle_keys import VehicleKeys
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.storage.store import Store
from vehicle.telemetry.host import HostInfo

log = logging.getLogger(__name__)

LEVELS: dict[Severity, int] = {
    Severity.EMERGENCY: logging.CRITICAL,
    Severity.ALERT: logging.CRITICAL,
    Severity.CRITICAL: logging.CRITICAL,
    Severity.ERROR: logging.ERROR,
    Severity.WARNING: logging.WARNING,
    Severity.NOTICE: logging.INFO,
    Severity.INFO: logging.INFO,
    Severity.DEBUG: logging.DEBUG,
}
"""Severity of STATUSTEXT -> level of the log."""

FAULT = 1
"""Exit code beside USAGE_ERROR and those of vehicle/runtime/shutdown.py.

systemd does not restart the service after USAGE_ERROR, so an error that may disappear is a FAULT: a host name that is
not resolved yet at boot, or a port that another program still uses.
"""


def run(settings: RunSettings) -> int:
    """Run until a stop is requested and return the exit code. An error is logged as one line."""
    try:
        return run_loop(_serve(settings))
    except (SettingsError, EndpointError, ParamError, UnknownDriverError) as error:
        log.error("%s", error)
        return USAGE_ERROR
    except LinkError as error:
        log.error("%s", error)
        return FAULT
    except MotorError as error:
        log.error("motor driver: %s", error, exc_info=True)
        return FAULT
    except Exception as error:
        log.critical("%s (use --log-file for the traceback)", _describe_fault(error), exc_info=True)
        return FAULT


def _describe_fault(error: Exception) -> str:
    """Return an exception as one line. ControlLoop stopped the motors first, or added a note that it could not."""
    notes = getattr(error, "__notes__", [])
    state = f"motors may still turn, cut their power: {'; '.join(notes)}" if notes else "motors neutral"
    return f"{state}; stopped by a fault in the program: {type(error).__name__}: {error}"


def _log_status_text(severity: Severity, text: str) -> None:
    """Log a STATUSTEXT."""
    log.log(LEVELS[severity], "%s", text)


def _store(settings: RunSettings) -> Store | None:
    """Return a store in the state folder, None if nothing is saved in this run."""
    return None if settings.state is None else FileWriter(settings.state)


def _open_keys(settings: RunSettings, opened: contextlib.ExitStack) -> VehicleKeys | None:
    """Return the keys in the state folder, None if there is none. Raises SettingsError."""
    if settings.state is None:
        return None
    try:
        vehicle_keys = VehicleKeys(settings.state / FILE)
    except KeyFileError as error:
        raise SettingsError(str(error)) from None
    opened.callback(vehicle_keys.close)
    return vehicle_keys


def _open_guards(settings: RunSettings, keys: VehicleKeys | None, now: float) -> LinkGuards:
    """Return what guards the links. Raises SettingsError."""
    memory = None if settings.state is None else settings.state / MEMORY_FILE
    try:
        return LinkGuards(settings.signing, settings.endpoints, keys, memory, now)
    except MemoryFileError as error:
        raise SettingsError(str(error)) from None


def _find_cables(endpoints: Sequence[str]) -> frozenset[int]:
    """Return the indexes of serial and USB links, over which a key is accepted."""
    return frozenset(index for index, text in enumerate(endpoints) if parse_endpoint(text).scheme == SERIAL)


async def _serve(settings: RunSettings) -> int:
    loop = running_loop()
    now, host = loop.time(), HostInfo(uid=read_uid())
    with contextlib.ExitStack() as opened:
        if settings.state is not None:
            opened.enter_context(lock_state_folder(settings.state))
        param_store, plan_store = ParamStore(_store(settings)), PlanStore(_store(settings))
        opened.callback(param_store.close)
        opened.callback(plan_store.close)
        vehicle_keys = _open_keys(settings, opened)
        guards = _open_guards(settings, vehicle_keys, now)
        opened.callback(lambda: guards.close(loop.time()))
        params = build_params(settings, param_store)
        for damage in plan_store.damage.values():
            log.warning("%s: %s", settings.state, damage)
        notifier = Notifier()
        opened.callback(notifier.close)
        system = int(params["MAV_SYSID"])
        recorder = build_recorder(settings, system, opened)
        rack = build_accessories(settings, params)
        camera = build_camera(settings)
        rover = Rover(
            params,
            now=now,
            param_store=param_store,
            plan_store=plan_store,
            recording=recorder,
            pairing=None if vehicle_keys is None else Pairing(vehicle_keys, _find_cables(settings.endpoints)),
            arming_note=guards.arming_note,
            host=host,
            on_text=_log_status_text,
            rack=rack,
            camera=camera,
        )
        host_monitor = HostMonitor(host, lambda: loop.idle_time, time.time, now)
        faults = build_faults(settings)
        cycles = CycleObserver(rover, notifier, host_monitor, vehicle_keys, guards, faults)

        def begin_camera(pose: Callable[[], Pose]) -> None:
            if camera is not None:
                cycles.camera = start_camera(settings, camera, pose, opened)

        control_loop = build_control_loop(settings, params, rover, opened, cycles.handle_cycle, rack, begin_camera)
        log_tap = recorder.log_tap if recorder else None
        try:
            links = open_links(
                settings.endpoints,
                system=system,
                component=COMPONENT,
                wanted=rover.message_ids,
                side=Side.VEHICLE,
                devices=guards.devices,
                wrap=None if faults is None else faults.wrap,
            )
            guards.attach(links)
            if guards.warning:
                log.warning("%s", guards.warning)
            if settings.announce:
                announce(settings.endpoints, system, opened)
            status = f"system {system}, {', '.join(settings.endpoints)}"
            return await _drive(control_loop, links, status, guards.notes, notifier, cycles, log_tap)
        except BaseException as error:
            control_loop.abort(error, loop.time())
            raise
        finally:
            control_loop.close()


async def _drive(
    control_loop: ControlLoop,
    links: Sequence[Link],
    status: str,
    notes: Sequence[str],
    notifier: Notifier,
    cycles: CycleObserver,
    log_tap: LogTap | None,
) -> int:
    runner = Runner(control_loop, links, period=CYCLE, log_tap=log_tap)
    shutdown = Shutdown(control_loop, runner, notifier.stopping)
    cycles.shutdown = shutdown
    shutdown.install_handlers(asyncio.get_running_loop())
    startup_gc.resume()
    log.info("ready, %s", status)
    for note in notes:
        log.info("%s", note)
    notifier.ready(status)
    return await shutdown.wait()
