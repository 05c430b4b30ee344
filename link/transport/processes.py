"""The processes of this machine, as /proc shows them: names, and what each has open."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

PROC = Path("/proc")


def other_processes(proc: Path = PROC) -> Iterator[Path]:
    """Yield the folder of each process but ours."""
    with contextlib.suppress(OSError):
        for entry in sorted(os.listdir(proc)):
            if entry.isdigit() and int(entry) != os.getpid():
                yield proc / entry


def open_files(process: Path, prefix: str) -> Iterator[str]:
    """Yield what a process has open, e.g. "/dev/ttyS0" or "socket:[4711]", as far as it starts with `prefix`.

    Processes of other users hide it.
    """
    with contextlib.suppress(OSError):
        for descriptor in os.listdir(process / "fd"):
            with contextlib.suppress(OSError):
                target = os.readlink(process / "fd" / descriptor)
                if target.startswith(prefix):
                    yield target


def program_name(process: Path) -> str:
    """Return the name of the program; "?" if the process has ended."""
    with contextlib.suppress(OSError):
        return "".join(filter(str.isprintable, (process / "comm").read_text("utf-8", "replace").strip()))
    return "?"


def describe_process(process: Path) -> str:
    """Return the program with its process id, e.g. "screen (pid 412)"."""
    return f"{program_name(process)} (pid {process.name})"
