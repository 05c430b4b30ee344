"""StationHost: runs one station with its links, its screens and its watchdog in this process."""

from __future__ import annotations

import asyncio
import logging
import signal
import socket
from collections.abc import Callable, Sequence
from typing import Any

from dialects.enums import Severity, StationEventKind
from dialects.printable import printable
from groundstation.connect.link_manager import LinkManager
from groundstation.connect.signing import StationSigning
from groundstation.disk.file_jobs import FileJobs
from groundstation.host.camera_receiver import CameraReceiver
from groundstation.host.programs import ProgramSet
from groundstation.host.screens import Lifetime, ScreenSet
from groundstation.host.snapshot_sender import SlotTimer, SnapshotSender
from groundstation.intents.driving import Stop
from groundstation.intents.session import Quit
from groundstation.intents.union import AnyIntent
from groundstation.recording.station_recording import StationRecording
from groundstation.sitl.sitl import SimulatorControl
from groundstation.station.driving.stops.shutdown import DISARM_AFTER, DISARM_TIMEOUT
from groundstation.station.process.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from groundstation.watchdog.feed import WatchdogFeed
from link.protocol.sent_frames import SentFrames
from link.runner import Runner
from link.transport.transport import Link

log = logging.getLogger(__name__)

TICK = 0.025
"""s between ticks while something is under way; demands, and what ends them, have times of their own (`due_at`)."""

END_WITHIN = 1.0
"""s for the final neutral frames (0.25 s are needed); then the process exits in any case."""

QUIT = Quit()


