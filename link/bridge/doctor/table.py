"""ROWS: what `mavhelm bridge doctor` examines of each endpoint, in order. A new one is a function and a row here."""

from __future__ import annotations

from link.bridge.doctor import rows
from link.bridge.doctor.facts import EndpointFacts
from link.runtime.diagnosis import Check, Finding, ReportRow, run_checks

ROWS: tuple[Check[EndpointFacts, Finding], ...] = (
    Check("opens", "opens", rows.opens),
    Check("bytes", "bytes", rows.arriving),
    Check("frames", "frames", rows.frames),
    Check("damage", "damage", rows.damage),
    Check("dialect", "dialect", rows.dialect),
    Check("heard", "heard", rows.heard),
    Check("routes", "routes", rows.routes),
)


def examine(facts: EndpointFacts) -> tuple[ReportRow[Finding], ...]:
    """Return all rows of one endpoint."""
    return run_checks(ROWS, facts)
