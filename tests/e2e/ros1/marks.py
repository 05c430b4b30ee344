"""Mark of tests that need ROS 1: CI has it, and elsewhere they are skipped without it."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from tests.e2e.ros1.rig import SYSTEM_PYTHON
from tests.waits import PATIENCE

INSTALLED = Path(__file__).parent / "installed.py"
PACKAGES = "python3-roslaunch python3-rospy python3-geometry-msgs python3-sensor-msgs python3-nav-msgs"


def _has_ros() -> bool:
    """Return whether all of ROS 1 that these tests use is installed."""
    words = [SYSTEM_PYTHON, str(INSTALLED)]
    try:
        return subprocess.run(words, capture_output=True, timeout=PATIENCE).returncode == 0
    except OSError:
        return False


NEEDS_ROS = pytest.mark.skipif(
    "MAVHELM_CI" not in os.environ and not _has_ros(),
    reason=f"ROS 1 or a part of it is not installed (Debian: {PACKAGES})",
)
