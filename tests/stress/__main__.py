"""Run the tests of real programs and real sockets several times with all cores busy beside them.

A user's machine is late now and then, and CI's always. A test that fails here shows a fault of the product, which gives
up where it should wait, or of the test, which waits for time where it should wait for an event (docs/reliability.md).
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

from tests.stress.load import busy_cores
from tests.stress.results import Round, count_failures, read_round

TREE = Path(__file__).resolve().parents[2]
WORKERS = 5
"""As many as CI has: most of these tests wait for programs."""


def main(words: list[str]) -> int:
    """Run the rounds; return 0 if no test has failed in any, 1 if one has, 2 if a round has not run."""
    parser = argparse.ArgumentParser(prog="python -m tests.stress", description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="(default: %(default)s)")
    parser.add_argument("--workers", type=int, default=WORKERS, metavar="N", help="of pytest (default: %(default)s)")
    parser.add_argument("--burners", type=int, metavar="N", help="busy processes (default: one for each core)")
    parser.add_argument(
        "--report", type=Path, default=TREE / ".stress", metavar="FOLDER", help="gets the output of each round"
    )
    parser.add_argument("tests", nargs="*", help="files, folders and options for pytest (default: tests)")
    options = parser.parse_args(words)
    options.report.mkdir(parents=True, exist_ok=True)
    rounds: list[Round] = []
    with busy_cores(options.burners):
        for number in range(1, options.rounds + 1):
            done = _run(number, options)
            if done is None:
                return 2
            rounds.append(done)
    for name, count in count_failures(rounds).items():
        print(f"failed in {count} of {len(rounds)} rounds: {name}")
    return 1 if count_failures(rounds) else 0


def _run(number: int, options: argparse.Namespace) -> Round | None:
    """Run one round and print its result; None if pytest has not come to its end."""
    junit, log = options.report / f"round-{number}.xml", options.report / f"round-{number}.log"
    junit.unlink(missing_ok=True)
    command = [
        *(sys.executable, "-m", "pytest", "-p", "tests.stress.selection", "-p", "no:cacheprovider", "--suite", "all"),
        *(
            "-n",
            str(options.workers),
            "--dist",
            "loadgroup",
            "-q",
            f"--junitxml={junit}",
            *(options.tests or ["tests"]),
        ),
    ]
    begun = time.monotonic()
    # Without PYTHONDONTWRITEBYTECODE: some 500 programs are started, and each would compile all its modules.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    with log.open("wb") as output:
        code = subprocess.run(command, cwd=TREE, env=environment, stdout=output, stderr=output, check=False).returncode
    if code not in (0, 1) or not junit.exists():
        print(f"round {number}: pytest ended with {code}, see {log}", flush=True)
        return None
    done = read_round(junit)
    load = " ".join(f"{each:.1f}" for each in os.getloadavg())
    print(f"round {number}: {done.summary} in {time.monotonic() - begun:.0f} s, load {load}; {log}", flush=True)
    return done


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
