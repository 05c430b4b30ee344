"""Link problems as text, reported once when they begin and once when a link is back."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import NamedTuple

from dialects.enums import Severity
from dialects.messages import MESSAGES, read_by_programs
from link.core import GuardReport, LinkReport, SigningCounts

PROVEN_AFTER = 3
"""Refused frames that are not an accident."""
DAY = 86_400.0
"""s by which a clock may be ahead without a word."""
CONNECTING = "connecting"
"""State of a link before its first connection; not reported, because every connection starts so."""


def link_problem(report: LinkReport) -> str | None:
    """Return what is wrong with a link, in one line, or None."""
    if report.down:
        return report.down.removeprefix(f"{report.name}: ")
    if report.own_id:
        return "another program sends with our system and component id: change --system of one of them"
    if report.dialect_mismatch:
        return _mismatch(report.dialect_mismatch)
    if report.refused is None:
        return None
    return _far_ahead(report.guard) if report.verified else _refusals(report.refused)


def _refusals(counts: SigningCounts) -> str | None:
    """Return why nothing signed has come through: no frame of the other end was verified yet."""
    if counts.bad >= PROVEN_AFTER:
        return "frames arrive signed with a key that is not here: compare the fingerprints of both ends"
    if counts.too_old >= PROVEN_AFTER:
        return "signed frames arrive with a wrong time: set the clock of the computer that sends them"
    if counts.unsigned >= PROVEN_AFTER:
        return "frames without a signature are dropped: give the other end a key, or do not require it here"
    return None


def _far_ahead(guard: GuardReport | None) -> str | None:
    """Return whose clock is followed although it is more than a day ahead; SigningGuard follows it from now on."""
    far = {} if guard is None else {system: s for system, s in guard.ahead.items() if s > DAY}
    if not far:
        return None
    system, ahead = max(far.items(), key=lambda each: each[1])
    return (
        f"system {system} signs {ahead / DAY:.0f} days ahead of our clock, and we sign with its time: set both clocks"
    )


def _mismatch(names: Sequence[str]) -> str:
    """Return what is wrong, and what helps: a user's dialect replaces no message that the programs read."""
    fixed = {MESSAGES[each].msgname for each in read_by_programs()}
    helps = (
        "the vehicle must send the standard definition" if fixed.issuperset(names) else "start with --dialect FILE.xml"
    )
    return f"messages arrive with another dialect's checksum and are dropped: {', '.join(names[:5])}; {helps}"


class LinkEvent(NamedTuple):
    """One line to report."""

    text: str
    severity: Severity


class UpDownEvents:
    """Returns only changes of which links are down and why; "back" only for links that worked before."""

    def __init__(self) -> None:
        self._down: dict[Hashable, str] = {}
        self._worked: set[Hashable] = set()

    def update(self, link: Hashable, why: str | None) -> LinkEvent | None:
        """Return the event of a link that is down because of `why`, or works (None)."""
        before = self._down.pop(link, None)
        if why:
            self._down[link] = why
            return None if why in (before, CONNECTING) else LinkEvent(why, Severity.ERROR)
        again = link in self._worked
        self._worked.add(link)
        return None if before is None else LinkEvent("it is back" if again else "connected", Severity.NOTICE)


class LinkEvents:
    """Reports the problems of all links once each; a link that goes down again is reported again."""

    def __init__(self) -> None:
        self._reported: set[str] = set()
        self._links = UpDownEvents()

    def update(self, report: LinkReport) -> LinkEvent | None:
        """Return the event of this link, if any."""
        problem = link_problem(report)
        change = self._links.update(report.index, problem if report.down else None)
        if change or report.down or not problem or problem in self._reported:
            return change
        self._reported.add(problem)
        return LinkEvent(problem, Severity.ERROR)
