"""Results of a run as Markdown: one summary of all goals, then the tables; and where they stand in a document."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks.figures import BenchmarkError, Row, brief

BEGIN, END = "<!-- results of a run: begin -->", "<!-- results of a run: end -->"
"""Lines of a document around the results, which `replace` writes."""

REASONS = (
    ("cost", "start", "Start of the programs"),
    ("cost", "RSS", "Memory"),
    ("cost", "PSS", "Memory"),
    ("cost", "CPU", "CPU of vehicle and station"),
    ("stations", "reached", "How cost grows"),
    ("stations", "memory", "Memory"),
    ("stations", "CPU", "CPU of vehicle and station"),
    ("key_to_motor", "", "Key to motor"),
    ("hops", "", "Key to motor"),
    ("screens", "", "Key to motor"),
    ("link_loss", "", "Key to motor over networks that lose"),
    ("tenth_core", "", "A tenth of a core"),
    ("loop_lateness", "", "A tenth of a core"),
    ("fleet", "", "A fleet"),
    ("fleet_path", "", "A fleet"),
    ("fleet_load", "", "A fleet"),
    ("receive_path", "", "The path of a demand, the framer and the encoder"),
    ("framer", "", "The path of a demand, the framer and the encoder"),
    ("bridge", "", "Bridge, files and slow lines"),
    ("services", "", "Bridge, files and slow lines"),
    ("verb", "", "Start of the programs"),
)
"""Benchmark, word of a goal, and the heading in docs/performance.md under which it says what is in the way."""


def results(run: Mapping[str, Any]) -> str:
    """Return the results of a run, given its JSON."""
    return "\n".join([*_head(run), "", *_summary(run), "", *_tables(run)])


def replace(file: Path, part: str) -> None:
    """Replace what stands between the marks of a document. Raises BenchmarkError if they are not there once each."""
    before, begin, rest = file.read_text().partition(BEGIN + "\n")
    old, end, after = rest.partition(END + "\n")
    if not begin or not end or BEGIN in old + after or END in after:
        raise BenchmarkError(f"{file}: expected the lines {BEGIN!r} and {END!r}, once each")
    file.write_text(f"{before}{begin}\n{part.strip()}\n\n{end}{after}")


def _head(run: Mapping[str, Any]) -> Iterator[str]:
    machine = run["machine"]
    kind = "`--quick` run (few samples: tails mean nothing)" if run["quick"] else "Full run"
    took = machine.get("seconds", 0.0) / 60
    loads = f"load {machine['load_before']} before and {machine.get('load_after', '?')} after"
    yield f"{kind}, {machine['date'][:16].replace('T', ' ')}, commit {machine['commit']}, {took:.0f} minutes, {loads}."
    yield f"{machine['cpu']}, {machine['cores']} cores, {machine['system']}, Python {machine['python']}.\n"
    yield _line(["benchmark", "s"])
    yield _line(["---", "---:"])
    yield from (_line([f"`{name}`", f"{each['seconds']:.0f}"]) for name, each in run["results"].items())
    yield ""
    for word, reasons in (("Not run", run["failed"]), ("Left out", run["skipped"]), ("Run again", run["again"])):
        for name, reason in reasons.items():
            yield f"- {word}: `{name}`, {' '.join(reason.split())}."


def _summary(run: Mapping[str, Any]) -> Iterator[str]:
    goals = [(name, goal) for name, each in run["results"].items() for goal in each["goals"]]
    met = sum(goal["met"] for _, goal in goals)
    yield "### Summary\n"
    yield f"{met} of {len(goals)} goals are met. The reference was measured in the same run.\n"
    yield _line(["benchmark", "work", "reference", "measured", "goal", "met"])
    yield _line(["---", "---", "---", "---:", "---:", "---"])
    shown = ""
    for name, goal in goals:
        met = "yes" if goal["met"] else f"**no**{_reason(name, goal['what'])}"
        yield _line([f"`{name}`" if name != shown else "", *_goal_cells(goal), met])
        shown = name


def _goal_cells(goal: Mapping[str, Any]) -> list[str]:
    sign = ">=" if goal["at_least"] else "<="
    limit = f"{sign} {goal['limit']:g} {goal['unit']}".rstrip()
    measured = f"{brief(float(goal['measured']))} {goal['unit']}".rstrip()
    return [goal["what"], goal["reference"] or "-", measured, limit]


def _reason(benchmark: str, goal: str) -> str:
    """Return a link to what is in the way of a goal; "" where nothing is written."""
    headings = (heading for name, word, heading in REASONS if name == benchmark and word in goal)
    heading = next(headings, None)
    return f", [why](#{anchor(heading)})" if heading else ""


def anchor(heading: str) -> str:
    """Return the name under which a heading of a page is linked."""
    return "".join(each for each in heading.lower().replace(" ", "-") if each.isalnum() or each == "-")


def _tables(run: Mapping[str, Any]) -> Iterator[str]:
    for name, each in run["results"].items():
        yield f"### {name}\n"
        for table in each["tables"]:
            if table["rows"]:
                yield from _table(table)


def _table(table: Mapping[str, Any]) -> Iterator[str]:
    columns = list(dict.fromkeys(column for row in table["rows"] for column in row))
    yield f"**{table['title']}.** {table['note']}".strip() + "\n"
    yield _line([column.replace("_", " ") for column in columns])
    yield _line(["---", *("---:" for _ in columns[1:])])
    yield from (_cells(row, columns) for row in table["rows"])
    yield ""


def _cells(row: Row, columns: Sequence[str]) -> str:
    return _line([brief(row.get(column)) for column in columns])


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
