"""What a benchmark hands back: spreads of samples, tables of rows, and goals held against what was measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from statistics import median
from typing import Any

ROUNDS = 3
"""Rounds of every comparison, ours and the reference in turn: a machine that others use drifts within minutes."""

Row = dict[str, Any]
"""Column -> value. The unit, where there is one, is the last word of the column."""


@dataclass(frozen=True, slots=True)
class Spread:
    """How samples lie. A tail of 60 samples says nothing, so p90, p99 and max are those of all rounds together."""

    samples: int
    p50: float
    p90: float
    p99: float
    max: float
    rounds: tuple[float, ...]
    """The median of each round; `p50` is the median of these."""


def spread(rounds: Sequence[Sequence[float]]) -> Spread:
    """Of the samples of each round; none may be empty."""
    together = sorted(sample for each in rounds for sample in each)
    middles = tuple(median(each) for each in rounds)
    return Spread(
        samples=len(together),
        p50=median(middles),
        p90=quantile(together, 0.9),
        p99=quantile(together, 0.99),
        max=together[-1],
        rounds=middles,
    )


def quantile(ordered: Sequence[float], share: float) -> float:
    """The nearest-rank quantile of sorted samples: a value that was really seen."""
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


@dataclass(slots=True)
class Goal:
    """One line of performance.md's goals, and what this run says of it."""

    what: str
    measured: float
    limit: float
    unit: str
    at_least: bool = False
    """The measured value must reach `limit`; else it must not pass it."""

    @property
    def met(self) -> bool:
        """Does this run reach the goal?"""
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit

    def row(self) -> Row:
        """As a row of a table."""
        sign = ">=" if self.at_least else "<="
        return {
            "goal": self.what,
            "measured": self.measured,
            "limit": f"{sign} {self.limit:g} {self.unit}".rstrip(),
            "met": "yes" if self.met else "NO",
        }


@dataclass(slots=True)
class Table:
    """Rows with the same columns."""

    title: str
    rows: list[Row] = field(default_factory=list)
    note: str = ""


@dataclass(slots=True)
class Report:
    """What one benchmark found."""

    tables: list[Table] = field(default_factory=list)
    goals: list[Goal] = field(default_factory=list)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "tables": [asdict(table) for table in self.tables],
            "goals": [asdict(goal) | {"met": goal.met} for goal in self.goals],
        }


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line asks of every benchmark."""

    quick: bool
    """A short run, to see that it works: its tails mean nothing."""
    tlog: str | None
    """A telemetry log for the framer; None: the made mix alone."""
    say: Callable[[str], None]
    """Progress, for a person."""
    seeds: tuple[int, ...] = (1,)
    """Of the noise of simulated sensors."""


class BenchmarkError(Exception):
    """A benchmark could not run; the message is one line that says why."""
