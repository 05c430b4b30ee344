"""The bridge as a router from one UDP port to another, beside MAVProxy, a pymavlink forwarder and a relay in C.

blast.c generates the load and receives it at the other end. For the throughput it keeps at most 192 frames in transit,
so that nothing is lost and a router cannot look fast by dropping; for the latency it sends one frame every 20 ms.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from tests.benchmarks.figures import (
    ROUNDS,
    BenchmarkError,
    BenchmarkSkippedError,
    Goal,
    Options,
    Report,
    Row,
    Table,
    brief,
    spread,
)
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import Program, free_port, on_pipe, python, scratch
from tests.benchmarks.watch import Watch

SECONDS, QUICK_SECONDS = 2.0, 1.0
"""s of one measurement of throughput."""
LATENCY_SECONDS, QUICK_LATENCY_SECONDS = 6.0, 2.0
TOGETHER = (1, 8)
"""Frames in one datagram of the load."""

BRIDGE, ONE_FRAME = "bridge", "mavhelm bridge --one-frame"
RELAY, FORWARDER = "C relay with CRC", "pymavlink forwarder"
MAVPROXY = "MAVProxy"
MAVLINK_ROUTER = {1: 153_813 / 190_755, 8: 208_306 / 190_755}
"""Frames in a datagram -> mavlink-router's frames/s as a share of what a C relay does with one per datagram.

Measured in one run on another day; mavlink-router itself is not available here.
"""

HERE = Path(__file__).resolve().parent


@dataclass(slots=True)
class Outcome:
    """Results of one router, one value per round."""

    rates: dict[int, list[float]] = field(default_factory=dict)
    """Frames in a datagram -> frames/s."""
    lost: int = 0
    cpu: list[float] = field(default_factory=list)
    """us of CPU per frame, with one frame per datagram."""
    rss: list[float] = field(default_factory=list)
    latencies: list[list[float]] = field(default_factory=list)
    """us."""


def run(options: Options) -> Report:
    """Measure all routers in turn, round by round."""
    with scratch() as folder:
        blast = _compiled("blast", folder)
        routers = _routers(folder, options)
        outcomes = {name: Outcome() for name in routers}
        direct: list[list[float]] = []
        for turn in range(ROUNDS):
            direct.append(_direct(blast, options))
            for name, argv in routers.items():
                options.say(f"bridge: round {turn + 1} of {ROUNDS}, {name}")
                _measure(outcomes[name], blast, argv, options)
    return _report(outcomes, direct)


def _routers(folder: Path, options: Options) -> dict[str, list[str]]:
    """Name -> command line; {IN} and {OUT} are UDP ports."""
    source, target = "udpin:127.0.0.1:{IN}", "udpout:127.0.0.1:{OUT}"
    routers = {
        BRIDGE: python("link.bridge", source, target, "--quiet"),
        RELAY: [_compiled("relay", folder), "{IN}", "{OUT}"],
        ONE_FRAME: python("link.bridge", source, target, "--quiet", "--one-frame"),
        FORWARDER: python("tests.benchmarks.pymavlink_forwarder", source, target),
    }
    try:
        mavproxy = _mavproxy(folder)
    except subprocess.CalledProcessError as error:
        options.say(f"bridge: MAVProxy is left out, it could not be installed: {error.stderr[-300:]!r}")
        return routers
    mavproxy += [f"--master={source}", f"--out={target}", "--non-interactive"]
    return routers | {
        MAVPROXY: [*mavproxy, f"--state-basedir={folder}"],
    }


def _mavproxy(folder: Path) -> list[str]:
    """MAVProxy in a virtual environment of its own: an external program that we run and never import."""
    home = str(folder / "mavproxy")
    install = [f"{home}/bin/pip", "install", "--quiet"]
    for argv in (
        [sys.executable, "-m", "venv", home],
        [*install, "--no-deps", "MAVProxy", "pymavlink", "pyserial"],
        [*install, "fastcrc", "lxml"],  # what pymavlink needs
    ):
        subprocess.run(argv, check=True, capture_output=True, text=True)
    return [f"{home}/bin/python", f"{home}/bin/mavproxy.py"]


def _compiled(name: str, folder: Path) -> str:
    target = folder / name
    try:
        subprocess.run(["cc", "-O2", "-o", target, HERE / f"{name}.c"], check=True, capture_output=True, text=True)
    except OSError as error:
        raise BenchmarkSkippedError(f"no C compiler: {error}") from error
    except subprocess.CalledProcessError as error:
        raise BenchmarkError(f"{name}.c: {error.stderr[-300:]}") from error
    return str(target)


# ---- measuring ----


@contextmanager
def _running(argv: list[str]) -> Iterator[tuple[Program, int, int]]:
    ports = free_port(), free_port()
    watch = Watch()
    program = on_pipe(watch, [word.format(IN=ports[0], OUT=ports[1]) for word in argv])
    try:
        yield program, *ports
    finally:
        program.end()
        watch.close()


def _measure(outcome: Outcome, blast: str, argv: list[str], options: Options) -> None:
    seconds = QUICK_SECONDS if options.quick else SECONDS
    for together in TOGETHER:
        with _running(argv) as (program, source, target):
            _blast(blast, "rate", source, target, together, 0.2)  # so that the router has its routes and is warm
            before = cpu_seconds(family(program.pid))
            frames, took, lost = map(float, _blast(blast, "rate", source, target, together, seconds)[0].split())
            outcome.rates.setdefault(together, []).append(frames / took)
            outcome.lost += int(lost)
            if together == 1 and frames:
                outcome.cpu.append((cpu_seconds(family(program.pid)) - before) / frames * 1e6)
                outcome.rss.append(memory(family(program.pid)).rss)
    with _running(argv) as (_, source, target):
        outcome.latencies.append(_latencies(blast, source, target, options))


def _direct(blast: str, options: Options) -> list[float]:
    """Measure the load's own latency, without any router."""
    port = free_port()
    return _latencies(blast, port, port, options)


