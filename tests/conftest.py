"""Stops, with one line, where a thousand tests would fail for one reason; how hypothesis looks for examples; and where
vehicles keep what is to be kept.
"""

from __future__ import annotations

import os
import tempfile

import pytest
from hypothesis import HealthCheck, settings

from dialects.fingerprint import fault

settings.register_profile(
    "mavhelm",
    deadline=None,  # a machine that pauses is no fault of the example
    suppress_health_check=[HealthCheck.too_slow],
    derandomize="MAVHELM_CI" in os.environ,  # there the same each time: what is new is looked for at home
)
settings.load_profile("mavhelm")

if reason := fault():
    raise SystemExit(reason)  # here and not in a hook: the other conftest.py files import the dialect


def pytest_configure(config: pytest.Config) -> None:
    """A folder of each worker's own, and not yours: a vehicle locks it."""
    state = tempfile.TemporaryDirectory(prefix="mavhelm-tests-")
    os.environ["XDG_STATE_HOME"] = state.name
    config.add_cleanup(state.cleanup)
