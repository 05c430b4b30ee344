"""Results of a benchmark: spreads of samples, tables of rows, and goals compared with what was measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from statistics import median
from typing import Any

ROUNDS = 3
"""Rounds of every comparison, ours and the reference in turn: a shared machine drifts within minutes."""

Row = dict[str, Any]
"""Column -> value. The unit, if any, is the last word of the column."""


@dataclass(frozen=True, slots=True)
class Spread:
    """Distribution of samples. A tail of 60 samples means nothing, so p90, p99 and max are those of all rounds
    together."""

    samples: int
    p50: float
    p90: float
    p99: float
    max: float
    rounds: tuple[float, ...]
    """The median of each round; `p50` is the median of these."""


def spread(rounds: Sequence[Sequence[float]]) -> Spread:
    """Compute the distribution of the samples of all rounds; no round may be empty."""
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
    """Return the nearest-rank quantile of sorted samples: a value that was measured."""
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


@dataclass(slots=True)
class Goal:
    """One goal of performance.md, and the result of this run."""

    what: str
    measured: float
    limit: float
    unit: str
    at_least: bool = False
    """True if the measured value must be at least `limit`, else at most."""
    reference: str = ""
    """What it is beside in the same run, with its figure."""

    @property
    def met(self) -> bool:
        """Return whether this run meets the goal."""
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit


@dataclass(slots=True)
class Table:
    """Rows with the same columns."""

    title: str
    rows: list[Row] = field(default_factory=list)
    note: str = ""


@dataclass(slots=True)
class Report:
    """Results of one benchmark."""

    tables: list[Table] = field(default_factory=list)
    goals: list[Goal] = field(default_factory=list)

    def plain(self) -> dict[str, Any]:
        """Return the report for JSON."""
        return {
            "tables": [asdict(table) for table in self.tables],
            "goals": [asdict(goal) | {"met": goal.met} for goal in self.goals],
        }


@dataclass(frozen=True, slots=True)
class Options:
    """Options of the command line for every benchmark."""

    quick: bool
    """A short run to check that it works: its tails mean nothing."""
    tlog: str | None
    """A telemetry log for the framer; None: only the generated mix."""
    say: Callable[[str], None]
    """Prints the progress."""
    seeds: tuple[int, ...] = (1,)
    """Seeds for the noise of simulated sensors."""


def brief(value: Any) -> str:
    """Format with three significant digits: more than a shared machine repeats. None is a dash."""
    if value is None:
        return "-"
    if not isinstance(value, float):
        return f"{value:,}" if isinstance(value, int) else str(value)
    if value == 0.0 or not 1e-3 <= abs(value) < 1e15:
        return f"{value:.3g}"
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}" if abs(rounded) >= 100 else f"{rounded:.3g}"


class BenchmarkError(Exception):
    """A benchmark could not run; the message is one line with the reason."""


class BenchmarkSkippedError(BenchmarkError):
    """This machine or this user lacks what a benchmark needs; the message names it."""
