"""Detects that nobody is attached to the tmux session that the screen runs in.

tmux answers the pings of the screen (tty_ping.py) itself, also when its last client was detached or killed, as by a
lost SSH connection. So tmux is asked who its clients are, and over what they reach it.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import subprocess
import time
from collections.abc import Mapping, Sequence

from groundstation.ui.terminal.frozen_terminal import find_proxy_of_clients

PERIOD = 1.0
"""s between questions; each starts a process, which takes a few ms of processor time."""

ANSWER_WITHIN = 2.0
"""s for tmux to answer; after that it is not known who is attached."""

RELEASE_AFTER = 3.0
"""s without a client after which control is released: a dropped connection may come back at once."""

QUESTION = ("tmux", "list-clients", "-F", "#{client_pid}", "-t")
"""The name of a pane follows; it stands for its session."""


class TmuxSession:
    """Who is attached, by the newest answer. `pane` is TMUX_PANE; None outside of tmux. Times are of time.monotonic."""

    def __init__(self, pane: str | None) -> None:
        self._pane = pane
        self._had_client = False
        self._detached_at: float | None = None
        self._released = False
        self.away: float | None = None
        """For how many s nobody was attached, if control was released in that time; None once we are in control again.
        """
        self.proxy = ""
        """What hides a frozen terminal of a client, e.g. "tmux over ssh"; "" if nothing is known that does."""
        self._controls_any = self._was_without = False
        self._task: asyncio.Task[None] | None = None

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] = os.environ) -> TmuxSession:
        """Return the session that this process runs in."""
        return cls(environment.get("TMUX_PANE") if environment.get("TMUX") else None)

    @property
    def detached(self) -> bool:
        """Nobody is attached."""
        return self._detached_at is not None

    def update(self, clients: Sequence[int] | None, now: float) -> None:
        """Handle an answer, the process ids of the clients; None: not known, which changes nothing.

        A session that never had a client is a script's.
        """
        if clients is None:
            return
        self.proxy = find_proxy_of_clients(clients)
        self._had_client = self._had_client or bool(clients)
        if not clients and self._had_client and self._detached_at is None:
            self._detached_at, self._released, self.away = now, False, None
        elif clients and self._detached_at is not None:
            self.away = now - self._detached_at if self._released else None
            self._detached_at, self._was_without = None, False

    def pop_release(self, now: float) -> bool:
        """Return True once when nobody was attached for RELEASE_AFTER and there is control to release."""
        if self._detached_at is None or self._released or now - self._detached_at < RELEASE_AFTER:
            return False
        self._released = self._controls_any
        return self._released

    def handle_control(self, in_control: bool, *, any_vehicle: bool = False) -> None:
        """Set whether we are in control of the vehicle on the screen, and whether another one may be ours."""
        self._controls_any = in_control or any_vehicle
        if in_control and self._was_without:
            self.away = None
        self._was_without = not in_control

    # ---- asking tmux ----

    def ask(self) -> None:
        """Ask tmux now, and wait for its answer, if there is one."""
        if self._pane is not None:
            with contextlib.suppress(OSError, subprocess.SubprocessError):
                words = [*QUESTION, self._pane]
                done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, timeout=ANSWER_WITHIN)
                self.update(_read_clients(done.returncode, done.stdout), time.monotonic())

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Ask tmux from now on, if there is one."""
        if self._pane is not None:
            self._task = loop.create_task(self._watch(self._pane))

    def stop(self) -> None:
        """Stop asking."""
        if self._task is not None:
            self._task.cancel()

    async def _watch(self, pane: str) -> None:
        while True:
            self.update(await find_clients(pane), time.monotonic())
            await asyncio.sleep(PERIOD)


async def find_clients(pane: str) -> Sequence[int] | None:
    """Return the process ids of the clients attached to the session of the pane; None if tmux does not tell."""
    nothing = asyncio.subprocess.DEVNULL
    try:
        process = await asyncio.create_subprocess_exec(
            *QUESTION, pane, stdin=nothing, stdout=asyncio.subprocess.PIPE, stderr=nothing
        )
    except OSError:
        return None
    try:
        async with asyncio.timeout(ANSWER_WITHIN):
            answer, _ = await process.communicate()
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
        return None
    return _read_clients(process.returncode, answer)


def _read_clients(code: int | None, answer: bytes) -> Sequence[int] | None:
    return [int(word) for word in answer.split() if word.isdigit()] if code == 0 else None
