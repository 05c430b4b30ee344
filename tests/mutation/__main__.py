"""Command line of the mutation run; see the package."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from tests.extras import find, needing

with needing("test,mutation"):
    import pytest

    from tests.mutation.child import OPTIONS, Examples
    from tests.mutation.mutants import Mutant, build_mutants
    from tests.mutation.results import Outcome, Result, Results
    from tests.mutation.runner import Runner
    from tests.mutation.survivors import load_explanations, unexplained_and_stale


_VEHICLE_TESTS = (
    "tests/vehicle/drive", "tests/vehicle/safety", "tests/vehicle/commands/test_arming.py",
    "tests/vehicle/commands/test_actuator_test.py", "tests/vehicle/commands/test_buttons.py",
    "tests/vehicle/test_signed_drivers.py",
)  # fmt: skip
_ROLE_TESTS = (
    "tests/link/fleet/test_roles.py", "tests/link/fleet/test_keys.py", "tests/link/fleet/rights",
    "tests/test_bounds.py",
)  # fmt: skip
_STICK_TESTS = tuple(
    f"tests/groundstation/station/driving/test_{name}.py"
    for name in ("operator", "gamepad", "driving", "due_times", "screen_lease", "claims", "emergency")
)
ROOMS: dict[str, tuple[str, ...]] = {
    "vehicle/drive": _VEHICLE_TESTS,
    "vehicle/safety": _VEHICLE_TESTS,
    "link/protocol": ("tests/link/protocol", "tests/test_bounds.py"),
    "link/signing": (
        "tests/link/signing",
        "tests/link/protocol/test_signing_guard.py",
        "tests/vehicle/cli/test_key_command.py",
        "tests/test_bounds.py",
    ),
    "link/fleet/roles.py": _ROLE_TESTS,
    "link/fleet/keys.py": _ROLE_TESTS,
    "link/fleet/rights": _ROLE_TESTS,
    "groundstation/watchdog": ("tests/groundstation/watchdog", "tests/test_bounds.py"),
    "groundstation/input": ("tests/groundstation/input", *_STICK_TESTS, "tests/test_bounds.py"),
    "groundstation/web": ("tests/groundstation/web", "tests/test_bounds.py"),
    "groundstation/station_socket": ("tests/groundstation/station_socket", "tests/test_bounds.py"),
}
"""Folders and modules to mutate: those that decide whether the wheels turn, which frames count and who gets in -> tests
to run against them."""
DESELECTED = (
    "tests/vehicle/safety/test_estop_button.py",
    "tests/groundstation/watchdog/test_killed_stations.py",
    "tests/groundstation/watchdog/test_freezes.py",
)
"""Tests that start a program in a process of its own, which has no mutant."""

LIMIT = 2.0
"""s of tests to run against a mutant: behaviour that takes longer to test needs a test of its own."""


def main() -> int:
    """Run the program; return 1 if survivors and explanations differ, 2 if it cannot run or tests fail unchanged."""
    args = _parse()
    mutants = [mutant for path in _modules(args.paths) for mutant in build_mutants(path)]
    mutants = [mutant for mutant in mutants if args.only in f"{mutant.function}: {mutant.text}"]
    if args.list:
        print(*map(describe, mutants), sep="\n")
        return 0
    find("test,mutation", ["coverage"])  # it is imported in a child only
    return _run(sorted(mutants, key=lambda mutant: not mutant.function), args)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutation", description="Mutation testing of the safety code."
    )
    parser.add_argument("paths", nargs="*", default=list(ROOMS), help="modules or folders (default: %(default)s)")
    parser.add_argument("--only", default="", metavar="TEXT", help="mutants with TEXT in 'function: before -> after'")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="children at a time (default: %(default)s)")
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="S", help="s of tests (default: %(default)s)")
    parser.add_argument("--list", action="store_true", help="list the mutants, run no test")
    parser.add_argument(
        "--results", type=Path, metavar="FILE", help="keep results in FILE; skip what it has of unchanged code"
    )
    parser.add_argument("--verbose", action="store_true", help="show which test kills each mutant")
    return parser.parse_args()


def _modules(paths: list[str]) -> list[str]:
    files = [file for path in map(Path, paths) for file in (sorted(path.glob("*.py")) if path.is_dir() else [path])]
    return [str(file) for file in files if file.name != "__init__.py"]


def describe(mutant: Mutant) -> str:
    """Return the location and the change of `mutant` in one line."""
    return f"{mutant.path}:{mutant.line}: {mutant.function or 'module'}: {mutant.text}"


def _tests_of(mutants: Iterable[Mutant]) -> list[str]:
    """Return the tests of the rooms of `mutants`; those of all rooms for a module elsewhere."""
    rooms = {room_of(mutant) for mutant in mutants}
    return list(dict.fromkeys(test for room in sorted(rooms) for test in ROOMS.get(room, sum(ROOMS.values(), ()))))


def room_of(mutant: Mutant) -> str:
    """Return the folder of `mutant`, or its module where that is a room of its own."""
    return mutant.path if mutant.path in ROOMS else Path(mutant.path).parent.as_posix()


def _run(mutants: list[Mutant], args: argparse.Namespace) -> int:
    began, tests = time.monotonic(), _tests_of(mutants)
    results = Results(args.results, tests)
    outcomes = {mutant: result for mutant in mutants if (result := results.find(mutant))}
    left = [mutant for mutant in mutants if mutant not in outcomes]

    def done(mutant: Mutant, result: Result) -> None:
        outcomes[mutant] = result
        results.add(mutant, result)
        if args.verbose or len(outcomes) % 100 == 0:
            count, name = f"{len(outcomes)}/{len(mutants)}", result.outcome.name
            print(f"{count} {name} {describe(mutant)} {result.test}" if args.verbose else count, flush=True)

    known = f", {len(outcomes)} known from {args.results}" if outcomes else ""
    print(f"{len(mutants)} mutants{known}; first the tests without a change", flush=True)
    faults = _run_tests(Runner(left, args.jobs, args.limit, done), tests) if left else []
    if faults or len(outcomes) != len(mutants):
        print("Tests fail without a change:", *faults, sep="\n  ")
        return 2
    survivors = [mutant for mutant in mutants if outcomes[mutant].outcome is not Outcome.KILLED]
    for room, count in Counter(map(room_of, mutants)).items():
        alive = sum(room_of(mutant) == room for mutant in survivors)
        print(f"{room}: {count} mutants, {count - alive} killed")
    print(f"{time.monotonic() - began:.0f} s")
    return _judge(mutants, survivors, args.only)


def _run_tests(runner: Runner, tests: Sequence[str]) -> list[str]:
    """Run `tests` against the mutants of `runner`; return those that fail without a mutant."""
    options = [option for test in DESELECTED for option in ("--deselect", test)]
    with tempfile.TemporaryDirectory() as cache:
        sys.pycache_prefix, sys.dont_write_bytecode = cache, False  # what is imported anew is compiled once
        code = pytest.main([*OPTIONS, *options, *tests], plugins=[runner, Examples()])
    return runner.baseline.failed or ([f"pytest ended with {code}"] if code else [])


def _judge(mutants: list[Mutant], survivors: list[Mutant], only: str) -> int:
    explanations = [each for each in load_explanations() if only in f"{each.function}: {each.text}"]
    unexplained, stale = unexplained_and_stale(mutants, survivors, explanations)
    for mutant in unexplained:
        print(f"Survived: {describe(mutant)}")
    for explanation in stale:
        print(f"Explained in survivors.toml, but killed or changed: {explanation}")
    explained = len(survivors) - len(unexplained)
    print(f"{explained} survivors explained, {len(unexplained)} not; {len(stale)} stale explanations")
    return 1 if unexplained or stale else 0


if __name__ == "__main__":
    sys.exit(main())