def _latencies(blast: str, source: int, target: int, options: Options) -> list[float]:
    seconds = QUICK_LATENCY_SECONDS if options.quick else LATENCY_SECONDS
    return [float(line) for line in _blast(blast, "latency", source, target, 1, seconds)]


def _blast(blast: str, what: str, source: int, target: int, together: int, seconds: float) -> list[str]:
    words = [blast, what, str(source), str(target), str(together), str(seconds)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    if done.returncode or not done.stdout:
        raise BenchmarkError("no frame came through the router")
    return done.stdout.splitlines()


# ---- report ----


def _report(outcomes: dict[str, Outcome], direct: list[list[float]]) -> Report:
    rows = [_row(name, outcome, outcomes[RELAY]) for name, outcome in outcomes.items()]
    none = spread(direct)
    rows.append({"router": "none", "latency p50 us": none.p50, "p99 us": none.p99})
    note = "Frames of 40 bytes, one UDP port to another. x: against the C relay. lost: frames, of all rounds."
    return Report([Table("Throughput and added latency of routers", rows, note)], _goals(outcomes))


def _row(name: str, outcome: Outcome, relay: Outcome) -> Row:
    latency = spread(outcome.latencies)
    return {
        "router": name,
        "frames/s, 1 a datagram": median(outcome.rates[1]),
        "x": median(outcome.rates[1]) / median(relay.rates[1]),
        "frames/s, 8 a datagram": median(outcome.rates[8]),
        "x (8)": median(outcome.rates[8]) / median(relay.rates[8]),
        "lost": outcome.lost,
        "CPU us/frame": median(outcome.cpu),
        "latency p50 us": latency.p50,
        "p99 us": latency.p99,
        "RSS MiB": median(outcome.rss),
    }


def _goals(outcomes: dict[str, Outcome]) -> list[Goal]:
    bridge, relay = outcomes[BRIDGE], outcomes[RELAY]
    one, eight = (
        median(bridge.rates[together]) / median(relay.rates[1]) / MAVLINK_ROUTER[together] for together in TOGETHER
    )
    p99, relay_p99 = (spread(each.latencies).p99 for each in (bridge, relay))
    rates = [f"C relay's {brief(median(relay.rates[1]))} frames/s x {brief(MAVLINK_ROUTER[each])}" for each in TOGETHER]
    late = f"C relay, {brief(relay_p99 / 1000)} ms"
    goals = [
        Goal("bridge, frames/s against mavlink-router's share of the C relay", one, 2.0, "x", True, rates[0]),
        Goal("the same with 8 frames a datagram", eight, 3.0, "x", True, rates[1]),
        Goal("bridge, latency p99, more than the C relay's", (p99 - relay_p99) / 1000, 0.3, "ms", False, late),
        Goal("bridge, memory", median(bridge.rss), 40.0, "MiB"),
        Goal("bridge, frames lost", bridge.lost, 0, "frames"),
    ]
    if MAVPROXY in outcomes:
        theirs = median(outcomes[MAVPROXY].rates[1])
        beside = f"MAVProxy, {brief(theirs)} frames/s"
        goals.append(Goal("bridge, frames/s against MAVProxy", median(bridge.rates[1]) / theirs, 40, "x", True, beside))
    return goals
