"""SessionRecorder: records one session from its first vehicle on, and says what becomes of that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from dialects.enums import Severity
from groundstation.recording.log_folder import LogFolder
from groundstation.snapshot import RecordingView
from link.tlog.recorder import SLOW, Recorder

PERIOD = 0.05
"""s between two writes: less than the 0.1 s between two ticks, so that each tick writes, and a kill -9 loses less than
0.2 s."""

RETRY, RETRY_MAX = 10.0, 300.0
"""s before a disk that has failed is tried again: at first, and at most."""

STEADY = 30.0
"""s of recording after which a failure counts as over: a disk that is nearly full takes a little each time."""

WORKS_AFTER = 1.0
"""s without an error after which a file that was opened anew is shown as recording."""


class News(NamedTuple):
    """One line for the log."""

    text: str
    severity: Severity


class SessionRecorder:
    """Frames go to `recorder`; `tick` starts it, tries again after a failure, and returns the news.

    Without a vehicle nothing is written. A failure is said once, until recording has been steady again.
    """

    def __init__(self, folder: LogFolder) -> None:
        self.recorder = Recorder(period=PERIOD)
        self._folder = folder
        self._shown: str = ""
        """Path that was said."""
        self._failed: str | None = None
        """What was said of a failure that is not over."""
        self._said_slow = False
        self._retry_at = math.inf
        self._delay = RETRY
        self._works_since = math.inf

    def tick(self, now: float, *, vehicle: bool) -> list[News]:
        """Let time pass. `vehicle`: one is known."""
        if not self.recorder.recording:
            if vehicle:
                self._start(now)
            return []
        failure = self.recorder.failure
        self.recorder.tick(now)
        if failure is not None:
            return list(self._handle_failure(failure, now))
        return list(self._follow(now))

    def close(self) -> None:
        """Write the rest and close the file."""
        self.recorder.close()

    def view(self, now: float) -> RecordingView | None:
        """Return what is shown of the recording; None before it begins."""
        if not self.recorder.recording:
            return None
        current = self._folder.current
        return RecordingView(
            path=str(current.path) if current is not None else "",
            seconds=now - current.begun if current is not None else 0.0,
            size=self._folder.size,
            problem="" if self._works(now) else self._failed or "",
        )

    def _works(self, now: float) -> bool:
        return self.recorder.failure is None and now - self._works_since >= WORKS_AFTER

    def _start(self, now: float) -> None:
        self._retry_at, self._works_since = math.inf, now
        self.recorder.start(self._folder.open)

    def _handle_failure(self, failure: str, now: float) -> Iterator[News]:
        if self._retry_at == math.inf:
            self._retry_at, self._delay = now + self._delay, min(2 * self._delay, RETRY_MAX)
        if self._failed is None:
            self._failed = f"not recording: {failure} ({self._folder.path})"
            yield News(f"{self._failed}; driving goes on, and it is tried again", Severity.WARNING)
        if now >= self._retry_at:
            self._start(now)

    def _follow(self, now: float) -> Iterator[News]:
        current = self._folder.current
        path = "" if current is None else str(current.path)
        if self._failed is not None and path and now - self._works_since >= STEADY:
            self._failed, self._delay, self._shown = None, RETRY, path
            yield News(f"recording again to {path}", Severity.NOTICE)
        elif self._failed is None and path not in ("", self._shown):
            self._shown = path
            yield News(f"recording to {path}", Severity.INFO)
        if self.recorder.lost and not self._said_slow:
            self._said_slow = True
            yield News(f"recording: {SLOW}", Severity.WARNING)
