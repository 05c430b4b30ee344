"""Why a vehicle refuses: its STATUSTEXTs around the refusal.

ArduPilot answers first and says why afterwards, PX4 the other way round. The reason is often no warning: ArduPilot says
"No Mission. Can't set AUTO." as NOTICE, and then "Flight mode change failed" as WARNING.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from dialects.enums import Severity

REASON_WITHIN = 1.0
"""s between a refusal and the vehicle's STATUSTEXT that explains it; either may arrive first."""

MORE_WITHIN = 0.3
"""s after a text in which others may follow that belong to it."""

MAX_TEXTS = 3
"""Texts in one reason."""

_KEPT = 16


class _Text(NamedTuple):
    text: str
    severity: int
    at: float
    number: int


class ReasonTexts:
    """The newest texts of one vehicle."""

    def __init__(self) -> None:
        self._texts: deque[_Text] = deque(maxlen=_KEPT)
        self.count = 0
        """Texts so far; those from here on were said later."""

    def add(self, text: str, severity: int, now: float) -> bool:
        """Handle a text; return whether it may be a reason."""
        may = severity <= Severity.INFO
        if may:
            self._texts.append(_Text(text, severity, now, self.count))
            self.count += 1
        return may

    def explain(self, refused_at: float, since: int = 0, name: str = "") -> str:
        """Return what was said around a refusal, beginning with text number `since`; "" for nothing.

        Beside a warning only notices count, without one also what is for information; beside texts with `name` in
        them only those.
        """
        near = [each for each in self._texts if each.number >= since and abs(each.at - refused_at) <= REASON_WITHIN]
        near = [each for each in near if name in each.text] or near
        bound = Severity.NOTICE if any(each.severity <= Severity.WARNING for each in near) else Severity.INFO
        texts = dict.fromkeys(each.text for each in near if each.severity <= bound)
        return "; ".join(list(texts)[-MAX_TEXTS:])
