"""ROVER_LINK_STATUS, and warnings about link faults, from the reports of the links."""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from dialects.enums import Severity
from link.core import LinkReport, SigningCounts
from vehicle.drive.control import Control
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry.scaling import UINT8, UINT32, scale_to_int

ROUND_TRIP_UNKNOWN = m.UINT16_MAX


class LinkStatusReporter:
    """Keeps the newest report of each link."""

    def __init__(self, control: Control, texts: StatusTextQueue, ids: tuple[int, int]) -> None:
        """`ids` are the system id and component id of the vehicle."""
        self._control = control
        self._texts = texts
        self._ids = ids
        self._reports: dict[int, LinkReport] = {}

    def update(self, reports: Sequence[LinkReport], now: float) -> list[m.Message]:
        """Store the reports of all links. Return one ROVER_LINK_STATUS for each."""
        self._reports = {report.index: report for report in reports}
        for report in reports:
            self._warn(report, now)
        return [self._status(report) for report in reports]

    def build_status(self, link: int) -> m.Message | None:
        """Build ROVER_LINK_STATUS of one link; None before its first report."""
        report = self._reports.get(link)
        return None if report is None else self._status(report)

    def _warn(self, report: LinkReport, now: float) -> None:
        for name in report.dialect_mismatch:
            text = f"Dialect mismatch on {report.name}: {name} differs"
            self._texts.send_once(f"mismatch {report.name} {name}", Severity.WARNING, text, now)
        if report.own_id:
            system, component = self._ids
            text = f"Another system on {report.name} uses our ids {system}/{component}"
            self._texts.send_once(f"own id {report.name}", Severity.WARNING, text, now)

    def _status(self, report: LinkReport) -> m.Message:
        refused = report.refused or SigningCounts()
        return m.RoverLinkStatus(
            frames_ok=scale_to_int(report.frames, UINT32),
            crc_errors=scale_to_int(report.crc_errors, UINT32),
            resync_bytes=scale_to_int(report.resync_bytes, UINT32),
            bad_signature=scale_to_int(refused.bad, UINT32),
            replayed=scale_to_int(report.duplicates + report.late + refused.replayed + refused.too_old, UINT32),
            unsigned_rejected=scale_to_int(refused.unsigned, UINT32),
            not_in_control=scale_to_int(self._control.not_in_control_count, UINT32),
            rate_limited=scale_to_int(report.rate_limited, UINT32),
            rtt_ms=ROUND_TRIP_UNKNOWN,
            jitter_ms=ROUND_TRIP_UNKNOWN,
            link_id=scale_to_int(report.index, UINT8),
            peers=scale_to_int(report.peers, UINT8),
        )
