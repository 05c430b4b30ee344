"""The station process: runs the station with its links and the pipe to the screen. It has no terminal."""

from __future__ import annotations

import argparse
import asyncio
import gc
import logging
import secrets
import signal
import socket
import time
from collections.abc import Sequence
from typing import Any

import msgspec

from dialects.enums import Severity
from dialects.extra.errors import DialectError
from dialects.extra.option import Note, use_dialect
from dialects.messages import printable
from groundstation.connect.desk import ConnectDesk
from groundstation.disk.desk import DiskDesk
from groundstation.input.style import Style
from groundstation.intents.driving import Stop
from groundstation.intents.session import Quit, RenewLease
from groundstation.ipc import (
    MAX_INTENT_AGE,
    MAX_PACKET,
    StationFailed,
    StationReady,
    decode_from_screen,
    encode,
)
from groundstation.sitl import free_port
from groundstation.snapshot import Snapshot
from groundstation.station.crash_neutral import CrashNeutral
from groundstation.station.crash_snapshot import crash_snapshot
from groundstation.station.departure import DISARM_AFTER, DISARM_TIMEOUT
from groundstation.station.lasting_alerts import LastingAlerts
from groundstation.station.station import COMPONENT, Station
from groundstation.station_options import log_to, station_parser
from groundstation.texts_folder import load_texts
from groundstation.vehicles.fleet import PLACES
from groundstation.watchdog.feed import WatchdogFeed
from link.endpoint import EndpointError, parse_endpoint
from link.protocol.sent_frames import SentFrames
from link.runner import Runner, open_links
from link.runtime.event_loop import run_loop
from link.transport.local_addresses import LocalAddresses
from link.transport.transport import Link, LinkError

log = logging.getLogger(__name__)

TICK = 0.025
"""s within which the end of a key hold and a due demand are noticed: half of the demands' period, which it keeps."""

SNAPSHOT_PERIOD = 0.1
"""s: as fast as a person can read; the screen draws no faster."""

END_WITHIN = 1.0
"""s for the final neutral frames (0.25 s are needed); then the process exits in any case."""

QUIT = Quit()


