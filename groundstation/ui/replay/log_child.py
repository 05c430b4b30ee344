"""LogChild: a telemetry log that is opened from the running app, by `mavhelm replay` in the same terminal."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from textual.app import App

from groundstation.snapshot import Snapshot
from groundstation.ui.terminal.console_driver import ConsoleDriver

ENDING = ".tlog"

IN_REPLAY = "this is a replay: Ctrl-Q ends it, then o opens another log"
ARMED = "disarm first: a vehicle is armed from here, and no key reaches it while a log is shown"
NO_TERMINAL = "a log is opened in a terminal only: mavhelm replay FILE"
NO_LOG = "choose a telemetry log (.tlog) of this machine first"

END_WITHIN = 0.5
"""s for the child to leave the terminal when this app ends; less than EXIT_TIMEOUT."""

STOP_POLL = 0.1
"""s between two looks whether the child was stopped (Ctrl-Z)."""


def find_refusal(now: Snapshot, file: Path | None) -> str:
    """Return why a log is not opened now; "" if it may be."""
    vehicle = now.vehicle
    if now.replay is not None:
        return IN_REPLAY
    if now.left_armed or (vehicle is not None and vehicle.armed and vehicle.in_control):
        return ARMED
    return "" if file is not None and file.name.endswith(ENDING) else NO_LOG


def replay_command(file: Path, at: str, options: Sequence[str]) -> list[str]:
    """Return the command that shows a log, from a time on."""
    begin = [f"--at={at}"] if at else []
    return [sys.executable, "-m", "groundstation", "replay", *options, *begin, "--", str(file.absolute())]


class LogChild:
    """Lends the terminal to one child at a time. The loop, the lease and the link to the station go on meanwhile.

    `options` returns those of the child; `say` shows how it ended; `close_gate` closes the key gate before it starts.
    """

    def __init__(
        self,
        app: App[Any],
        options: Callable[[], Sequence[str]],
        say: Callable[[str], None],
        close_gate: Callable[[], None],
        returned: Callable[[], object] = lambda: None,
    ) -> None:
        """Lend nothing yet. `returned` is called when the terminal is back."""
        self._returned = returned
        self._app, self._options, self._say, self._close_gate = app, options, say, close_gate
        self._task: asyncio.Task[None] | None = None
        self._process: asyncio.subprocess.Process | None = None
        self._after: Callable[[], object] | None = None

    @property
    def running(self) -> bool:
        """The terminal belongs to the child."""
        return self._task is not None

    def open(self, now: Snapshot, file: Path | None, at: str = "") -> str:
        """Show a log from a time on; return why not, "" if it is shown."""
        driver: object = self._app._driver
        refusal = find_refusal(now, file)
        if refusal or file is None or self.running:
            return refusal
        if not isinstance(driver, ConsoleDriver):
            return NO_TERMINAL
        self._task = asyncio.get_running_loop().create_task(
            self._show(driver, replay_command(file, at, self._options()))
        )
        self._close_gate()
        return ""

    def end(self, after: Callable[[], object]) -> None:
        """End the child, if one runs, and call `after` when the terminal is back."""
        if not self.running:
            after()
            return
        self._after = after
        self._signal(signal.SIGTERM)
        asyncio.get_running_loop().call_later(END_WITHIN, self._signal, signal.SIGKILL)

    def _signal(self, number: int) -> None:
        if self._process is not None:
            with contextlib.suppress(ProcessLookupError):
                self._process.send_signal(number)

    async def _show(self, driver: ConsoleDriver, command: Sequence[str]) -> None:
        problem = ""
        with self._app.suspend(), driver.lend() as returned:
            try:
                problem = await self._run(command, driver.terminal.fileno())
            except OSError as error:
                problem = error.strerror or str(error)
            returned(self._process is None or (self._process.returncode or 0) >= 0)
        self._task = self._process = None
        self._returned()
        if self._after is not None:
            self._after()
        elif problem:
            self._say(problem)

    async def _run(self, command: Sequence[str], terminal: int) -> str:
        """Run the child to its end; return what went wrong."""
        pipe = asyncio.subprocess.PIPE
        process = self._process = await asyncio.create_subprocess_exec(*command, stdout=terminal, stderr=pipe)
        if self._after is not None:
            self._signal(signal.SIGTERM)
        stopping = asyncio.ensure_future(_stop_with(process.pid))
        _, told = await process.communicate()
        stopping.cancel()
        code = process.returncode or 0
        if code < 0:
            return f"the replay was ended by signal {-code}"
        lines = told.decode("utf-8", "replace").splitlines() or [f"the replay ended with exit code {code}"]
        return lines[-1].removeprefix("mavhelm: ") if code else ""


async def _stop_with(child: int) -> None:
    """Stop this process whenever the child has stopped, so that the shell takes the terminal; `fg` continues both."""
    while hasattr(os, "waitid"):
        await asyncio.sleep(STOP_POLL)
        if _is_stopped(child):
            os.kill(os.getpid(), signal.SIGSTOP)


def _is_stopped(child: int) -> bool:
    """Return, once for each stop, whether the child was stopped. Leaves its end to the event loop."""
    return os.waitid(os.P_PID, child, os.WSTOPPED | os.WNOHANG) is not None
