"""Marks of tests that need tmux: CI has it, and elsewhere they are skipped without it."""

from __future__ import annotations

import os
import shutil

import pytest

NEEDS_TMUX = pytest.mark.skipif(
    shutil.which("tmux") is None and "MAVHELM_CI" not in os.environ,
    reason="tmux is not installed: `sudo apt install tmux` to run this test",
)
IN_TMUX = [pytest.mark.e2e, pytest.mark.tmux, NEEDS_TMUX]
