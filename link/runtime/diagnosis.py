"""The three doctors: a table of checks, what each has found, as text or JSON, and the exit code."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from enum import Enum
from typing import Generic, TypeVar

import msgspec

Facts = TypeVar("Facts")
Found = TypeVar("Found")

STOPPED = 7
"""Exit code when a row is a fault."""
TITLE_WIDTH = 13


class Health(Enum):
    """State of what a row examines."""

    OK = "ok"
    WARNING = "warning"
    """It works, but somebody should look at it."""
    FAULT = "fault"
    """It stops the program or part of it, keeps keys from driving, or may keep the vehicle from stopping."""
    UNKNOWN = "unknown"
    """Not known, does not apply, or comes after something else."""


MARKS = {Health.OK: "ok", Health.WARNING: "!", Health.FAULT: "X", Health.UNKNOWN: "-"}
"""State -> how text shows it."""
ADVISED = (Health.WARNING, Health.FAULT, Health.UNKNOWN)


class Finding(msgspec.Struct, frozen=True):
    """What one row found."""

    health: Health
    evidence: str
    advice: str = ""
    """What to do; "" without a remedy."""


class ReportRow(msgspec.Struct, Generic[Found], frozen=True):
    """One row of a report."""

    id: str
    title: str
    found: Found


class Check(msgspec.Struct, Generic[Facts, Found], frozen=True):
    """One row of a table: its function judges the facts."""

    id: str
    title: str
    find: Callable[[Facts], Found]


def run_checks(checks: Iterable[Check[Facts, Found]], facts: Facts) -> tuple[ReportRow[Found], ...]:
    """Return what each check of a table has found, in order."""
    return tuple(ReportRow(each.id, each.title, each.find(facts)) for each in checks)


def ok(evidence: str) -> Finding:
    """Return that all is well."""
    return Finding(Health.OK, evidence)


def warn(evidence: str, advice: str = "") -> Finding:
    """Return something to look at."""
    return Finding(Health.WARNING, evidence, advice)


def fault(evidence: str, advice: str = "") -> Finding:
    """Return what stops the program, or part of it."""
    return Finding(Health.FAULT, evidence, advice)


def unknown(evidence: str, advice: str = "") -> Finding:
    """Return that it is not known, does not apply, or comes later."""
    return Finding(Health.UNKNOWN, evidence, advice)


def fault_of(text: str) -> Finding:
    """Return a fault for an error text of the form "what is wrong; what to do"."""
    evidence, _, advice = text.partition("; ")
    return fault(evidence, advice)


def format_row(row: ReportRow[Finding]) -> Iterator[str]:
    """Return the row as lines: what was found, and below it what to do."""
    yield f"{MARKS[row.found.health]:<3}{row.title:<{TITLE_WIDTH}}{row.found.evidence}"
    if row.found.advice and row.found.health in ADVISED:
        yield f"{'':<{TITLE_WIDTH + 3}}-> {row.found.advice}"


def row_record(row: ReportRow[Finding]) -> dict[str, str]:
    """Return the row for JSON."""
    return {
        "row": row.id,
        "health": row.found.health.value,
        "evidence": row.found.evidence,
        "advice": row.found.advice,
    }


def find_faults(rows: Iterable[ReportRow[Finding]]) -> list[ReportRow[Finding]]:
    """Return the rows that are faults."""
    return [row for row in rows if row.found.health is Health.FAULT]
