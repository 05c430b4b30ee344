"""What is wrong with a link, in words, and what of it is news: for a screen, a log, whoever looks after the link."""

from __future__ import annotations

from collections.abc import Hashable
from typing import NamedTuple

from dialects.enums import Severity
from link.core import LinkReport

CONNECTING = "connecting"
"""Why a link does not work that was only just begun: no news, because it is the usual way."""


def link_problem(report: LinkReport) -> str | None:
    """What is wrong with a link, in one line."""
    if report.down:
        return report.down.removeprefix(f"{report.name}: ")
    if report.own_id:
        return "another program sends with our system and component id: give one of us another --system"
    if report.dialect_mismatch:
        names = ", ".join(report.dialect_mismatch[:5])
        return f"messages arrive with another dialect's checksum and are dropped: {names}"
    return None


class LinkEvent(NamedTuple):
    """A line to tell."""

    text: str
    severity: Severity


class UpDownEvents:
    """Which links are down, and why: what has changed is told once, and "back" is only what was there before."""

    def __init__(self) -> None:
        self._down: dict[Hashable, str] = {}
        self._worked: set[Hashable] = set()

    def update(self, link: Hashable, why: str | None) -> LinkEvent | None:
        """What is to be told of this link, which is down because of `why`, or works."""
        before = self._down.pop(link, None)
        if why:
            self._down[link] = why
            return None if why in (before, CONNECTING) else LinkEvent(why, Severity.ERROR)
        again = link in self._worked
        self._worked.add(link)
        return None if before is None else LinkEvent("it is back" if again else "connected", Severity.NOTICE)


class LinkEvents:
    """What was told of the links' problems: a link that is down and comes back may go down again, and that is news."""

    def __init__(self) -> None:
        self._told: set[str] = set()
        self._links = UpDownEvents()

    def update(self, report: LinkReport) -> LinkEvent | None:
        """What is to be told of this link now."""
        trouble = link_problem(report)
        change = self._links.update(report.index, trouble if report.down else None)
        if change or report.down or not trouble or trouble in self._told:
            return change
        self._told.add(trouble)
        return LinkEvent(trouble, Severity.ERROR)
