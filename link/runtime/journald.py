"""Log levels for systemd's journal, which reads them from `<N>` before a line (sd-daemon(3))."""

from __future__ import annotations

import os

CRITICAL, ERROR, WARNING, INFO, DEBUG = 2, 3, 4, 6, 7
"""syslog(3)."""
STDERR = 2


def priority_prefix(severity: int) -> str:
    """Return the text to print before a line on stderr; empty without a journal."""
    return f"<{severity}>" if _stderr_is_journal() else ""


def _stderr_is_journal() -> bool:
    """Return whether stderr goes to the journal.

    The variable alone does not prove that: all child processes inherit it, a desktop's terminal among them. So it holds
    the device and inode of the stream (systemd.exec(5)).
    """
    try:
        stream = os.fstat(STDERR)
    except OSError:  # closed
        return False
    return os.environ.get("JOURNAL_STREAM") == f"{stream.st_dev}:{stream.st_ino}"
