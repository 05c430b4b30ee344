"""What signing costs: a frame received and sent with and without it, and key to motor when both ends sign.

Signed and unsigned take turns in one run, so that a busy machine is equally busy for both.
"""

from __future__ import annotations

import os
import random
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from dialects.axes import Axes, build_manual_control
from link.core import Outgoing
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.key_file import FILE, save_keys, station_key_file
from link.signing.keys import KeyRing, new_key
from link.signing.role import SigningRole
from link.signing.signing import Signing
from tests.benchmarks.figures import ROUNDS, Goal, Options, Report, Spread, Table, brief, spread
from tests.benchmarks.key_to_motor import CONTENDERS, KEYS, OURS_NARROW, QUICK_KEYS, Outcome, running
from tests.benchmarks.programs import scratch

FRAMES, QUICK_FRAMES = 20_000, 2_000
WALL = 1_795_000_000.0
RATE = 50.0
"""Frames/s in the time of the channels."""
SEND, RECEIVE = "send", "receive"
UNSIGNED, SIGNED = "unsigned", "signed"
ADDRESS = ("127.0.0.1", 14550)


def run(options: Options) -> Report:
    """Measure frames in memory, then keys with the real programs."""
    options.say("signing: frames")
    count = QUICK_FRAMES if options.quick else FRAMES
    samples: dict[tuple[str, str], list[list[float]]] = {}
    for _ in range(ROUNDS):
        for name in (UNSIGNED, SIGNED):
            for step, value in _frames(count, signed=name == SIGNED).items():
                samples.setdefault((step, name), []).append([value])
    measured = {key: spread(rounds) for key, rounds in samples.items()}
    keys = _keys(options)
    return Report([_frame_table(measured), _key_table(keys)], _goals(measured, keys))


# ---- frames ----


def _frames(count: int, *, signed: bool) -> dict[str, float]:
    """Return us a frame, sent by one channel and received by another."""
    ring = KeyRing().add(new_key("bench", SigningRole.SET_UP))
    sender, receiver = (_channel(ring, signed=signed, target=target) for target in (ADDRESS, None))
    outgoing = Outgoing(build_manual_control(Axes(0.5, 0.1), 1))
    start = time.thread_time_ns()
    frames = [data for each in range(count) for data, _, _ in sender.send(outgoing, now=each / RATE)]
    sent = time.thread_time_ns()
    heard = sum(len(receiver.receive(data, ADDRESS, each / RATE)) for each, data in enumerate(frames))
    received = time.thread_time_ns()
    assert heard == count, "a frame was refused"
    return {SEND: (sent - start) / count / 1e3, RECEIVE: (received - sent) / count / 1e3}


def _channel(ring: KeyRing, *, signed: bool, target: object) -> Channel:
    guard = SigningGuard(Signing(ring, wall=WALL, now=0.0), SigningPolicy(None), 0) if signed else None
    ids = (255, 190) if target else (1, 1)
    return Channel("bench", 0, system=ids[0], component=ids[1], target=target, guard=guard)


def _frame_table(measured: dict[tuple[str, str], Spread]) -> Table:
    rows: list[dict[str, Any]] = [
        {
            "step": step,
            UNSIGNED: measured[step, UNSIGNED].p50,
            SIGNED: measured[step, SIGNED].p50,
            "more": measured[step, SIGNED].p50 - measured[step, UNSIGNED].p50,
        }
        for step in (SEND, RECEIVE)
    ]
    return Table("A MANUAL_CONTROL through a channel, us a frame", rows, "Median of the rounds.")


# ---- keys ----


def _keys(options: Options) -> dict[str, Spread]:
    """Return ms from the key to the motors."""
    chance, outcomes = random.Random(7), {UNSIGNED: Outcome([]), SIGNED: Outcome([])}
    with scratch() as folder:
        for turn in range(ROUNDS):
            for name, prepare in ((UNSIGNED, _without_keys), (SIGNED, _with_keys)):
                options.say(f"signing: round {turn + 1} of {ROUNDS}, keys, {name}")
                with prepare(folder) as words, running(_contender(words)) as rig:
                    rig.arm()
                    rig.measure(outcomes[name], QUICK_KEYS if options.quick else KEYS, chance)
    return {name: spread(outcome.latencies) for name, outcome in outcomes.items()}


def _contender(words: tuple[str, ...]) -> Any:
    ours = CONTENDERS[OURS_NARROW]
    return replace(ours, vehicle=(*ours.vehicle, *words))


@contextmanager
def _environment(folder: Path) -> Iterator[None]:
    before = os.environ.get("XDG_CONFIG_HOME")
    os.environ["XDG_CONFIG_HOME"] = str(folder)
    try:
        yield
    finally:
        os.environ.pop("XDG_CONFIG_HOME")
        if before is not None:
            os.environ["XDG_CONFIG_HOME"] = before


@contextmanager
def _without_keys(folder: Path) -> Iterator[tuple[str, ...]]:
    with _environment(folder / "none"):
        yield ()


@contextmanager
def _with_keys(folder: Path) -> Iterator[tuple[str, ...]]:
    with ExitStack() as stack:
        stack.enter_context(_environment(folder / "config"))
        state = folder / "state"
        if not state.exists():
            ring = KeyRing().add(new_key("bench", SigningRole.SET_UP))
            for path in (station_key_file(), state / FILE):
                save_keys(path, ring)
            (folder / "rover.toml").write_text("[signing]\nrequired = true\n")
        yield ("--config", str(folder / "rover.toml"), "--state", str(state))


def _key_table(keys: dict[str, Spread]) -> Table:
    rows: list[dict[str, Any]] = [
        {"both ends": name, "keys": each.samples, "p50": each.p50, "p90": each.p90, "p99": each.p99, "max": each.max}
        for name, each in keys.items()
    ]
    return Table("Key byte written to the terminal -> motor outputs changed, ms", rows)


def _goals(measured: dict[tuple[str, str], Spread], keys: dict[str, Spread]) -> list[Goal]:
    more = {step: measured[step, SIGNED].p50 - measured[step, UNSIGNED].p50 for step in (SEND, RECEIVE)}
    plain = {step: f"unsigned, {brief(measured[step, UNSIGNED].p50)} us" for step in (SEND, RECEIVE)}
    late, unsigned = keys[SIGNED].p99 - keys[UNSIGNED].p99, f"unsigned, {brief(keys[UNSIGNED].p99)} ms"
    return [
        Goal("signing a frame that is sent, more than unsigned", more[SEND], 10, "us", reference=plain[SEND]),
        Goal("verifying a frame that is received, more", more[RECEIVE], 10, "us", reference=plain[RECEIVE]),
        Goal("key to motor p99, more than unsigned", late, 1.0, "ms", reference=unsigned),
    ]
