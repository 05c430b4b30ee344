"""The watchdog's process: a fork of the station's, made before it opens its links.

It shares the station's memory, has a session of its own, so that what ends the whole terminal does not end it, and
waits for reports nearly all the time.
"""

from __future__ import annotations

import gc
import os
import select
import signal
import socket
import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from groundstation.watchdog.outlets import Outlets
from groundstation.watchdog.report import MAX_OUTLETS, MAX_REPORT, StationReport, decode_report
from groundstation.watchdog.terminal_reset import LAST_TRY, TerminalReset
from groundstation.watchdog.watchdog import Watchdog
from link.runtime.local_socket import open_pair
from link.signing.signing import Signing

if TYPE_CHECKING:
    from groundstation.watchdog.screen_end import ScreenEnd


class WatchdogProcess:
    """Runs the core. `station` is the socket to the station, which does not block; a verb has no `screen`."""

    def __init__(
        self,
        station: socket.socket,
        screen: ScreenEnd | None,
        terminal: TerminalReset,
        signing: Signing | None = None,
        read_keys: Callable[[], None] | None = None,
    ) -> None:
        """`read_keys` reads other keys into `signing`, when a report says that they have changed."""
        self._station = station
        self._screen = screen
        self._terminal = terminal
        self._watchdog = Watchdog(signing)
        self._read_keys, self._keys_version = read_keys, 0
        self._outlets = Outlets()
        self._station_gone = self._screen_has_quit = False
        self._reading: set[int] = set()

    def run(self) -> None:
        """Run until the station has ended and the vehicles have got their neutral."""
        while not self._watchdog.finished(now := time.monotonic()):
            ready = self.wait(self._watchdog.timeout(now))
            self.step(ready, time.monotonic())
        self.finish()

    def wait(self, timeout: float | None) -> list[int]:
        """Return the descriptors that have an event, after at most `timeout` s; None waits without an end."""
        waiting = select.poll()
        if not self._station_gone:
            waiting.register(self._station, select.POLLIN)
        if self._screen is not None and not self._screen.gone:
            waiting.register(self._screen.fileno(), select.POLLIN)
        for descriptor in self._reading:
            waiting.register(descriptor, select.POLLIN)
        return [descriptor for descriptor, _ in waiting.poll(None if timeout is None else 1000 * timeout)]

    def step(self, ready: Iterable[int], now: float) -> None:
        """Handle what waits in `ready`, then send what is due at `now`.

        All waiting reports come first: this process may have stood still.
        """
        for descriptor in ready:
            self._handle_event(descriptor, now)
        for route, target, frame in self._watchdog.tick(now):
            self._watchdog.record_sent(target, self._outlets.write(route, frame))
        outage = self._watchdog.outage(now)
        if self._screen is not None:
            self._screen.show(outage)
        if outage.text:
            self._reset_terminal()

    def finish(self) -> None:
        """Reset the terminal if the screen is gone by now: both processes may have been killed together."""
        if self._screen is not None:
            self._screen.read()
        if self._needs_reset():
            self._terminal.insist(LAST_TRY)

    def _handle_event(self, descriptor: int, now: float) -> None:
        if descriptor == self._station.fileno():
            self._read_reports(now)
        elif self._screen is not None and descriptor == self._screen.fileno():
            self._screen.read()
        else:
            self._read_vehicle(descriptor, now)

    def _read_reports(self, now: float) -> None:
        while True:
            try:
                data, descriptors, _, _ = socket.recv_fds(self._station, MAX_REPORT, MAX_OUTLETS)
            except BlockingIOError:
                return
            except OSError:
                data, descriptors = b"", []
            if not data:
                self._handle_station_end(now)
                return
            self._handle_report(decode_report(data), descriptors, now)

    def _handle_report(self, report: StationReport, descriptors: list[int], now: float) -> None:
        if report.keeps_descriptors:
            self._outlets.update(report.routes)
        else:
            self._outlets.replace(descriptors, report.routes)
        if self._read_keys is not None and report.keys_version != self._keys_version:
            self._keys_version = report.keys_version
            self._read_keys()
        self._watchdog.handle_report(report, now)
        self._screen_has_quit |= report.screen_has_quit
        if report.screen_is_gone:
            self._reset_terminal()

    def _handle_station_end(self, now: float) -> None:
        self._station_gone = True
        self._watchdog.handle_end(now)
        self._reading = set(self._outlets.descriptors)  # nobody else reads them any more

    def _read_vehicle(self, descriptor: int, now: float) -> None:
        try:
            for frame in self._outlets.read(descriptor, now):
                self._watchdog.handle_frame(frame, now)
        except (BlockingIOError, ConnectionRefusedError):
            pass  # it may send later
        except (OSError, EOFError):
            self._reading.discard(descriptor)

    def _reset_terminal(self) -> None:
        """Reset the terminal once it has room; this process has no time to wait for that."""
        if self._needs_reset():
            self._terminal.run()

    def _needs_reset(self) -> bool:
        """Return whether the screen is gone and has not left the terminal in order."""
        screen = self._screen
        return screen is not None and screen.gone and not (screen.has_quit or self._screen_has_quit)


def fork_watchdog(
    screen: socket.socket | None,
    terminal: str | None,
    signing: Signing | None = None,
    read_keys: Callable[[], None] | None = None,
    of_station: socket.socket | None = None,
) -> tuple[int, socket.socket]:
    """Start the process; return its id and the socket to it. Call before there is any thread. Raises OSError.

    `screen` leads to the screen; None: there is none.
    `of_station`, the station's own socket to the screen, is closed in the process: the screen sees the station's end.
    """
    ours, theirs = open_pair()
    for half in (ours, theirs):
        half.setblocking(False)
    end = _open_screen(screen)
    reset = TerminalReset(terminal)
    gc.freeze()  # memory that no collection touches stays shared
    process = os.fork()
    if process:
        theirs.close()
        return process, ours
    try:
        ours.close()
        if of_station is not None:
            of_station.close()
        _run(WatchdogProcess(theirs, end, reset, signing, read_keys))
    finally:
        os._exit(0)


def _open_screen(screen: socket.socket | None) -> ScreenEnd | None:
    if screen is None:
        return None
    from groundstation.watchdog.screen_end import (
        ScreenEnd,  # with all intents, which the watchdog of a verb does without
    )

    return ScreenEnd(screen)


def _run(process: WatchdogProcess) -> None:
    gc.disable()
    os.setsid()
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    process.run()
