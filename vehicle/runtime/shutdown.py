"""Shutdown by a signal, by an exception in a callback, or on request of a ground station; the motors stop first."""

from __future__ import annotations

import asyncio
import logging
import signal
from collections.abc import Callable

from link.runner import Runner
from link.transport.faults.faulty_transport import LinkFaults
from vehicle.commands.reboot import RebootRequest
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError
from vehicle.rover import Rover
from vehicle.runtime.camera_link import CameraLink
from vehicle.runtime.host_info import HostMonitor
from vehicle.runtime.link_guards import LinkGuards
from vehicle.runtime.systemd import Notifier
from vehicle.runtime.vehicle_keys import VehicleKeys

log = logging.getLogger(__name__)

STOPPED = 0
"""Exit code of a requested stop."""

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Requests to stop: from the service manager, by Ctrl-C, by closing the terminal."""


class Shutdown:
    """Ends the run: stops the motors, sends the last messages, and gives the exit code or the exception."""

    def __init__(self, control_loop: ControlLoop, runner: Runner, stopping: Callable[[], None] = lambda: None) -> None:
        """Prepare a shutdown; `stopping` is called once the motors are stopped."""
        self._stopping = stopping
        self._control_loop = control_loop
        self._runner = runner
        self._reason: str | None = None
        self._fault: Exception | None = None
        self._code = STOPPED

    def install_handlers(self, loop: asyncio.AbstractEventLoop) -> None:
        """Handle signals and exceptions in callbacks of the loop."""
        for number in SIGNALS:
            loop.add_signal_handler(number, self._end, f"stopped by {number.name}, motors neutral")
        loop.set_exception_handler(lambda _, context: self._end("", context.get("exception"), context["message"]))

    async def wait(self) -> int:
        """Run until the end and return the exit code. Raises the exception that ended the run."""
        await self._runner.run()
        if self._fault is not None:
            raise self._fault
        log.info("%s", self._reason)
        return self._code

    def handle_reboot_request(self, leave: RebootRequest) -> None:
        """End the run with the exit code of a restart, reboot or power-off that a ground station requested."""
        if self._reason is None:
            self._code = int(leave)
        self._end(f"{leave.label} as requested by a ground station, motors neutral")

    def _end(self, reason: str, fault: Exception | None = None, message: str = "") -> None:
        """Stop the motors, then the runner, which sends the last messages. Only the first call has an effect."""
        if self._reason is not None:
            return
        self._reason = reason
        self._fault = fault or (RuntimeError(message) if message else None)
        try:
            self._control_loop.shutdown(asyncio.get_running_loop().time())
        except Exception as error:
            self._fault = MotorError(f"the motors could not be stopped, cut their power: {error}")
        self._stopping()
        self._runner.stop()


class CycleObserver:
    """The daemon's work after a control cycle: watchdog, host info, keys, camera, link faults, a reboot request."""

    def __init__(
        self,
        rover: Rover,
        notifier: Notifier,
        host_monitor: HostMonitor,
        keys: VehicleKeys | None = None,
        guards: LinkGuards | None = None,
        faults: LinkFaults | None = None,
    ) -> None:
        self.shutdown: Shutdown | None = None
        self.camera: CameraLink | None = None
        self._rover = rover
        self._notifier = notifier
        self._host_monitor = host_monitor
        self._keys = keys
        self._guards = guards
        self._faults = faults

    def handle_cycle(self, now: float) -> None:
        """Feed the watchdog, update host info, keys, camera and faults of the links, and handle a reboot request."""
        self._notifier.alive(now)
        self._host_monitor.update(now)
        if self._keys is not None:
            self._keys.poll(now)
        if self._guards is not None:
            self._guards.poll(now)
        if self.camera is not None:
            self.camera.update(now)
        if self._faults is not None:
            self._faults.update(any(self._rover.outputs.throttles), now)
        leave = self._rover.reboot_request(now)
        if leave is not None and self.shutdown is not None:
            self.shutdown.handle_reboot_request(leave)
