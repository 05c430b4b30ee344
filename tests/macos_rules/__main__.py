"""Run tests with every program that they start under the rules of macOS: `python -m tests.macos_rules [TESTS]`.

Options of pytest go to it: `--last-failed` runs again what has failed, one test at a time.
"""

from __future__ import annotations

import sys
import time

import pytest

SELECTION = (
    "tests/macos_rules",
    "tests/e2e/test_stop_matrix.py",
    "tests/e2e/test_in_tmux.py::test_the_first_drive[80-24]",
    "tests/e2e/test_station_process_lost.py",
    "tests/groundstation/watchdog/test_killed_stations.py",
    "tests/groundstation/test_shared_station.py",
    "tests/groundstation/sitl/test_sitl.py",
    "tests/groundstation/verbs/session/test_through_a_station.py",
)
"""Station, screen in tmux, verbs through a station, watchdog, and the stop matrix."""
LEFT_OUT = (
    "tests/e2e/test_stop_matrix.py::test_a_lossy_link",
    "tests/e2e/test_stop_matrix.py::test_link_cut_and_back_with_the_key_held_all_along",
    "tests/e2e/test_stop_matrix.py::test_a_stop_key_in_a_burst_wins",
    "tests/e2e/test_stop_matrix.py::test_a_key_held_over_another_screen_does_not_drive",
    "tests/groundstation/verbs/session/test_through_a_station.py::test_verbs_in_a_row_leak_nothing",
)
"""About networks, keys and memory, which are the same everywhere, and long."""
CACHE = ".pytest_cache/macos"
"""Apart from that of other runs: it has what failed."""
WORKERS = 2
"""They wait for programs most of the time, as the tests that CI runs beside them do."""


def main(words: list[str]) -> int:
    """Run the tests, with workers unless there are words; return pytest's exit code."""
    named = any(not each.startswith("-") for each in words)
    chosen = [] if named else [*SELECTION, *(f"--deselect={each}" for each in LEFT_OUT)]
    workers = [] if words else [f"-n{WORKERS}", "--dist=loadfile"]  # keeps the names for --last-failed
    begun = time.monotonic()
    common = ["-p", "tests.macos_rules.forced", "-o", f"cache_dir={CACHE}", "-q", "--durations=8"]
    code = pytest.main([*common, *workers, *chosen, *words])
    print(f"macos_rules: {time.monotonic() - begun:.0f} s")
    return int(code)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
