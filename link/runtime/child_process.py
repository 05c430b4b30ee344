"""Starts our own programs as child processes, with the same Python and packages as this one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import IO

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
"""A text: a program with Rover imports pathlib, which takes 4 ms, while its process starts."""

PR_SET_PDEATHSIG = 1
"""prctl(2): the kernel sends a signal when the parent dies, even by kill -9."""
KERNEL_TELLS_OF_DEATH = sys.platform == "linux"
MORTAL_MODULE = "link.runtime.mortal_module"
"""Runs a program that ends with a pipe, for other kernels."""


def start_module(
    module: str,
    arguments: Sequence[str],
    *,
    output: IO[bytes] | int = subprocess.DEVNULL,
    pass_fds: Sequence[int] = (),
    new_session: bool = False,
    ends_with_us: bool = False,
) -> subprocess.Popen[bytes]:
    """Start `python -m module arguments` without our standard streams: only the screen uses the terminal.

    `output` receives what the program prints. `ends_with_us`: it gets SIGTERM when this process ends, even by kill -9.
    Raises OSError.
    """
    words, prepare = [module, *arguments], None
    if ends_with_us and KERNEL_TELLS_OF_DEATH:
        prepare = _end_with_parent()
    elif ends_with_us:
        pipe = _life_line()
        words, pass_fds = [MORTAL_MODULE, str(pipe), *words], [*pass_fds, pipe]
    # -P: a folder named like one of our packages in the current directory must not be imported instead of ours.
    return subprocess.Popen(
        [sys.executable, "-P", "-m", *words],
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=output,
        pass_fds=pass_fds,
        start_new_session=new_session,
        preexec_fn=prepare,
        env=child_environment(),
    )


def end_with_us(number: int = signal.SIGTERM) -> Callable[[], None] | None:
    """Return the `preexec_fn` of a foreign program, to which Linux sends a signal when this thread ends; else None."""
    return _end_with_parent(number) if KERNEL_TELLS_OF_DEATH else None


@cache
def _life_line() -> int:
    """Return the end of a pipe that ends with this process; its other end stays open here, and in no fork."""
    theirs, ours = os.pipe()
    kept = [ours]
    os.register_at_fork(after_in_child=lambda: os.close(kept.pop()) if kept else None)  # once: the number is used again
    return theirs


def _end_with_parent(number: int = signal.SIGTERM) -> Callable[[], None]:
    """Return what a child runs before its program, so that the kernel sends it a signal when we die."""
    import ctypes  # by those that need it: it takes 5 ms

    parent = os.getpid()
    prctl = ctypes.CDLL(None).prctl  # looked up before the fork: as little as possible may run after it

    def prepare() -> None:
        prctl(PR_SET_PDEATHSIG, number)
        if os.getppid() != parent:  # it died before the kernel was told
            os._exit(1)

    return prepare


def child_environment() -> dict[str, str]:
    """Return our environment; in a checkout that is not installed, with its folder on the path, which -P removes."""
    if not os.path.exists(os.path.join(ROOT, "pyproject.toml")):
        return dict(os.environ)
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [ROOT, os.environ.get("PYTHONPATH")]))}


def end_process(process: subprocess.Popen[bytes], timeout: float) -> int:
    """Wait up to `timeout` s, then kill. Returns the exit code; negative for a signal."""
    try:
        return process.wait(timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()
