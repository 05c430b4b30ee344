"""Runs `mavhelm` with its standard input as controlling terminal, whose end is then SIGHUP. Started by tab.py."""

from __future__ import annotations

import fcntl
import runpy
import termios

if __name__ == "__main__":
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    runpy.run_module("groundstation", run_name="__main__", alter_sys=True)
