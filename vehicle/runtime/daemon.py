"""The rover daemon: links, rover, motors and signals joined in one process; what is decided is decided in the cores.

Whatever ends it (a signal, a broken driver, a fault in our own code) the order is the same: motors neutral and without
power, last messages, exit code with one line. Exit codes: 0 asked to stop, 1 a fault, 2 the user's mistake, which a
restart cannot mend, 80 to 82 what a ground station asked for (vehicle/commands/reboot.py).
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import logging
import time
from collections.abc import Sequence

from dialects.enums import Severity
from link.endpoint import EndpointError
from link.protocol.log_tap import LogTap
from link.runner import Runner, open_links
from link.runtime.command_line import USAGE_ERROR
from link.runtime.event_loop import run_loop, running_loop
from link.transport.transport import Link, LinkError
from vehicle.commands.context import COMPONENT
from vehicle.config.run_settings import RunSettings, SettingsError
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError, UnknownDriverError
from vehicle.params import ParamError
from vehicle.rover import Rover
from vehicle.runtime.factory import build_accessories, build_control_loop, build_params, build_recorder
from vehicle.runtime.host_info import HostMonitor, read_uid
from vehicle.runtime.lock import lock_state_folder
from vehicle.runtime.shutdown import CycleObserver, Shutdown
from vehicle.runtime.systemd import Notifier
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry.host import HostInfo

log = logging.getLogger(__name__)

PERIOD = 0.02
"""s, the control cycle: 50 Hz is what servos and controllers of this size take, and ten times the driver's own rate."""

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
"""Of STATUSTEXT -> of the log."""

FAULT = 1
"""Exit code, beside MISTAKE and those of vehicle/runtime/shutdown.py.

The unit starts nothing again after MISTAKE, so whatever may be otherwise later is FAULT: a host name that is not known
yet at boot, a port that a program still has.
"""


def run(settings: RunSettings) -> int:
    """Run until asked to stop; the exit code. What goes wrong becomes one line of the log."""
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
        log.critical("%s (--log-file keeps the details)", _told(error), exc_info=True)
        return FAULT


def _told(error: Exception) -> str:
    """A fault in one line. The machine stopped the motors before it let it through, or noted that it could not."""
    notes = getattr(error, "__notes__", [])
    state = f"motors may still turn, cut their power: {'; '.join(notes)}" if notes else "motors neutral"
    return f"{state}; stopped by a fault in the program: {type(error).__name__}: {error}"


def _journal(severity: Severity, text: str) -> None:
    """What ground stations read, for who reads the journal: most of it happens while nobody looks."""
    log.log(LEVELS[severity], "%s", text)


async def _serve(settings: RunSettings) -> int:
    loop = running_loop()
    now, host = loop.time(), HostInfo(uid=read_uid())
    with contextlib.ExitStack() as opened:
        if settings.state is not None:
            opened.enter_context(lock_state_folder(settings.state))
        keeper = None if settings.state is None else ParamStore(settings.state)
        params = build_params(settings, keeper)
        if keeper is not None:
            opened.callback(keeper.close)
        plans = None if settings.state is None else PlanStore(settings.state)
        if plans is not None:
            opened.callback(plans.close)
            for damage in plans.damage.values():
                log.warning("%s: %s", settings.state, damage)
        notifier = Notifier()
        opened.callback(notifier.close)
        system = int(params["MAV_SYSID"])
        recorder = build_recorder(settings, system, opened)
        rack = build_accessories(settings, params)
        rover = Rover(
            params,
            now=now,
            keeper=keeper,
            plan_keeper=plans,
            recording=recorder,
            host=host,
            on_text=_journal,
            rack=rack,
        )
        meter = HostMonitor(host, lambda: loop.idle_time, time.time, now)
        cycles = CycleObserver(rover, notifier, meter)
        machine = build_control_loop(settings, params, rover, opened, cycles.handle_cycle, rack)
        tape = recorder.tape if recorder else None
        try:
            links = open_links(settings.endpoints, system=system, component=COMPONENT, wanted=rover.message_ids)
            status = f"system {system}, {', '.join(settings.endpoints)}"
            return await _drive(machine, links, status, notifier, cycles, tape)
        except BaseException as error:
            machine.abort(error, loop.time())
            raise
        finally:
            machine.close()


async def _drive(
    machine: ControlLoop,
    links: Sequence[Link],
    status: str,
    notifier: Notifier,
    cycles: CycleObserver,
    tape: LogTap | None,
) -> int:
    runner = Runner(machine, links, period=PERIOD, tape=tape)
    ending = Shutdown(machine, runner, notifier.stopping)
    cycles.shutdown = ending
    ending.install_handlers(asyncio.get_running_loop())
    gc.collect()
    gc.freeze()  # a collection of 100 000 start-up objects takes 35 ms, longer than a control cycle
    log.info("ready, %s", status)
    notifier.ready(status)
    return await ending.wait()
