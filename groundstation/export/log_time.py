"""Moments in a log as people write them, and as exports do.

People mean the clock of this machine, as the screens show it; files have UTC.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

import msgspec

from link.tlog.tlog import LATEST

FORMS = "0:31 or +31 from the start, 12:04:10 by the clock here, or 2026-11-22T12:04:10Z"
_SECOND = 1_000_000
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_NUMBER = r"\d{1,9}(?:\.\d{1,6})?"
_FROM_START = re.compile(rf"\+(?:(?:(?P<hours>\d+):)?(?P<minutes>\d+):)?(?P<seconds>{_NUMBER})")
_MINUTES = re.compile(r"(?P<minutes>\d{1,6}):(?P<seconds>[0-5]\d(?:\.\d{1,6})?)")
_OF_DAY = re.compile(r"(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d):(?P<seconds>[0-5]\d(?:\.\d{1,6})?)")


class LogTime(msgspec.Struct, frozen=True):
    """A moment, in us: of Unix time, behind the start of the log, or of the day in which the log begins."""

    microseconds: int
    from_start: bool = False
    of_day: bool = False

    def resolve(self, begin: int) -> int:
        """Return the Unix time, us, in a log that begins at `begin`. A time of day is the first one from then on."""
        if self.from_start:
            return begin + self.microseconds
        if not self.of_day:
            return self.microseconds
        first = (_EPOCH + timedelta(microseconds=begin)).astimezone()
        midnight = first.replace(hour=0, minute=0, second=0, microsecond=0, tzinfo=None)
        at = midnight + timedelta(microseconds=self.microseconds)
        again = first.replace(microsecond=0, tzinfo=None)
        return _unix(at if at >= again else at + timedelta(days=1))


def parse_log_time(text: str) -> LogTime:
    """Return the moment. Raises ValueError with one line."""
    if found := _FROM_START.fullmatch(text) or _MINUTES.fullmatch(text):
        return LogTime(_microseconds(found), from_start=True)
    if found := _OF_DAY.fullmatch(text):
        return LogTime(_microseconds(found), of_day=True)
    try:
        if "-" in text:
            return LogTime(_unix(datetime.fromisoformat(text)))
    except (ValueError, OverflowError):
        pass
    raise ValueError(f"{text!r} is not a time in a log: write {FORMS}")


def iso_time(microseconds: int) -> str:
    """Return a Unix time as ISO 8601 in UTC."""
    at = _EPOCH + timedelta(microseconds=min(microseconds, LATEST))
    return at.isoformat(timespec="microseconds").replace("+00:00", "Z")


def describe_offset(microseconds: int) -> str:
    """Return a time from the start of a log, as `--from` takes it: "0:31.5"."""
    seconds, rest = divmod(max(0, microseconds), _SECOND)
    tenths = f".{rest // 100_000}" if rest >= 100_000 else ""
    return f"{seconds // 60}:{seconds % 60:02}{tenths}"


def _unix(at: datetime) -> int:
    """Return a time as Unix time, us; without a time zone it is of the clock here."""
    return (at.astimezone(UTC) - _EPOCH) // timedelta(microseconds=1)


def _microseconds(found: re.Match[str]) -> int:
    parts = found.groupdict()
    minutes = int(parts.get("hours") or 0) * 60 + int(parts.get("minutes") or 0)
    return minutes * 60 * _SECOND + round(float(parts["seconds"]) * _SECOND)
