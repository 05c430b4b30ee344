"""The daemon's end of the camera: starts its process, and tells it whom to send to. Never waits for it."""

from __future__ import annotations

import contextlib
import logging
import subprocess
from collections.abc import Callable, Sequence

import msgspec

from link.runtime.child_process import end_process, start_module
from link.runtime.local_socket import open_pair
from link.transport.backoff import Backoff
from vehicle.camera.camera import Camera, CameraReport
from vehicle.camera.orders import Orders, Setup
from vehicle.camera.scene import Pose, ScenePoint

MODULE = "vehicle.camera.process"
PERIOD = 0.04
"""s between two orders while somebody watches: a simulated picture shows where the rover is."""
END_TIMEOUT = 0.5
"""s for the process to end with the daemon, after which it is killed."""
REPORT_MAX = 4096
RESTART, RESTART_MAX = 1.0, 30.0
"""s before the process is started again, at first and at most."""
STEADY = 60.0
"""s that it must run for the next end to count as a first one."""

log = logging.getLogger(__name__)


class CameraLink:
    """One process of a camera, started again after it has ended: after 1 s, 2 s, 4 s and so on."""

    def __init__(
        self, camera: Camera, pose: Callable[[], Pose] = Pose, walls: Sequence[tuple[ScenePoint, ScenePoint]] = ()
    ):
        """`pose` returns where the simulated rover is. Raises OSError."""
        self.camera = camera
        self._pose = pose
        self._setup = msgspec.json.encode(Setup(camera.settings, tuple(walls))).decode()
        self._due = self._restart_at = self._started_at = 0.0
        self._problem = ""
        self._ended = False
        self._backoff = Backoff(RESTART, RESTART_MAX)
        self._start()

    def _start(self) -> None:
        """Start the process. Raises OSError."""
        self._sent: Orders | None = None
        self._pipe, theirs = open_pair()
        self._pipe.setblocking(False)
        with theirs:
            options = [f"--fd={theirs.fileno()}", f"--setup={self._setup}"]
            self._process: subprocess.Popen[bytes] = start_module(
                MODULE, options, pass_fds=[theirs.fileno()], new_session=True, ends_with_us=True
            )

    @property
    def pid(self) -> int:
        """Process id of the camera: of the newest process."""
        return self._process.pid

    def update(self, now: float) -> None:
        """Send orders that are due, and take reports; after each cycle."""
        if now < self._due:
            return
        self._due = now + PERIOD
        if not self._runs(now):
            return
        targets = self.camera.targets(now)
        orders = Orders(targets, self._pose() if targets else Pose())
        if orders != self._sent:
            with contextlib.suppress(OSError):  # it stands still or has ended: the next orders replace these
                self._pipe.send(msgspec.json.encode(orders))
                self._sent = orders
        self._take_reports(now)

    def close(self) -> None:
        """End the process: it ends with its end of the socket."""
        self._pipe.close()
        end_process(self._process, END_TIMEOUT)

    def _runs(self, now: float) -> bool:
        """Return whether the process runs; start it again when that is due."""
        if not self._ended:
            if (code := self._process.poll()) is None:
                return True
            self._pipe.close()
            self._ended = True
            if now - self._started_at > STEADY:
                self._backoff.reset()
            delay = self._backoff.next_delay()
            self._restart_at = now + delay
            self._say(f"Camera process ended ({code}), restart in {delay:g} s")
        elif now >= self._restart_at:
            self._started_at, self._restart_at = now, now + self._backoff.next_delay()
            try:
                self._start()
                self._ended = False
            except OSError as error:
                self._say(f"Camera does not start: {error.strerror}")
        return False

    def _say(self, text: str) -> None:
        log.warning("%s", text)
        self.camera.tell(text)

    def _take_reports(self, now: float) -> None:
        try:
            data = self._pipe.recv(REPORT_MAX)
        except OSError:
            return
        if not data:
            return
        report = msgspec.json.decode(data, type=CameraReport)
        self.camera.note_report(report, now)
        if report.problem and report.problem != self._problem:
            log.warning("camera: %s", report.problem)
        self._problem = report.problem
