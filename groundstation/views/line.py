"""View of the command line of the screens: how a line has ended, and what completes the one that is typed."""

from __future__ import annotations

from groundstation.views.base import View, ViewRequest

RUNNING, ASKS, DONE, FAILED = "running", "asks", "done", "failed"
"""How a line stands."""


class LineRequest(ViewRequest, frozen=True):
    """How a line stands, and the words that complete a text."""

    number: int = 0
    """Of the newest RunLine; 0: none."""
    text: str = ""
    """What is typed."""
    system: int = 0
    """The vehicle whose parameters and modes complete it."""


class LineView(View, frozen=True):
    """The answer."""

    number: int
    state: str
    """RUNNING, ASKS, DONE or FAILED."""
    note: str
    """One line: the question, or how the line ended."""
    text: str
    """That of the request."""
    words: tuple[str, ...] = ()
    """Words that may stand in place of the last one of the text."""
