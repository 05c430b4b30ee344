"""Key to motor over a bad network: 10 ms one way with jitter, and random loss, for us and for the common hobby form.

The sender's next frame replaces a lost change, so the tail shows the sender's period and what it does on a change.
"""

from __future__ import annotations

import random

from tests.benchmarks.figures import ROUNDS, Goal, Options, Report, Row, Spread, Table, brief, spread
from tests.benchmarks.key_to_motor import CONTENDERS, HOBBY, OURS_NARROW, Network, Outcome, running

NETWORKS = {
    "10 +- 3 ms": Network(loss=0.0, delay=0.010, jitter=0.003),
    "10 +- 3 ms, 10 % loss": Network(loss=0.10, delay=0.010, jitter=0.003),
    "10 +- 3 ms, 20 % loss": Network(loss=0.20, delay=0.010, jitter=0.003),
}
"""One way; the same in both directions."""

LIMITS = {"10 +- 3 ms, 10 % loss": 20, "10 +- 3 ms, 20 % loss": 30}
"""Network -> ms that the p99 may take: the delay and 10 ms, or 20 ms at 20 % loss."""

KEYS, QUICK_KEYS = {OURS_NARROW: 80, HOBBY: 15}, {OURS_NARROW: 10, HOBBY: 5}
"""Keys of a path in one round."""


def run(options: Options) -> Report:
    """Measure every network with both, round by round."""
    chance = random.Random(11)
    outcomes = {(network, path): Outcome([]) for network in NETWORKS for path in (OURS_NARROW, HOBBY)}
    for turn in range(ROUNDS):
        for (network, path), outcome in outcomes.items():
            options.say(f"link_loss: round {turn + 1} of {ROUNDS}, {network}, {path}")
            contender = CONTENDERS[path]
            with running(contender, NETWORKS[network]) as rig:
                if contender.arms:
                    rig.arm()
                rig.measure(outcome, (QUICK_KEYS if options.quick else KEYS)[path], chance)
    table = Table("Key byte written to the terminal -> motor outputs changed over a bad network, ms")
    goals = []
    for (network, path), outcome in outcomes.items():
        each = spread(outcome.latencies)
        table.rows.append(_row(network, path, each, outcome.lost))
        if path == OURS_NARROW and network in LIMITS:
            hobby = f"hobby form, {brief(spread(outcomes[network, HOBBY].latencies).p99)} ms"
            goals.append(Goal(f"key to motor, {network}, p99", each.p99, LIMITS[network], "ms", reference=hobby))
    return Report([table], goals)


def _row(network: str, path: str, each: Spread, lost: int) -> Row:
    return {
        "network": network,
        "path": path,
        "keys": each.samples,
        "lost": lost,
        "p50": each.p50,
        "p90": each.p90,
        "p99": each.p99,
        "max": each.max,
    }
