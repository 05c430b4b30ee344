"""Runs a module as a program that ends with its parent, where the kernel does not offer that (prctl of Linux).

Run as `python -m link.runtime.mortal_module DESCRIPTOR MODULE ARGUMENTS...` by child_process.start_module.
"""

from __future__ import annotations

import contextlib
import os
import runpy
import signal
import sys
import threading


def _end_with(pipe: int) -> None:
    """Terminate this process when the other end of the pipe, which nobody writes to, is closed."""
    with contextlib.suppress(OSError):
        os.read(pipe, 1)
    os.kill(os.getpid(), signal.SIGTERM)


def main() -> None:
    """Run the module."""
    _, pipe, module, *arguments = sys.argv
    threading.Thread(target=_end_with, args=(int(pipe),), name="parent", daemon=True).start()
    sys.argv = [module, *arguments]
    runpy.run_module(module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
