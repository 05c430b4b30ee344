"""Speaker: says announcements one after the other in a thread, by a speech program that is bounded in time.

Whoever has something to say never waits: a key must not be late because a program does not start or hangs.
"""

from __future__ import annotations

import contextlib
import subprocess
import threading
import time
from collections.abc import Callable

from groundstation.speech.announcements import Announcement, Priority
from groundstation.speech.programs import SpeechProgram, safe_text

MOST_WAITING = 4
"""Announcements that wait: more would be old when they are said."""
OLD = 8.0
"""s after which one that has waited is left out, unless it is urgent."""
LONGEST_SPEECH = 15.0
"""s after which the program is killed."""
LOOK_PERIOD = 0.05
"""s between two looks whether what is being said is to be ended."""
ENDS_WITHIN = 0.5
"""s for a program that is told to end."""


class Speaker:
    """Says what `say` gets. `clock` is that of the program."""

    def __init__(self, program: SpeechProgram, clock: Callable[[], float] = time.monotonic) -> None:
        self._program, self._clock = program, clock
        self._changed = threading.Condition()
        self._waiting: list[tuple[float, Announcement]] = []
        self._now: Priority | None = None
        """Of what is being said."""
        self._cancelled = self._closed = self.muted = False
        self._thread = threading.Thread(target=self._run, name="mavhelm-speaker", daemon=True)
        self._thread.start()

    def say(self, announcement: Announcement) -> None:
        """Say it when its turn comes. What is urgent ends and removes what is not."""
        with self._changed:
            if self.muted:
                return
            if announcement.priority is Priority.URGENT:
                self._waiting = [each for each in self._waiting if each[1].priority is Priority.URGENT]
                self._cancelled |= self._now is not None and self._now < Priority.URGENT
            elif announcement.priority is Priority.CHATTER and (self._waiting or self._now is not None):
                return
            self._waiting.append((self._clock(), announcement))
            self._waiting.sort(key=lambda each: -each[1].priority)  # stable: the order of time within a priority
            del self._waiting[MOST_WAITING:]
            self._changed.notify()

    def mute(self, muted: bool) -> None:
        """Be silent at once, until this is undone."""
        with self._changed:
            self.muted = muted
            if muted:
                self._waiting.clear()
                self._cancelled = self._now is not None

    def close(self) -> None:
        """End what is being said, and the thread."""
        with self._changed:
            self._closed, self._cancelled = True, True
            self._waiting.clear()
            self._changed.notify()
        self._thread.join(2 * ENDS_WITHIN)

    def _run(self) -> None:
        while (text := self._next()) is not None:
            with contextlib.suppress(OSError):  # the program has been removed, or there is no process left
                self._speak(text)
            with self._changed:
                self._now = None

    def _next(self) -> str | None:
        """Return the next text; None at the end."""
        with self._changed:
            while not self._closed:
                while self._waiting:
                    at, announcement = self._waiting.pop(0)
                    if announcement.priority is Priority.URGENT or self._clock() - at < OLD:
                        self._now, self._cancelled = announcement.priority, False
                        return safe_text(announcement.text)
                self._changed.wait()
        return None

    def _speak(self, text: str) -> None:
        process = _start((*self._program.words, text))
        until = self._clock() + LONGEST_SPEECH
        while not self._cancelled and self._clock() < until:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LOOK_PERIOD)
                return
        process.terminate()
        if self._program.cancel:
            _end(_start(self._program.cancel))
        _end(process)


def _start(words: tuple[str, ...]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )


def _end(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(ENDS_WITHIN)
        return
    process.kill()
    process.wait()
