"""The last snapshot of a station that has crashed."""

from __future__ import annotations

import msgspec

from dialects.enums import Severity
from groundstation.snapshot import LogLine, OperatorView, Snapshot
from groundstation.vehicles.state.message_log import MAX_LENGTH


def crash_snapshot(last: Snapshot, what: str, wall: float) -> Snapshot:
    """Return the last snapshot with the reason why no other follows."""
    line = LogLine(time=wall, severity=Severity.CRITICAL, label="station", text=what[:MAX_LENGTH])
    stopped = OperatorView(
        style=last.operator.style,
        reports_releases=last.operator.reports_releases,
        gate_reason="station crashed",
    )
    return msgspec.structs.replace(last, number=last.number + 1, operator=stopped, texts=(*last.texts, line))
