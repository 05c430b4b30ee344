"""Set up the suite: current generated code, repeatable hypothesis in CI, folders of its own for each worker."""

from __future__ import annotations

import gc
import os
import signal
import sys
import tempfile
from collections.abc import Generator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from dialects.fingerprint import fault
from tests import order, suite

MAY_RAISE_PRIORITY = os.geteuid() == 0 and os.getpriority(os.PRIO_PROCESS, 0) == 0
"""Only root may take a lower priority and go back to the one before."""
LOW_PRIORITY = 10
"""nice: a tenth of the processor's time while all workers want it."""

settings.register_profile(
    "mavhelm",
    deadline=None,  # a pause of the machine must not fail an example
    suppress_health_check=[HealthCheck.too_slow],
    max_examples=int(os.environ.get("MAVHELM_EXAMPLES", "100")),  # .ci/run and .ci/coverage need fewer
    derandomize="MAVHELM_CI" in os.environ,  # CI tries the same examples each time; new ones are found on laptops
)
settings.register_profile(
    suite.SHORT,
    settings.get_profile("mavhelm"),
    max_examples=20,
    derandomize=True,  # the same result for everybody
)
settings.load_profile("mavhelm")

if reason := fault():
    raise SystemExit(reason)  # here and not in a hook, because other conftest.py files import the dialect


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add --suite."""
    parser.addoption(
        "--suite", choices=suite.SUITES, help="which tests run (default: short; all where files or tests are named)"
    )
    parser.addoption("--kind", choices=order.KINDS, help="of these, tests that wait for programs or those that compute")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return the workers of `-n auto`: three for two processors, because many tests wait for programs."""
    return max(1, 3 * (os.cpu_count() or 1) // 2)


def pytest_configure(config: pytest.Config) -> None:
    """Choose the suite, and give each worker folders of its own: your files and stations are not for tests."""
    config.option.suite = suite.chosen(config)  # xdist passes it on to its workers
    config.option.loadscopereorder = False  # of xdist: tests/order.py knows which group takes longest
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # of a shell's `&`: programs would inherit it, deaf to Ctrl-C
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if config.option.suite == suite.SHORT:
        settings.load_profile(suite.SHORT)
    # Each of the programs that the tests start would compile its 300 to 500 modules again, and each worker the tests.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    for variable in ("XDG_STATE_HOME", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR"):
        folder = tempfile.TemporaryDirectory(prefix="mavhelm-tests-")
        os.environ[variable] = folder.name
        config.add_cleanup(folder.cleanup)
    for variable in ("MAVHELM_ENDPOINT", "MAVHELM_CONFIG"):
        os.environ.pop(variable, None)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Exempt what is collected from garbage collection.

    It is kept to the end, and the passes over its objects take 30 % of the CPU time of the suite.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.set_threshold(50_000, 20, 20)
        gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> None:
    """Let tests that compute give way to those that wait in real time, which other workers run."""
    if MAY_RAISE_PRIORITY:
        os.setpriority(os.PRIO_PROCESS, 0, LOW_PRIORITY if order.gives_way(item) else 0)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not import files that have no test of the short suite, or none of the kind that was asked for."""
    if config.option.suite == suite.SHORT and suite.is_long_file(collection_path):
        return True
    kind: str | None = config.option.kind
    return True if kind and collection_path.suffix == ".py" and order.has_none(collection_path, kind) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Choose the suite, and spread the tests that wait."""
    ours, others = suite.split(items, config.option.suite)
    if config.option.kind:
        ours, of_other_kind = order.of_kind(ours, config.option.kind)
        others += of_other_kind
    elif lost := order.left_out(ours):
        raise pytest.UsageError(f"tests would be in no --kind: MARKED in tests/order.py finds no marker in {lost[0]}")
    if others:
        config.hook.pytest_deselected(items=others)
    items[:] = order.mix(ours)
