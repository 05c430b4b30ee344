"""A Python program with `Rover`: from its start to the first motion of a wheel, and what it costs while it drives."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from statistics import median
from unittest.mock import patch

from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Table, brief, quantile
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import free_port, on_pipe, python, scratch
from tests.benchmarks.watch import Watch

ROUNDS, QUICK_ROUNDS = 15, 3
WITHIN = 60.0
"""s for one program."""
APART = 6.0
"""s between two programs, after which nobody is in control (FS_GCS_TIMEOUT is 5 s). A program that follows sooner shows
0.12 s of neutral before it arms (station/driving/arming.py, NEUTRAL_FIRST)."""
WARM_UP, WINDOW = 1.5, 5.0
"""s of driving before CPU is counted, and s over which it is."""
ASKED, HEARD = "udpout: the vehicle answers", "udpin: the vehicle sends once a second"
LIMIT = 0.6
"""s from the start to the first motion beyond a bare `import groundstation`."""

BARE = "import groundstation, time; print('imported', time.monotonic(), flush=True)"
PROGRAM = """\
import time
from groundstation import Rover
say = lambda word: print(word, time.monotonic(), flush=True)
say("imported")
with Rover({endpoint!r}, vehicle=1) as rover:
    say("open")
    rover.arm()
    say("armed")
    rover.drive(0.5, seconds={seconds})
    say("driven")
"""
STEPS = ("imported", "open", "armed")


def run(options: Options) -> Report:
    """Measure the start by both kinds of links in turns, each beside a bare import, then the cost."""
    rounds = QUICK_ROUNDS if options.quick else ROUNDS
    samples: dict[tuple[str, str], list[float]] = {}
    bare: list[float] = []
    with _vehicles() as (watch, ways):
        for turn in range(rounds):
            options.say(f"rover: round {turn + 1} of {rounds}")
            bare.append(_bare(watch))
            for way, (endpoint, log) in ways.items():
                for step, seconds in _start(watch, endpoint, log).items():
                    samples.setdefault((way, step), []).append(seconds)
                watch.pause(APART)
        costs = _costs(watch, ways[ASKED][0])
    return _report(median(bare), samples, costs)


@contextmanager
def _vehicles() -> Iterator[tuple[Watch, Mapping[str, tuple[str, Path]]]]:
    """Run two simulators; yield, for each kind of link, the endpoint of a program and the motor log."""
    with ExitStack() as stack:
        folder, runtime = (stack.enter_context(scratch()) for _ in range(2))
        stack.enter_context(patch.dict(os.environ, {"XDG_RUNTIME_DIR": str(runtime), "XDG_STATE_HOME": str(folder)}))
        watch = stack.enter_context(closing(Watch()))
        ways = {}
        for way, theirs, ours in ((ASKED, "udpin", "udpout"), (HEARD, "udpout", "udpin")):
            address, log = f"127.0.0.1:{free_port()}", folder / f"{ours}.log"
            words = ("--sim", f"{theirs}:{address}", "--motor-log", str(log), "--param", "FS_LOOP_TIMEOUT=2")
            vehicle = on_pipe(watch, python("vehicle", *words))
            stack.callback(vehicle.end)
            vehicle.wait_for("ready", WITHIN)
            ways[way] = (f"{ours}:{address}", log)
        watch.pause(APART)
        yield watch, ways


def _bare(watch: Watch) -> float:
    """Return the s from the start of a program to the end of `import groundstation`."""
    program = on_pipe(watch, [sys.executable, "-c", BARE])
    program.wait_for("imported", WITHIN)
    watch.until(lambda: program.process.poll() is not None, WITHIN)
    program.end()
    return _times(program.text)["imported"] - program.started


def _start(watch: Watch, endpoint: str, log: Path) -> dict[str, float]:
    """Run a program; return the s from its start to each step. Raises BenchmarkError."""
    before = log.stat().st_size
    program = on_pipe(watch, [sys.executable, "-c", PROGRAM.format(endpoint=endpoint, seconds=0.5)])
    try:
        program.wait_for("driven", WITHIN)
        watch.until(lambda: program.process.poll() is not None, WITHIN)
    finally:
        program.end()
    times = _times(program.text)
    return {step: times[step] - program.started for step in STEPS} | {"motion": _motion(log, before) - program.started}


def _times(text: str) -> dict[str, float]:
    return {word: float(at) for word, at in (line.split() for line in text.splitlines())}


def _motion(log: Path, before: int) -> float:
    """Return when the first wheel got power behind this place of the log, CLOCK_MONOTONIC s. Raises BenchmarkError."""
    for line in log.read_bytes()[before:].splitlines():
        at, *throttles = line.split()
        if any(map(float, throttles)):
            return int(at) / 1e9
    raise BenchmarkError("the program has ended, and no wheel has turned")


def _costs(watch: Watch, endpoint: str) -> Row:
    """Return memory and CPU of a program that drives, with all its processes."""
    program = on_pipe(watch, [sys.executable, "-c", PROGRAM.format(endpoint=endpoint, seconds=9)])
    try:
        program.wait_for("armed", WITHIN)
        watch.pause(WARM_UP)
        pids = family(program.pid)
        began, used = time.monotonic(), cpu_seconds(pids)
        watch.pause(WINDOW)
        share = (cpu_seconds(pids) - used) / (time.monotonic() - began)
        taken = memory(pids)
    finally:
        program.end()
    return {"processes": len(pids), "CPU %": 100 * share, "PSS MiB": taken.pss, "RSS MiB": taken.rss}


def _report(bare: float, samples: Mapping[tuple[str, str], list[float]], costs: Row) -> Report:
    rows: list[Row] = [
        {
            "link": way,
            "from the start to": step,
            "runs": len(each),
            "p50 s": median(each),
            "p90 s": quantile(sorted(each), 0.9),
            "beyond the import s": median(each) - bare,
        }
        for (way, step), each in samples.items()
    ]
    beyond = median(samples[ASKED, "motion"]) - bare
    goal = Goal("first motion beyond a bare import, p50", beyond, LIMIT, "s", reference=f"import, {brief(bare)} s")
    return Report([Table("Start of a program", rows), Table("A program that drives", [costs])], [goal])
