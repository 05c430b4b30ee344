"""Pictures among the lines of the screens: how this terminal shows them, and when it may have the next one."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping

from groundstation.pictures.budget import LOCAL_BYTES, REMOTE_BYTES
from groundstation.pictures.line_budget import LineBudget
from groundstation.pictures.protocol import QUERY, Protocol, TerminalAnswers, choose_protocol
from groundstation.ui.terminal.console_driver import PING
from groundstation.ui.terminal.tty_ping import TerminalPing

DRAW_PERIOD = 0.1
"""s between two pictures that are drawn, at least."""
POLL = 0.02
"""s until the answer behind a picture is looked for again."""


class PictureOutput:
    """One terminal. `write` writes to it; without it, as in tests of screens, nothing is asked and bounded.

    Its answers are handled in the input thread, which only sets what is read here.
    """

    def __init__(
        self,
        write: Callable[[str], None] | None = None,
        ping: TerminalPing | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self.answers = TerminalAnswers()
        self._write, self._ping, self._environment = write, ping, environment
        self._budget = LineBudget(REMOTE_BYTES if environment.get("SSH_CONNECTION") else LOCAL_BYTES)
        self._asked = False
        self._draw_at = 0.0
        self._protocols: dict[tuple[bool, bool], Protocol] = {}
        """ASCII only, and kitty graphics answered -> how pictures are drawn."""

    def ask(self) -> None:
        """Ask the terminal what it can, the first time.

        tmux is not asked for kitty graphics: it takes the question for a title, and passes no answer on.
        """
        if self._write is not None and not self._asked:
            self._asked = True
            self._write(QUERY[QUERY.index("\x1b[") :] if self._environment.get("TMUX") else QUERY)

    def protocol(self, *, ascii_only: bool) -> Protocol:
        """Return how pictures are drawn. Not by sixel: that takes 30 to 250 ms of Python, while keys wait."""
        key = ascii_only, self.answers.complete and self.answers.kitty
        if key not in self._protocols:
            answers = self.answers if self.answers.complete else TerminalAnswers()
            self._protocols[key] = choose_protocol(answers, self._environment, ascii_only=ascii_only, sixel=False)
        return self._protocols[key]

    @property
    def level(self) -> int:
        """How coarse pictures are; 0 is fine."""
        return self._budget.level

    def wait(self) -> float:
        """Return for how many s no picture may be drawn, as far as is known now; 0: one may be."""
        now = time.monotonic()
        if self._ping is not None and (took := self._ping.pop_frame_time()) is not None:
            self._budget.note_read(took, self._ping.quickest)
        if now < self._draw_at:
            return self._draw_at - now
        return 0.0 if self._write is None or self._budget.may_draw(now) else POLL

    def choose_level(self, size_of: Callable[[int], int], coarsest: int) -> None:
        """Choose how coarse the next picture is. `size_of`: level -> bytes."""
        if self._write is not None:
            self._budget.choose_level(size_of, coarsest, time.monotonic())

    def note_frame(self, size: int) -> None:
        """Send a ping behind a picture of so many bytes that was drawn."""
        now = time.monotonic()
        self._draw_at = now + DRAW_PERIOD
        if self._write is not None and self._ping is not None:
            self._budget.note_frame(size, now)
            self._ping.send_behind_frame(now)
            self._write(PING)

    def write(self, text: str) -> None:
        """Write what is no line of a screen."""
        if text and self._write is not None:
            self._write(text)
