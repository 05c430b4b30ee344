"""One run of benchmarks: each as far as it comes, its results kept in a file as soon as it has ended."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.benchmarks import machine
from tests.benchmarks.figures import BenchmarkError, BenchmarkSkippedError, Options, Report
from tests.benchmarks.programs import python

Benchmark = Callable[[Options], Report]

LONGEST = 1200
"""s after which a benchmark that does not end counts as failed."""


class Run:
    """The results so far; `results` is what is written as JSON."""

    def __init__(self, benchmarks: Mapping[str, Benchmark], options: Options, out: Path | None = None) -> None:
        """`out`: file that has the results after each benchmark."""
        self._benchmarks, self._options, self._out = benchmarks, options, out
        self._began = time.monotonic()
        self.results: dict[str, Any] = {
            "quick": options.quick,
            "machine": machine.facts(),
            "results": {},
            "failed": {},
            "skipped": {},
            "again": {},
        }

    def measure(self, names: Sequence[str], beside: str = "") -> None:
        """Run them one after the other, and those that failed once more. Those after `beside` run beside it."""
        background = None
        for name in names:
            if name == beside and name != names[-1]:
                background = Background(name, self._options)
            else:
                self._one(name)
        if background is not None:
            self._add(beside, background.collect)
        for name in [*self.results["failed"]]:
            self.results["again"][name] = self.results["failed"].pop(name)
            self._options.say(f"{name}: again, because it failed")
            self._one(name)

    def _one(self, name: str) -> None:
        def measure() -> dict[str, Any]:
            started = time.monotonic()
            with _limited():
                plain = self._benchmarks[name](self._options).plain()
            return plain | {"seconds": time.monotonic() - started}

        self._add(name, measure)

    def _add(self, name: str, measure: Callable[[], dict[str, Any]]) -> None:
        try:
            self.results["results"][name] = measure()
        except BenchmarkSkippedError as reason:
            self.results["skipped"][name] = str(reason)
            self._options.say(f"{name} is left out: {reason}")
        except Exception as error:  # the others still run; the exit code reports it
            self.results["failed"][name] = str(error) or type(error).__name__
            self._options.say(f"{name} could not run: {error}")
            if not isinstance(error, BenchmarkError):
                traceback.print_exception(error)
        else:
            self._options.say(f"{name}: {self.results['results'][name]['seconds']:.0f} s")
        self.results["machine"] |= {"load_after": machine.load(), "seconds": time.monotonic() - self._began}
        self._keep()

    def _keep(self) -> None:
        if self._out is not None:
            new = self._out.with_name(f"{self._out.name}.new")
            new.write_text(json.dumps(self.results, indent=1) + "\n")
            new.replace(self._out)


class Background:
    """A benchmark that waits most of its time, in a process of its own while others run."""

    def __init__(self, name: str, options: Options) -> None:
        self._name = name
        self._out = Path(tempfile.mkstemp(prefix="mavhelm-bench-", suffix=".json")[1])
        seeds = [word for seed in options.seeds for word in ("--seed", str(seed))]
        words = [*(["--quick"] if options.quick else []), *seeds, "--only", name, "--out", str(self._out)]
        self._process = subprocess.Popen(python("tests.benchmarks", *words), stdout=subprocess.DEVNULL)

    def collect(self) -> dict[str, Any]:
        """Wait for its end and return its results. Raises BenchmarkError."""
        try:
            self._process.wait(LONGEST)
            run = json.loads(self._out.read_text() or "{}")
        except subprocess.TimeoutExpired:
            raise BenchmarkError(f"did not end within {LONGEST} s") from None
        finally:
            self._process.terminate()
            self._out.unlink()
        if self._name not in run.get("results", {}):
            raise BenchmarkError(run.get("failed", {}).get(self._name, "it ended without a result"))
        return dict(run["results"][self._name])


@contextmanager
def _limited() -> Iterator[None]:
    """Let the block raise BenchmarkError after LONGEST."""

    def end(*_: object) -> None:
        raise BenchmarkError(f"did not end within {LONGEST} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(LONGEST)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def say(line: str) -> None:
    """Print a line of progress."""
    print(line, file=sys.stderr, flush=True)
