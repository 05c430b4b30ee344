"""Command line of the mutation run; see the package."""

from __future__ import annotations

import argparse
import importlib.util
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest

from tests.mutation.child import OPTIONS, Examples
from tests.mutation.mutants import Mutant, build_mutants
from tests.mutation.runner import Outcome, Runner
from tests.mutation.survivors import load_explanations, unexplained_and_stale

MODULES = ("vehicle/drive", "vehicle/safety", "link/protocol")
"""Modules to mutate: those that decide whether the wheels turn, and which frames count."""
TESTS = (
    "tests/vehicle/drive", "tests/vehicle/safety", "tests/vehicle/commands/test_arming.py",
    "tests/vehicle/commands/test_actuator_test.py", "tests/vehicle/commands/test_buttons.py",
    "tests/vehicle/test_signed_drivers.py", "tests/link/protocol",
)  # fmt: skip
"""Tests to run against the mutants."""
DESELECTED = ("tests/vehicle/safety/test_estop_button.py",)
"""Tests that start the vehicle in a process of its own, which has no mutant."""

LIMIT = 2.0
"""s of tests to run against a mutant: behaviour that takes longer to test needs a test of its own."""


MISSING = "the package coverage is missing: pip install -e '.[test,mutation]'"


def main() -> int:
    """Run the program; return 1 if survivors and explanations differ, 2 if it cannot run or tests fail unchanged."""
    args = _parse()
    mutants = [mutant for path in _modules(args.paths) for mutant in build_mutants(path)]
    mutants = [mutant for mutant in mutants if args.only in f"{mutant.function}: {mutant.text}"]
    if args.list:
        print(*map(describe, mutants), sep="\n")
        return 0
    if importlib.util.find_spec("coverage") is None:  # it is imported in a child only
        print(f"tests.mutation: {MISSING}", file=sys.stderr)
        return 2
    return _run(sorted(mutants, key=lambda mutant: not mutant.function), args)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutation", description="Mutation testing of the safety code."
    )
    parser.add_argument("paths", nargs="*", default=MODULES, help="modules or folders (default: %(default)s)")
    parser.add_argument("--only", default="", metavar="TEXT", help="mutants with TEXT in 'function: before -> after'")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="children at a time (default: %(default)s)")
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="S", help="s of tests (default: %(default)s)")
    parser.add_argument("--list", action="store_true", help="list the mutants, run no test")
    parser.add_argument("--verbose", action="store_true", help="show which test kills each mutant")
    return parser.parse_args()


def _modules(paths: list[str]) -> list[str]:
    files = [file for path in map(Path, paths) for file in (sorted(path.glob("*.py")) if path.is_dir() else [path])]
    return [str(file) for file in files if file.name != "__init__.py"]


def describe(mutant: Mutant) -> str:
    """Return the location and the change of `mutant` in one line."""
    return f"{mutant.path}:{mutant.line}: {mutant.function or 'module'}: {mutant.text}"


def _run(mutants: list[Mutant], args: argparse.Namespace) -> int:
    began, counts, survivors = time.monotonic(), Counter[Outcome](), list[Mutant]()

    def done(mutant: Mutant, outcome: Outcome, test: str) -> None:
        counts[outcome] += 1
        if outcome is not Outcome.KILLED:
            survivors.append(mutant)
        if args.verbose or counts.total() % 100 == 0:
            count = f"{counts.total()}/{len(mutants)}"
            print(f"{count} {outcome.name} {describe(mutant)} {test}" if args.verbose else count, flush=True)

    print(f"{len(mutants)} mutants; first the tests without a change", flush=True)
    runner = Runner(mutants, args.jobs, args.limit, done)
    options = [option for test in DESELECTED for option in ("--deselect", test)]
    with tempfile.TemporaryDirectory() as cache:
        sys.pycache_prefix, sys.dont_write_bytecode = cache, False  # what is imported anew is compiled once
        code = pytest.main([*OPTIONS, *options, *TESTS], plugins=[runner, Examples()])
    if code or runner.baseline.failed or counts.total() != len(mutants):
        print("Tests fail without a change:", *runner.baseline.failed, sep="\n  ")
        return 2
    print(f"{len(mutants)} mutants, {counts[Outcome.KILLED]} killed, {time.monotonic() - began:.0f} s")
    return _judge(mutants, survivors)


def _judge(mutants: list[Mutant], survivors: list[Mutant]) -> int:
    unexplained, stale = unexplained_and_stale(mutants, survivors, load_explanations())
    for mutant in unexplained:
        print(f"Survived: {describe(mutant)}")
    for explanation in stale:
        print(f"Explained in survivors.toml, but killed: {explanation}")
    explained = len(survivors) - len(unexplained)
    print(f"{explained} survivors explained, {len(unexplained)} not; {len(stale)} stale explanations")
    return 1 if unexplained or stale else 0


if __name__ == "__main__":
    sys.exit(main())
