"""Views of the message log."""

from __future__ import annotations

from groundstation.snapshot import LogLine
from groundstation.views.base import View, ViewRequest


class LogRequest(ViewRequest, frozen=True):
    """Lines of the message log."""

    after: int = 0
    """Lines that are new, or were counted again, since this state of the log: LogPage.state of the newest page."""


class LogPage(View, frozen=True):
    """Lines of the message log, oldest first; at most message_log.PAGE of them."""

    lines: tuple[LogLine, ...]
    state: int
    """State of the log after these lines. A screen that requests the lines after it loses none and gets none twice."""
    after: int = 0
    """That of the request: a page for the screen that was open before must not pass for an answer to this one."""
