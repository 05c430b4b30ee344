"""Starts our own programs as child processes, with the same Python and packages as this one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

ROOT = Path(__file__).resolve().parents[2]

PR_SET_PDEATHSIG = 1
"""prctl(2): the kernel sends a signal when the parent dies, even by kill -9."""


def start_module(
    module: str,
    arguments: Sequence[str],
    *,
    output: IO[bytes] | int = subprocess.DEVNULL,
    pass_fds: Sequence[int] = (),
    new_session: bool = False,
    prepare: Callable[[], None] | None = None,
) -> subprocess.Popen[bytes]:
    """Start `python -m module arguments` without our standard streams: only the screen uses the terminal.

    `output` receives what the program prints; `prepare` runs in the child before the program. Raises OSError.
    """
    # -P: a folder named like one of our packages in the current directory must not be imported instead of ours.
    return subprocess.Popen(
        [sys.executable, "-P", "-m", module, *arguments],
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=output,
        pass_fds=pass_fds,
        start_new_session=new_session,
        preexec_fn=prepare,
        env=child_environment(),
    )


def end_with_parent() -> Callable[[], None] | None:
    """Return what `prepare` of a child runs so that the kernel terminates it when we die; None except on Linux."""
    if not sys.platform.startswith("linux"):
        return None
    import ctypes  # by those that need it: it takes 5 ms

    prctl = ctypes.CDLL(None).prctl  # looked up before the fork: as little as possible may run after it

    def prepare() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGTERM)

    return prepare


def child_environment() -> dict[str, str]:
    """Return our environment; in a checkout that is not installed, with its folder on the path, which -P removes."""
    if not (ROOT / "pyproject.toml").exists():
        return dict(os.environ)
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))}


def end_process(process: subprocess.Popen[bytes], timeout: float) -> int:
    """Wait up to `timeout` s, then kill. Returns the exit code; negative for a signal."""
    try:
        return process.wait(timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()
