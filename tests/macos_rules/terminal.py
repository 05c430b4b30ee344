"""A terminal to kill: runs a program in a pty, prints its pid, and reads what it shows. Run as `python -m`."""

from __future__ import annotations

import os
import pty
import sys

if __name__ == "__main__":
    process, terminal = pty.fork()
    if not process:
        os.environ.update(TERM="xterm-256color", COLUMNS="80", LINES="24")
        os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
    print(process, flush=True)
    while os.read(terminal, 65536):
        pass
