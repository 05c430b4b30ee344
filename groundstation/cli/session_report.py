"""What is printed after a session: which vehicles are left armed, and where its log is."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Sequence
from pathlib import Path

from link.runtime import stdio


def report_session(armed: Sequence[str], logs: Sequence[str]) -> None:
    """Print what is left armed, and the logs of the session; the terminal may be closed."""
    with contextlib.suppress(OSError):
        for line in (*armed, *map(_describe_log, logs)):
            sys.stderr.write(f"groundstation: {stdio.escape(line)}\n")
            sys.stderr.flush()


def _describe_log(name: str) -> str:
    """Return where a log is, how long it is, and for how long a vehicle drove in it."""
    from groundstation.ui.base.local_files import short_path
    from groundstation.ui.files.log_summary import read_summary
    from groundstation.ui.replay.model import duration_text

    path = Path(name)
    found = read_summary(path)
    if found is None or found.length is None:
        return f"log: {short_path(path)}"
    driven = (
        f", driven {duration_text(found.driven)}" if found.driven else ", nothing was armed" if found.armed == 0 else ""
    )
    return f"log: {short_path(path)} ({duration_text(found.length)}{driven})"
