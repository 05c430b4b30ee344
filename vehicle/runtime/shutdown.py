"""How a run ends: by a signal, by a fault in a callback, because a ground station asked; the motors always first."""

from __future__ import annotations

import asyncio
import logging
import signal
from collections.abc import Callable

from link.runner import Runner
from vehicle.commands.reboot import RebootRequest
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError
from vehicle.rover import Rover
from vehicle.runtime.host_info import HostMonitor
from vehicle.runtime.systemd import Notifier

log = logging.getLogger(__name__)

STOPPED = 0
"""Exit code of a run that was asked to end."""

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Asked to stop: by the service manager, by Ctrl-C, by a terminal that was closed."""


class Shutdown:
    """How the run ends from outside the cores: asked by a signal, or by a fault in a callback of the loop."""

    def __init__(self, machine: ControlLoop, runner: Runner, stopping: Callable[[], None] = lambda: None) -> None:
        """`stopping` is called once the motors stand."""
        self._stopping = stopping
        self._machine = machine
        self._runner = runner
        self._reason: str | None = None
        self._fault: Exception | None = None
        self._code = STOPPED

    def install_handlers(self, loop: asyncio.AbstractEventLoop) -> None:
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

    def handle_reboot_request(self, leave: RebootRequest) -> None:
        """A ground station asked for it."""
        if self._reason is None:
            self._code = int(leave)
        self._end(f"{leave.label} as a ground station asked, motors neutral")

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


class CycleObserver:
    """What follows from a completed control cycle: the watchdog is fed, the host is looked at, and a wish to leave is
    heard.
    """

    def __init__(self, rover: Rover, notifier: Notifier, meter: HostMonitor) -> None:
        self.shutdown: Shutdown | None = None
        self._rover = rover
        self._notifier = notifier
        self._meter = meter

    def handle_cycle(self, now: float) -> None:
        """One more."""
        self._notifier.alive(now)
        self._meter.update(now)
        leave = self._rover.reboot_request(now)
        if leave is not None and self.shutdown is not None:
            self.shutdown.handle_reboot_request(leave)