class StationProcess:
    """One station, its links, its pipe to the screen, and the simulator if it started one."""

    def __init__(
        self,
        station: Station,
        links: Sequence[Link],
        pipe: socket.socket,
        watchdog: WatchdogFeed,
        *,
        ids: tuple[int, int],
        sent: SentFrames,
    ) -> None:
        self._station = station
        self._pipe = pipe
        self._watchdog = watchdog
        self._core = CrashNeutral(station)
        self._runner = Runner(self._core, links, period=TICK, broken=self._handle_crash, sent=watchdog.record_sent)
        self._disk = DiskDesk(station, self._runner.flush)
        self.connect = ConnectDesk(self._runner, station, ids, sent)
        self._last_snapshot = Snapshot()
        self._addresses = LocalAddresses()
        self._lasting_alerts = LastingAlerts()
        self._broken = self._ending = False

    async def run(self) -> int:
        """Run until the screen quits or exits. Returns the exit code: 1 after an unhandled exception."""
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(self._handle_loop_exception)
        for number in (signal.SIGTERM, signal.SIGHUP):
            loop.add_signal_handler(number, self._shut_down)
        loop.add_reader(self._pipe, self._read_pipe)
        show = loop.create_task(self._send_snapshots())
        try:
            await self._runner.run()
        finally:
            show.cancel()
            loop.remove_reader(self._pipe)
            self.connect.close()
            self._disk.close()
            self._watchdog.close()
        return 1 if self._broken else 0

    # ---- the pipe ----

    def _read_pipe(self) -> None:
        now = asyncio.get_running_loop().time()
        while (packet := self._packet()) is not None:
            if not packet:  # the screen's process has exited, for whatever reason
                asyncio.get_running_loop().remove_reader(self._pipe)
                self._watchdog.set_flags(screen_is_gone=True)
                self._report(now)
                self._shut_down()
                break
            self._handle_packet(packet, now)
        self._runner.flush()
        self._send_views(now)

    def _packet(self) -> bytes | None:
        try:
            return self._pipe.recv(MAX_PACKET)
        except BlockingIOError:
            return None
        except OSError:
            return b""

    def _handle_packet(self, packet: bytes, now: float) -> None:
        try:
            batch = decode_from_screen(packet)
        except msgspec.DecodeError:
            log.exception("invalid packet from the screen")
            return
        late = now - batch.time > MAX_INTENT_AGE
        for intent in batch.intents:
            if late and not intent.valid_when_late:
                if not isinstance(intent, RenewLease):
                    self.add_to_log(
                        now, f"{type(intent).__name__} arrived {now - batch.time:.1f} s late and was dropped"
                    )
            elif isinstance(intent, Quit):
                self._quit(intent, now)
            else:
                self._station.handle_intent(intent, now, read_at=batch.time)
                self.connect.handle(intent, now)
        self._disk.run()

    async def _send_snapshots(self) -> None:
        """Send snapshots at absolute deadlines, and do what is due for the links."""
        loop = asyncio.get_running_loop()
        due = loop.time()
        while not self._broken:
            try:
                self._send_snapshot(loop.time())
            except Exception as error:  # nothing awaits this task, so the exception would be lost
                self._handle_crash(error)
            due = max(due + SNAPSHOT_PERIOD, loop.time())
            await asyncio.sleep(due - loop.time())

    def _report(self, now: float) -> None:
        """Tell the watchdog that the station runs."""
        if not self._watchdog.report(self._station.report_to_watchdog(now), now):
            self.add_to_log(now, "the watchdog has ended: if this process is killed, nothing sends neutral")

    def _send_snapshot(self, now: float) -> None:
        self._report(now)
        self.connect.tick(now)
        self._disk.run()
        self._station.set_addresses(self._addresses.find(now))
        self._last_snapshot = self._station.snapshot(now, time.time())
        for text in self._lasting_alerts.new_in(self._last_snapshot):
            log.warning(text)
        self._send(self._last_snapshot)
        self._send_views(now)

    def _send_views(self, now: float) -> None:
        self._station.views.send_due(self._send, now, time.time())

    def _send(self, message: msgspec.Struct) -> bool:
        """Send now or drop: a screen that does not read gets a newer snapshot later. Return whether it was sent."""
        try:
            self._pipe.send(encode(message))
        except BlockingIOError:
            log.debug("the screen does not read")
        except OSError:
            log.debug("the screen has exited")  # _read_pipe sees the end of the pipe
        else:
            return True
        return False

    def add_to_log(self, now: float, text: str, severity: Severity = Severity.WARNING) -> None:
        """Write a line to the log on the screen and to the log file."""
        log.log(logging.WARNING if severity <= Severity.WARNING else logging.INFO, text)
        self._station.log.add(now, "station", text, severity)

    # ---- shutdown ----

    def _quit(self, intent: Quit, now: float) -> None:
        """Exit; a second request may only decide that vehicles are left armed."""
        self._watchdog.set_flags(screen_has_quit=True)
        self._report(now)
        if not self._ending:
            self._shut_down(intent)
        elif not self._broken:
            self._station.handle_intent(intent, now)

    def _shut_down(self, intent: Quit = QUIT) -> None:
        """Send neutral several times, disarm if requested, then exit."""
        if self._ending:
            return
        self._ending = True
        loop = asyncio.get_running_loop()
        self._station.handle_intent(Stop("quitting"), loop.time())
        self._station.handle_intent(intent, loop.time())
        self._runner.flush()
        self._end_when_finished(loop.time() + END_WITHIN + (DISARM_AFTER + DISARM_TIMEOUT if intent.disarm else 0.0))

    def _end_when_finished(self, deadline: float) -> None:
        loop = asyncio.get_running_loop()
        if self._core.finished or loop.time() >= deadline:
            if not self._broken:
                self._send_snapshot(loop.time())  # tells the screen what is left armed
            self._runner.stop()
        else:
            loop.call_later(TICK, self._end_when_finished, deadline)

    def _handle_crash(self, error: BaseException) -> None:
        """Send neutral several times after an unhandled exception, then exit: half a station must not look alive."""
        if self._broken:
            return
        self._broken = self._ending = True
        now = asyncio.get_running_loop().time()
        what = printable(f"station crashed ({type(error).__name__}: {error}): sending neutral, then exiting")
        log.critical(what, exc_info=error)
        self._core.activate(now)
        self._runner.flush()
        self._send(crash_snapshot(self._last_snapshot, what, time.time()))
        self._end_when_finished(now + END_WITHIN)

    def _handle_loop_exception(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Handle an exception in a callback of the loop that is not the runner's."""
        self._handle_crash(context.get("exception") or RuntimeError(str(context.get("message"))))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a station for the screen at the other end of --fd. Returns 2 if it could not start, after sending why."""
    options = station_parser().parse_args(arguments)
    for number in (signal.SIGINT, signal.SIGTSTP):  # the terminal's keys are for the screen's process
        signal.signal(number, signal.SIG_IGN)
    pipe = socket.socket(fileno=options.fd)
    pipe.setblocking(False)
    watchdog = WatchdogFeed.start(pipe, options.terminal, (options.system, COMPONENT))  # first: it inherits no link
    endpoints = [*options.endpoints, *([f"udpin:127.0.0.1:{free_port()}"] if options.sitl else [])]
    try:
        log_to(options.log_file)
        notes = use_dialect(options.dialect)
        sent = SentFrames()
        links = open_links(endpoints, system=options.system, component=COMPONENT, sent=sent, places=PLACES)
        known = tuple(parse_endpoint(text).text for text in endpoints)
    except (DialectError, EndpointError, LinkError, OSError) as error:
        pipe.send(encode(StationFailed(_one_line(error))))
        return 2
    pipe.send(encode(StationReady(known)))
    return _run(options, known, links, pipe, watchdog, sent, notes)


def _run(
    options: argparse.Namespace,
    endpoints: tuple[str, ...],
    links: list[Link],
    pipe: socket.socket,
    watchdog: WatchdogFeed,
    sent: SentFrames,
    notes: Sequence[Note],
) -> int:
    started = time.monotonic()  # the loop's clock
    session = secrets.randbits(32)
    texts = load_texts(options.param_docs)
    station = Station(
        endpoints,
        system=options.system,
        style=Style(options.style),
        speed=options.speed,
        session=session,
        texts=texts,
        now=started,
    )
    process = StationProcess(station, links, pipe, watchdog, ids=(options.system, COMPONENT), sent=sent)
    for note in notes:
        process.add_to_log(started, note.text, note.severity)
    for problem in texts.problems:
        process.add_to_log(started, problem, Severity.WARNING)
    if options.sitl:
        process.connect.start_simulator(started)
    gc.collect()
    gc.freeze()  # imported objects are never freed; without freezing them a full collection delays demands by 30 ms
    try:
        return run_loop(process.run())
    except Exception:
        log.exception("station crashed")
        return 1


def _one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


if __name__ == "__main__":
    raise SystemExit(main())
