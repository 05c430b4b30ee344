"""Set up the suite: current generated code, repeatable hypothesis in CI, state and config folders for each worker."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from typing import TypeVar

import pytest
from hypothesis import HealthCheck, settings

from dialects.fingerprint import fault

LONG_TIMEOUT = 300
"""s for a test that starts programs or simulates many minutes; a busy machine takes ten times as long."""
LONG_MARKERS = ("slow", "e2e", "interop")
LONG_UNTIL = 0.85
"""Share of the other tests before the last long one begins, so that none is left alone at the end."""

Kind = TypeVar("Kind")

settings.register_profile(
    "mavhelm",
    deadline=None,  # a pause of the machine must not fail an example
    suppress_health_check=[HealthCheck.too_slow],
    derandomize="MAVHELM_CI" in os.environ,  # CI tries the same examples each time; new ones are found on laptops
)
settings.load_profile("mavhelm")

if reason := fault():
    raise SystemExit(reason)  # here and not in a hook, because other conftest.py files import the dialect


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return the workers of `-n auto`: three for two processors, because many tests wait for programs."""
    return max(1, 3 * (os.cpu_count() or 1) // 2)


def pytest_configure(config: pytest.Config) -> None:
    """Give each worker a state and a config folder of its own: a vehicle locks its one, yours are not for tests."""
    for variable in ("XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        folder = tempfile.TemporaryDirectory(prefix="mavhelm-tests-")
        os.environ[variable] = folder.name
        config.add_cleanup(folder.cleanup)
    for variable in ("MAVHELM_ENDPOINT", "MAVHELM_CONFIG"):
        os.environ.pop(variable, None)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Give LONG_TIMEOUT to the tests with one of LONG_MARKERS, unless they have a timeout of their own.

    With several workers, also spread these tests over the others: they wait more than they compute.
    """
    for item in items:
        if item.get_closest_marker("timeout") is None and _is_long(item):
            item.add_marker(pytest.mark.timeout(LONG_TIMEOUT))
    if "PYTEST_XDIST_WORKER" in os.environ:
        items[:] = spread(items, _is_long)


def _is_long(item: pytest.Item) -> bool:
    return any(map(item.get_closest_marker, LONG_MARKERS))


def spread(items: Sequence[Kind], is_long: Callable[[Kind], bool]) -> list[Kind]:
    """Return the items with the long ones evenly over the first LONG_UNTIL of the others; else in their order."""
    longs = [item for item in items if is_long(item)]
    others = [item for item in items if not is_long(item)]
    step = LONG_UNTIL * len(others) / max(1, len(longs))
    places = [*((number * step, item) for number, item in enumerate(longs)), *enumerate(others)]
    return [item for _, item in sorted(places, key=lambda place: place[0])]