class StationHost:
    """One station, its links, its screens, and the simulator if it started one."""

    def __init__(
        self,
        station: Station,
        links: Sequence[Link],
        pipe: socket.socket | None,
        watchdog: WatchdogFeed,
        *,
        ids: tuple[int, int],
        sent: SentFrames,
        lifetime: Lifetime = Lifetime.SCREEN,
        screen: str = "first screen",
        recording: StationRecording | None = None,
        signing: StationSigning | None = None,
        simulators: SimulatorControl | None = None,
        video_limit: int = 0,
    ) -> None:
        """`pipe` leads to the screen that has started this process, `screen` is its name; None: there is none.

        `video_limit`: MB of recorded pictures, 0 for none.
        """
        self._station = station
        self._pipe, self._screen = pipe, screen
        self.screens = ScreenSet(station, self, lifetime)
        self._snapshots = SnapshotSender(station, self.screens)
        self._watchdog = watchdog
        self._core = CrashNeutral(station)
        self._recording = recording
        self._signing = signing
        self._runner = Runner(
            self._core,
            links,
            period=TICK,
            broken=self._handle_crash,
            log_tap=recording.log_tap if recording else None,
            sent=watchdog.record_sent,
            signing=signing.link_signing if signing else None,
        )
        self._programs = ProgramSet(station, self.screens, self._runner.flush)
        self._disk = FileJobs(station, self._runner.flush)
        self._camera = CameraReceiver(station, recording, video_limit)
        self.connect = LinkManager(self._runner, station, ids, sent, simulators)
        self._slots = SlotTimer(self._keep_up, self._snapshots.call_period)
        self._broken = self._ending = False

    async def run(self, listens: Callable[[], None]) -> int:
        """Run until the station ends. Returns the exit code: 1 after an unhandled exception.

        `listens` is called once other programs can use the station, or it is known why they cannot.
        """
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(self._handle_loop_exception)
        for number in (signal.SIGTERM, signal.SIGHUP, *((signal.SIGINT,) if self._pipe is None else ())):
            loop.add_signal_handler(number, self._shut_down)
        if self._pipe is not None:
            self.screens.add(self._pipe, self._screen, owner=True)
        if problem := self._programs.start():
            self.add_to_log(loop.time(), f"no other program can use this station: {problem}")
        listens()
        self._slots.start()
        self._station.on_rest_end = self._slots.resume_full_rate
        self._station.fleet.on_first = lambda: loop.call_soon(lambda: self._snapshots.send(loop.time()))
        try:
            await self._runner.run()
        finally:
            self._slots.end()
            self._programs.close()
            self.connect.close()
            self._disk.close()
            self._watchdog.close()
            self._camera.close()
            if self._signing:
                self._signing.close()
            if self._recording:
                self._recording.close()  # last: it may wait for the disk
        return 1 if self._broken else 0

    # ---- screens ----

    def handle(self, intent: AnyIntent, now: float, read_at: float) -> None:
        """Carry out an intent of a screen."""
        self._snapshots.pace.note(now)
        self._slots.resume_full_rate()
        self._station.handle_intent(intent, now, read_at=read_at)

    def flush(self) -> None:
        """Send what intents have caused, and read and write their files."""
        self._disk.run()
        self._runner.flush()

    def note_screen(self, *, quits: bool, now: float) -> None:
        """Tell the watchdog, which resets the terminal of a screen that was killed."""
        self._watchdog.set_flags(**{"screen_has_quit" if quits else "screen_is_gone": True})
        self._report(now)

    def end(self, intent: Quit) -> None:
        """Exit; a second request may only decide that vehicles are left armed."""
        if not self._ending:
            self._shut_down(intent)
        elif not self._broken:
            self._station.handle_intent(intent, asyncio.get_running_loop().time())

    def _report(self, now: float) -> None:
        """Tell the watchdog that the station runs."""
        if not self._watchdog.report(self._station.report_to_watchdog(now), now, rests=self._station.rests):
            self.add_to_log(now, "the watchdog has ended: if this process is killed, nothing sends neutral")

    def _keep_up(self, now: float) -> None:
        """Do what is due for the links, report to the watchdog, and send what the screens do not have yet."""
        self._poll_keys(now)
        self._report(now)
        self.connect.tick(now)
        if self._recording:
            self._recording.tick(now)
        self._disk.run()
        self._camera.tick(now)
        self._snapshots.send_due(now)

    def _poll_keys(self, now: float) -> None:
        """Take over keys that have changed: for all links, and for the watchdog, which goes on in our place."""
        text = self._signing.poll(now) if self._signing else None
        if self._signing is None or text is None:
            return
        for link in self._runner.links:
            link.channel.guard = self._signing.link_signing.guard(link.channel.index)
        self._watchdog.set_flags(keys_version=self._signing.version)
        self.add_to_log(now, text)

    def add_to_log(self, now: float, text: str, severity: Severity = Severity.WARNING) -> None:
        """Write a line to the log on the screen and to the log file."""
        log.log(logging.WARNING if severity <= Severity.WARNING else logging.INFO, text)
        self._station.log.add(now, "station", text, severity)

    # ---- shutdown ----

    def _shut_down(self, intent: Quit = QUIT) -> None:
        """Send neutral several times, disarm if requested, then exit."""
        if self._ending:
            return
        self._ending = True
        self._programs.refuse()
        loop = asyncio.get_running_loop()
        self._programs.end_verbs()
        self._station.handle_intent(Stop("quitting"), loop.time())
        self._station.handle_intent(intent, loop.time())
        self._runner.flush()
        self._end_when_finished(loop.time() + END_WITHIN + (DISARM_AFTER + DISARM_TIMEOUT if intent.disarm else 0.0))

    def _end_when_finished(self, deadline: float) -> None:
        loop = asyncio.get_running_loop()
        if self._core.finished or loop.time() >= deadline:
            if not self._broken:
                self._snapshots.send(loop.time())  # tells the screen what is left armed
            self._runner.stop()
        else:
            loop.call_later(TICK, self._end_when_finished, deadline)

    def _handle_crash(self, error: BaseException) -> None:
        """Send neutral several times after an unhandled exception, then exit: half a station must not look alive."""
        if self._broken:
            return
        self._broken = self._ending = True
        self._programs.refuse()
        self._slots.end()
        now = asyncio.get_running_loop().time()
        what = printable(f"station crashed ({type(error).__name__}: {error}): sending neutral, then exiting")
        log.critical(what, exc_info=error)
        self._core.activate(now)
        self._runner.flush()
        self._snapshots.send_crash(what, now)
        self._end_when_finished(now + END_WITHIN)
        self._station.notes.add(now, StationEventKind.DECISION, what, Severity.CRITICAL)

    def _handle_loop_exception(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Handle an exception in a callback of the loop that is not the runner's."""
        self._handle_crash(context.get("exception") or RuntimeError(str(context.get("message"))))
