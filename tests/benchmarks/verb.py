"""Verbs of the command line, from the start of the process to its end, beside the start of a bare Python."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from itertools import cycle
from statistics import median
from unittest.mock import patch

from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Table, brief, quantile
from tests.benchmarks.programs import Program, free_port, on_pipe, python, scratch
from tests.benchmarks.watch import Watch

ROUNDS, QUICK_ROUNDS = 21, 5
"""Of all verbs in turn; an even number would end in the mode that a round begins with."""
READY_WITHIN = 20.0
"""s for the vehicle of one way to be heard by the first verbs."""
WITHIN = 30.0
"""s for one verb."""
OWN, STATION, PYTHON = "own link, -v 1", "through a station", "bare python"
LIMITS = {OWN: 0.35, STATION: 0.2}
"""s for a verb, start to end."""

_MODES, _VALUES = cycle(("HOLD", "MANUAL")), cycle(("1.5", "2"))
STATUS, PARAM, MODE = "status", "param set", "mode"

Samples = dict[tuple[str, str], list[float]]
"""Verb and way -> s, one for each round."""


def run(options: Options) -> Report:
    """Measure all verbs by both ways in turns, with a bare Python in each round."""
    rounds = QUICK_ROUNDS if options.quick else ROUNDS
    samples: Samples = {}
    with _ways() as ways:
        for turn in range(rounds):
            options.say(f"verb: round {turn + 1} of {rounds}")
            _measure_round(samples, ways)
    return _report(samples)


@contextmanager
def _ways() -> Iterator[Mapping[str, Sequence[str]]]:
    """Run a station with a vehicle, and a vehicle beside it; yield the options of the two ways."""
    with ExitStack() as stack:
        runtime, state = (str(stack.enter_context(scratch())) for _ in range(2))  # two: each holds a folder `mavhelm`
        stack.enter_context(patch.dict(os.environ, {"XDG_RUNTIME_DIR": runtime, "XDG_STATE_HOME": state}))
        watch = stack.enter_context(closing(Watch()))
        through, own = f"127.0.0.1:{free_port()}", f"127.0.0.1:{free_port()}"
        _start(stack, watch, "groundstation", "serve", "--headless", f"udpin:{through}")
        _start(stack, watch, "vehicle", "--sim", f"udpout:{through}")
        _start(stack, watch, "vehicle", "--sim", f"udpin:{own}")
        ways = {OWN: ("--station", "never", "-v", "1", "-e", f"udpout:{own}"), STATION: ("--station", "only")}
        for way in ways.values():
            _wait_for_vehicle(watch, way)
        yield ways


def _wait_for_vehicle(watch: Watch, way: Sequence[str]) -> None:
    """Wait until `status` finds a vehicle. Raises BenchmarkError with what the last one said."""
    deadline = time.monotonic() + READY_WITHIN
    command = _command((STATUS, *way))
    while (ended := subprocess.run(command, capture_output=True, text=True, timeout=WITHIN)).returncode:
        if time.monotonic() > deadline:
            said = f"{ended.returncode}: {ended.stderr.strip()}"
            raise BenchmarkError(f"no vehicle answers `status {' '.join(way)}`, which ended with {said}")
        watch.pause(0.1)


def _start(stack: ExitStack, watch: Watch, module: str, *arguments: str) -> Program:
    program = on_pipe(watch, python(module, *arguments))
    stack.callback(program.end)
    return program


def _measure_round(samples: Samples, ways: Mapping[str, Sequence[str]]) -> None:
    mode, value = next(_MODES), next(_VALUES)
    for name, words in {STATUS: (STATUS,), PARAM: ("param", "set", "WP_RADIUS", value), MODE: (MODE, mode)}.items():
        for way, options in ways.items():
            samples.setdefault((name, way), []).append(_time(_command((*words, *options))))
    samples.setdefault((PYTHON, ""), []).append(_time([sys.executable, "-c", "pass"]))


def _command(words: Sequence[str]) -> list[str]:
    return python("groundstation", *words)


def _time(command: Sequence[str]) -> float:
    """Run a program with the byte code caches of a user's machine; return the s. Raises BenchmarkError."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    began = time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True, timeout=WITHIN, env=environment)
    spent = time.monotonic() - began
    if ended.returncode:
        raise BenchmarkError(f"{' '.join(command[2:])} ended with {ended.returncode}: {ended.stderr.strip()}")
    return spent


def _report(samples: Samples) -> Report:
    bare = median(samples[PYTHON, ""])
    rows: list[Row] = [
        {
            "program": name,
            "way": way,
            "runs": len(each),
            "p50 s": median(each),
            "p90 s": quantile(sorted(each), 0.9),
            "x bare python": median(each) / bare,
        }
        for (name, way), each in samples.items()
    ]
    goals = [
        Goal(f"{name}, {way}, p50", median(each), LIMITS[way], "s", reference=f"{PYTHON}, {brief(bare)} s")
        for (name, way), each in samples.items()
        if way in LIMITS
    ]
    return Report([Table("Start of the process to its end", rows)], goals)
