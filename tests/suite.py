"""Which tests run: `pytest` alone runs the short suite, `--suite all` every test, `--suite rest` those that are left.

The short suite is for everybody who has a clone: the cores and the safety code in virtual time, all that needs no other
program, and the main job with the real ones. It takes 200 s of CPU and skips nothing with the packages of the extra
`test`. A new test belongs to it, unless one of MARKERS or a row of LONG says otherwise; of a long table of parameters
ROWS do. Tests that are named on the command line always run.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Sequence
from pathlib import Path

import pytest

SHORT, REST, ALL = SUITES = ("short", "rest", "all")
TESTS = Path(__file__).parent

MARKERS = ("slow", "e2e", "interop", "tmux")
"""Tests with one of them are not in the short suite, but for those of MAIN_JOB."""
MARKED = ("e2e", "interop")
"""Folders in which every test has one."""

LONG = (
    "benchmarks", "test_benchmark_run.py", "fuzz", "mutation", "recipes", "soak", "test_examples.py",
    "test_release.py::test_a_signature",
    "test_keys_to_motion.py::test_every_key_and_chord", "test_missions.py", "test_roaming.py",
    "test_secure_by_default.py::test_no_data_becomes_code",
    "dialects/extra", "dialects/test_build.py", "dialects/test_fingerprint.py::test_pytest_stops",
    "link/bridge/test_bridge.py", "link/runtime/test_stdio.py", "link/services/param/test_recorded_params.py",
    "link/signing/test_c_library.py", "link/signing/test_verifier.py::test_81",
    "vehicle/accessories/test_accessory_missions.py", "vehicle/autonomy/mission", "vehicle/autonomy/modes",
    "vehicle/autonomy/test_navigator.py", "vehicle/cli/test_motor_test.py", "vehicle/cli/test_systemd_unit.py",
    "vehicle/commands/test_go_to.py", "vehicle/commands/test_params.py::test_an_unsaved_value_is_retried",
    "vehicle/machine", "vehicle/motors/test_pins.py", "vehicle/sensors/test_gps.py::test_a_real_gpsd",
    "vehicle/storage/test_tlog_files.py::test_a_real_card",
    "groundstation/cli/test_keys_verb.py", "groundstation/connect", "groundstation/export", "groundstation/gamepad",
    "groundstation/replay", "groundstation/station/services/test_file_transfers.py",
    "groundstation/station/driving/test_freeze.py",
    "groundstation/station/messages/test_recorded_traffic.py", "groundstation/test_foreign_missions.py",
    "groundstation/ui/app/test_command_line.py", "groundstation/ui/app/test_help.py",
    "groundstation/ui/charts/test_screen.py", "groundstation/ui/connect/test_screen.py",
    "groundstation/ui/drive/test_screen.py", "groundstation/ui/files/test_screen.py",
    "groundstation/ui/links/test_screen.py", "groundstation/ui/log/test_screen.py",
    "groundstation/ui/map/test_screen.py", "groundstation/ui/messages/test_screen.py",
    "groundstation/ui/params/test_screen.py", "groundstation/ui/setup/test_screen.py",
    "groundstation/ui/terminal/test_escape_sequences.py", "groundstation/ui/app/test_exit.py",
    "groundstation/ui/keys/test_hold.py", "groundstation/ui/terminal/test_interpreter.py",
    "groundstation/ui/terminal/test_mouse.py",
    "groundstation/vehicles/probes/test_dialect_probe.py", "groundstation/vehicles/test_replay.py",
    "groundstation/verbs",
    "groundstation/watchdog/test_watchdog.py::test_after_a_neutral_of_the_watchdog",
)  # fmt: skip
"""Folders, files and tests below tests/ that are not in the short suite either: they take seconds each, or need
programs and packages that a clone alone does not have."""

MAIN_JOB = (
    "groundstation/sitl/test_sitl.py::test_sitl_starts",
    "e2e/test_stop_matrix.py::test_key_released", "e2e/test_stop_matrix.py::test_terminal_closed",
    "e2e/test_stop_matrix.py::test_ground_station", "e2e/test_stop_matrix.py::test_quit_by_key",
    "e2e/test_stop_matrix.py::test_vehicle_told_to_end", "e2e/test_station_process_lost.py::test_our_rover_stops",
    "e2e/test_handover.py::test_given_control_stops", "e2e/test_serial_and_tcp.py::test_ground_station_killed",
    "e2e/test_serial_and_bridge.py", "vehicle/runtime/test_daemon.py::test_a_signal_while_driving",
    "vehicle/safety/test_estop_button.py", "groundstation/verbs/line", "groundstation/verbs/control/test_arm.py",
    "groundstation/verbs/control/test_stops.py",
)  # fmt: skip
"""Tests that are in it all the same: starting, driving, every way to die, serial lines, the bridge, and the verbs that
arm and stop."""

ROWS = 6
"""Rows of one parametrised test in the short suite at most, evenly from its table; the others are in the rest."""

APPS = "groundstation/ui"
"""A coroutine below this folder drives the whole program with its screens: 0.1 to 1 s of CPU each."""


def chosen(config: pytest.Config) -> str:
    """Return the suite that was asked for, or that goes with the paths on the command line."""
    named = config.args_source != pytest.Config.ArgsSource.TESTPATHS
    suite: str | None = config.option.suite
    return suite or (ALL if named else SHORT)


def is_long_file(path: Path) -> bool:
    """Return whether a file, or every file of a folder, is not in the short suite, so that it need not be imported."""
    name = _below(path)
    if any(_covers(row, name) or row.startswith((f"{name}/", f"{name}::")) for row in MAIN_JOB):
        return False
    return any(_covers(row, name) for row in (*LONG, *MARKED))


def is_short(item: pytest.Item) -> bool:
    """Return whether a test is in the short suite."""
    name = _name_of(item)
    if _is_main_job(item):
        return True
    if any(_covers(row, name) for row in LONG) or any(mark.name in MARKERS for mark in item.iter_markers()):
        return False
    return not (name.startswith(APPS) and inspect.iscoroutinefunction(getattr(item, "obj", None)))


def split(items: Sequence[pytest.Item], suite: str) -> tuple[list[pytest.Item], list[pytest.Item]]:
    """Return the tests of a suite, and the others."""
    if suite == ALL:
        return list(items), []
    short = set(map(id, _thinned([item for item in items if is_short(item)])))
    ours = [(id(item) in short) == (suite == SHORT) for item in items]
    pairs = list(zip(items, ours, strict=True))
    return [item for item, our in pairs if our], [item for item, our in pairs if not our]


def _thinned(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Return the items with at most ROWS of each parametrised test, but for those of MAIN_JOB."""
    rows: dict[str, list[pytest.Item]] = {}
    for item in items:
        rows.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept: list[pytest.Item] = []
    for of_one in rows.values():
        kept += of_one if _is_main_job(of_one[0]) else of_one[:: math.ceil(len(of_one) / ROWS)]
    return kept


def _is_main_job(item: pytest.Item) -> bool:
    name = _name_of(item)
    return any(_covers(row, name) for row in MAIN_JOB)


def _name_of(item: pytest.Item) -> str:
    return f"{_below(item.path)}::{item.nodeid.partition('::')[2]}"


def _below(path: Path) -> str:
    return path.relative_to(TESTS).as_posix() if path.is_relative_to(TESTS) else path.as_posix()


def _covers(row: str, name: str) -> bool:
    """Return whether a row names a folder or file, one above it, or the start of a test's name."""
    return name == row or name.startswith((f"{row}/", f"{row}::")) or ("::" in row and name.startswith(row))
