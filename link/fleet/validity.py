"""Until when a certificate holds, read from its PEM, and the line that warns before. Sans-IO."""

from __future__ import annotations

import re
import ssl
from datetime import UTC, datetime

WARN_BEFORE = 90.0
"""Days before its end from which a certificate is warned of: time to renew it at the next visit to a rover."""

_TIMES = re.compile(rb"\x17\x0d(\d{12})Z|\x18\x0f(\d{14})Z")
"""UTCTime and GeneralizedTime of DER, as certificates have them (RFC 5280, 4.1.2.5): not before, not after."""
_DAY = 86400.0


def valid_until(pem: bytes) -> float | None:
    """Return the time, in s since 1970, until when a certificate holds; None if that cannot be read."""
    try:
        times = _TIMES.findall(ssl.PEM_cert_to_DER_cert(pem.decode().strip()))
        short, long = times[1]
        text = long.decode() or _century(short.decode())
        return datetime.strptime(text, "%Y%m%d%H%M%S").replace(tzinfo=UTC).timestamp()
    except (ValueError, IndexError):
        return None


def warning_of(whose: str, pem: bytes, now: float, remedy: str) -> str | None:
    """Return the line that warns of a certificate near its end, or None. `now`: s since 1970.

    A clock that was never set shows 1970 and warns of nothing.
    """
    until = valid_until(pem)
    if until is None or until - now >= WARN_BEFORE * _DAY:
        return None
    day = datetime.fromtimestamp(until, UTC).strftime("%Y-%m-%d")
    left = (until - now) / _DAY
    state = f"ended on {day}" if left < 0 else f"ends on {day}, in {left:.0f} days"
    return f"the certificate of {whose} {state}: {remedy}"


def _century(text: str) -> str:
    """Return a UTCTime with four digits of the year: 50 to 99 are of the 20th century."""
    return ("19" if text >= "50" else "20") + text
