"""Which lines of the log are shown: words, severity, label, and those around a moment."""

from __future__ import annotations

import msgspec

from groundstation.snapshot import LogLine

WARNING = 4
"""MAV_SEVERITY: this one and lower numbers are warnings and worse."""

SEVERITIES = ("EMERG", "ALERT", "CRIT", "ERROR", "WARN", "NOTE", "INFO", "DEBUG")
"""Tags of MAV_SEVERITY 0 to 7."""

SEVERITY_NAMES = ("EMERGENCY", "ALERT", "CRITICAL", "ERROR", "WARNING", "NOTICE", "INFO", "DEBUG")
"""Names of MAV_SEVERITY 0 to 7, for the filter and the detail."""

LABELS = {"ack": "ACK", "state": "STATE", "station": "GCS", "you": "YOU", "line": ":"}
"""Label of a line -> its tag below severity WARNING; STATUSTEXT lines have the name of their severity."""

AROUND = 5.0
"""s before and after the marked line whose lines `e` shows."""

LIMIT = ">="
"""Begins the word of a filter that names the mildest severity to show, e.g. ">=warning"."""


class LogFilter(msgspec.Struct, frozen=True):
    """Which lines are shown."""

    text: str = ""
    """Words that must all occur in the text or the tag, upper or lower case; one may be a severity (LIMIT)."""
    warnings: bool = False
    """Warnings and worse only."""
    labels: tuple[str, ...] = ()
    """Only lines with one of these labels; empty: all."""
    moment: float | None = None
    """Only lines within AROUND of this time, s since the epoch; the rest of the filter does not count then."""

    def matches(self, line: LogLine) -> bool:
        """Return whether the line is shown."""
        if self.moment is not None:
            return first_time(line) <= self.moment + AROUND and line.time >= self.moment - AROUND
        if self.warnings and line.severity > WARNING:
            return False
        if self.labels and line.label not in self.labels:
            return False
        found = f"{tag_of(line)} {line.text}".lower()
        return all(_word_matches(word, line, found) for word in self.text.lower().split())

    @property
    def problem(self) -> str:
        """Return which word names no severity, and those that there are; "" without one."""
        limits = [word for word in self.text.lower().split() if word.startswith(LIMIT)]
        wrong = [word for word in limits if severity_limit(word) is None]
        return f"no severity “{wrong[0][len(LIMIT) :]}”: {', '.join(_names())}" if wrong else ""


def severity_limit(word: str) -> int | None:
    """Return the MAV_SEVERITY of a word such as ">=warn"; None for a name that no severity begins with.

    Of several that begin alike it is the mildest: ">=" alone shows all lines, and each letter narrows it.
    """
    name = word.removeprefix(LIMIT)
    return max((number for number, each in enumerate(_names()) if each.startswith(name)), default=None)


def tag_of(line: LogLine) -> str:
    """Return the short name of what a line is."""
    severity = max(0, min(7, line.severity))
    return SEVERITIES[severity] if severity <= WARNING else LABELS.get(line.label, SEVERITIES[severity])


def first_time(line: LogLine) -> float:
    """Return when the line occurred for the first time, s since the epoch."""
    return line.time if line.first is None else line.first


def _names() -> list[str]:
    return [each.lower() for each in SEVERITY_NAMES]


def _word_matches(word: str, line: LogLine, found: str) -> bool:
    if word.startswith(LIMIT):
        limit = severity_limit(word)
        return limit is not None and line.severity <= limit
    return word in found
