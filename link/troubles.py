"""What is wrong with a link, in words, and what of it is news: for a screen, a log, whoever looks after the link."""

from __future__ import annotations

from typing import NamedTuple

from dialects.enums import Severity
from link.core import LinkReport


def problem(report: LinkReport) -> str | None:
    """What is wrong with a link, in one line."""
    if report.down:
        return report.down.removeprefix(f"{report.name}: ")
    if report.own_id:
        return "another program sends with our system and component id: give one of us another --system"
    if report.dialect_mismatch:
        names = ", ".join(report.dialect_mismatch[:5])
        return f"messages arrive with another dialect's checksum and are dropped: {names}"
    return None


class News(NamedTuple):
    """A line to tell."""

    text: str
    severity: Severity


class Troubles:
    """What was told of the links' problems: a link that is down and comes back may go down again, and that is news."""

    def __init__(self) -> None:
        self._told: set[str] = set()
        self._down: dict[int, str] = {}
        """Link -> why it is down."""

    def news(self, report: LinkReport) -> News | None:
        """What is to be told of this link now."""
        trouble = problem(report)
        if report.down and trouble:
            before, self._down[report.index] = self._down.get(report.index), trouble
            return News(trouble, Severity.ERROR) if trouble != before else None
        if self._down.pop(report.index, None):
            return News("it is back", Severity.NOTICE)
        if trouble and trouble not in self._told:
            self._told.add(trouble)
            return News(trouble, Severity.ERROR)
        return None
