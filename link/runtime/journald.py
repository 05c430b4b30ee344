"""Severities for systemd's journal, which takes them from `<N>` in front of a line (sd-daemon(3)); none elsewhere."""

from __future__ import annotations

import os

CRITICAL, ERROR, WARNING, INFO, DEBUG = 2, 3, 4, 6, 7
"""syslog(3)"""
STDERR = 2


def priority_prefix(severity: int) -> str:
    """What stands in front of a line on stderr."""
    return f"<{severity}>" if _stderr_is_journal() else ""


def _stderr_is_journal() -> bool:
    """Whether stderr goes to the journal.

    The variable alone does not say so, because all children inherit it, a terminal of a desktop among them; so it names
    the device and inode of the stream (systemd.exec(5)).
    """
    try:
        stream = os.fstat(STDERR)
    except OSError:  # closed
        return False
    return os.environ.get("JOURNAL_STREAM") == f"{stream.st_dev}:{stream.st_ino}"
