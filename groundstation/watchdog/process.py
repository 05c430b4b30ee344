"""The watchdog's process: a fork of the station's, made before it opens its links.

It shares the station's memory, has a session of its own, so that what ends the whole terminal does not end it, and
waits for reports nearly all the time.
"""

from __future__ import annotations

import contextlib
import gc
import os
import select
import signal
import socket
import time
from collections.abc import Callable

import msgspec

from groundstation.intents.session import Quit
from groundstation.ipc import MAX_PACKET, decode_from_screen, encode
from groundstation.snapshot import StationOutage
from groundstation.watchdog.outlets import Outlets
from groundstation.watchdog.report import MAX_OUTLETS, MAX_REPORT, StationReport, decode_report
from groundstation.watchdog.terminal_reset import LAST_TRY, TerminalReset
from groundstation.watchdog.watchdog import Watchdog
from link.signing.signing import Signing


class WatchdogProcess:
    """Runs the core. `station` is the socket to the station, `screen` the station's end of the pipe to the screen."""

    def __init__(
        self,
        station: socket.socket,
        screen: socket.socket,
        terminal: TerminalReset,
        signing: Signing | None = None,
        read_keys: Callable[[], None] | None = None,
    ) -> None:
        """`read_keys` reads other keys into `signing`, when a report says that they have changed."""
        self._station = station
        self._screen = screen
        self._terminal: TerminalReset | None = terminal
        self._watchdog = Watchdog(signing)
        self._read_keys, self._keys_version = read_keys, 0
        self._outlets = Outlets()
        self._shown = StationOutage()
        self._screen_gone = self._station_gone = self._screen_has_quit = False
        self._reading: set[int] = set()

    def run(self) -> None:
        """Run until the station has ended and the vehicles have got their neutral."""
        while not self._watchdog.finished(time.monotonic()):
            self._wait()
            now = time.monotonic()
            for route, target, frame in self._watchdog.tick(now):
                self._watchdog.record_sent(target, self._outlets.write(route, frame))
            outage = self._watchdog.outage(now)
            self._show(outage)
            if self._station_gone or outage.text:
                self._reset_terminal()
        self._check_screen()
        self._reset_terminal(LAST_TRY)

    def _wait(self) -> None:
        """Wait for the next event and handle it. All waiting reports come first: this process may have stood still."""
        timeout = self._watchdog.timeout(time.monotonic())
        waiting = select.poll()
        if not self._station_gone:
            waiting.register(self._station, select.POLLIN)
        if not self._screen_gone:
            waiting.register(self._screen, 0)
        for descriptor in self._reading:
            waiting.register(descriptor, select.POLLIN)
        for descriptor, _ in waiting.poll(None if timeout is None else 1000 * timeout):
            if descriptor == self._station.fileno():
                self._read_reports()
            elif descriptor == self._screen.fileno():
                self._screen_gone = True
            else:
                self._read_vehicle(descriptor)

    def _read_reports(self) -> None:
        while True:
            try:
                data, descriptors, _, _ = socket.recv_fds(self._station, MAX_REPORT, MAX_OUTLETS)
            except BlockingIOError:
                return
            except OSError:
                data, descriptors = b"", []
            if not data:
                self._handle_station_end()
                return
            self._handle_report(decode_report(data), descriptors)

    def _handle_report(self, report: StationReport, descriptors: list[int]) -> None:
        if report.keeps_descriptors:
            self._outlets.update(report.routes)
        else:
            self._outlets.replace(descriptors, report.routes)
        if self._read_keys is not None and report.keys_version != self._keys_version:
            self._keys_version = report.keys_version
            self._read_keys()
        self._watchdog.handle_report(report, time.monotonic())
        self._screen_has_quit |= report.screen_has_quit
        if report.screen_is_gone:
            self._reset_terminal()

    def _handle_station_end(self) -> None:
        self._station_gone = True
        self._watchdog.handle_end(time.monotonic())
        self._reading = set(self._outlets.descriptors)  # nobody else reads them any more

    def _read_vehicle(self, descriptor: int) -> None:
        now = time.monotonic()
        try:
            for frame in self._outlets.read(descriptor, now):
                self._watchdog.handle_frame(frame, now)
        except (BlockingIOError, ConnectionRefusedError):
            return
        except (OSError, EOFError):
            self._reading.discard(descriptor)

    def _show(self, outage: StationOutage) -> None:
        if outage != self._shown:
            with contextlib.suppress(OSError):  # a screen that does not read gets it later; one that is gone does not
                self._screen.send(encode(outage))
                self._shown = outage

    def _check_screen(self) -> None:
        """Look once more whether the screen is gone: both processes may have been killed together."""
        look = select.poll()
        look.register(self._screen, 0)
        self._screen_gone = bool(look.poll(0))

    def _reset_terminal(self, within: float = 0.0) -> None:
        """Reset the terminal once, if the screen is gone and has not left it in order. `within`: s to wait for room."""
        if self._terminal is None or not self._screen_gone or self._screen_has_quit or self._finds_quit():
            return
        if self._terminal.run(within):
            self._terminal = None

    def _finds_quit(self) -> bool:
        """Return whether the screen has quit, by what the station did not read any more."""
        while True:
            try:
                packet = self._screen.recv(MAX_PACKET)
            except OSError:
                return False
            if not packet:
                return False
            with contextlib.suppress(msgspec.DecodeError):
                self._screen_has_quit |= any(isinstance(each, Quit) for each in decode_from_screen(packet).intents)
                if self._screen_has_quit:
                    return True


def fork_watchdog(
    screen: socket.socket,
    terminal: str | None,
    signing: Signing | None = None,
    read_keys: Callable[[], None] | None = None,
) -> tuple[int, socket.socket]:
    """Start the process; return its id and the socket to it. Call before there is any thread. Raises OSError."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    for half in (ours, theirs):
        half.setblocking(False)
    reset = TerminalReset(terminal)
    gc.freeze()  # memory that no collection touches stays shared
    process = os.fork()
    if process:
        theirs.close()
        return process, ours
    code = 1
    try:
        ours.close()
        _run(WatchdogProcess(theirs, screen, reset, signing, read_keys))
        code = 0
    finally:
        os._exit(code)


def _run(process: WatchdogProcess) -> None:
    gc.disable()
    os.setsid()
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    process.run()
