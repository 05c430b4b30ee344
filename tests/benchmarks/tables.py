"""Results as Markdown, ready to paste into docs/performance.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tests.benchmarks.figures import Report, Row, Table


def markdown(machine: Mapping[str, Any], reports: Mapping[str, Report], *, quick: bool) -> str:
    """Return all tables of a run."""
    return "\n".join([_machine_line(machine, quick=quick), "", *_sections(reports)])


def _machine_line(machine: Mapping[str, Any], *, quick: bool) -> str:
    kind = "`--quick` run: few samples, tails mean nothing" if quick else "Full run"
    return (
        f"{kind}, {machine['date']}: {machine['cpu']}, {machine['cores']} cores, {machine['system']}, "
        f"Python {machine['python']}, commit {machine['commit']}, load {machine['load_before']} before."
    )


def _sections(reports: Mapping[str, Report]) -> Iterator[str]:
    for name, report in reports.items():
        yield f"### {name}\n"
        for table in [*report.tables, Table("Goals", [goal.row() for goal in report.goals])]:
            if table.rows:
                yield from _table(table)


def _table(table: Table) -> Iterator[str]:
    columns = list(table.rows[0])
    yield f"**{table.title}**\n"
    yield _line([_heading(column) for column in columns])
    yield _line(["---", *("---:" for _ in columns[1:])])
    yield from (_cells(row, columns) for row in table.rows)
    yield f"\n{table.note}\n" if table.note else ""


def _cells(row: Row, columns: Sequence[str]) -> str:
    return _line([number(row.get(column)) for column in columns])


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _heading(column: str) -> str:
    return column.replace("_", " ")


def number(value: Any) -> str:
    """Format with three significant digits: more than a shared machine repeats."""
    if value is None:
        return "-"
    if not isinstance(value, float):
        return f"{value:,}" if isinstance(value, int) else str(value)
    if value == 0.0 or not 1e-3 <= abs(value) < 1e15:
        return f"{value:.3g}"
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}" if abs(rounded) >= 100 else f"{rounded:.3g}"
