"""CHAIN: every link from the finger to the wheel, in order. A new one is a function and a row here."""

from __future__ import annotations

from msgspec.structs import asdict

from groundstation.doctor import link_rows, stop_rows, vehicle_rows
from groundstation.doctor.facts import DoctorFacts
from groundstation.views.doctor import ChainFinding, DoctorRow
from link.runtime.diagnosis import Check, Health, run_checks

CHAIN: tuple[Check[DoctorFacts, ChainFinding], ...] = (
    Check("keys", "keys", link_rows.keys),
    Check("station", "station", link_rows.station),
    Check("link", "link", link_rows.link),
    Check("vehicle", "vehicle", link_rows.vehicle),
    Check("dialect", "dialect", link_rows.dialect),
    Check("our_id", "our id", link_rows.our_id),
    Check("control", "control", vehicle_rows.control),
    Check("pre_arm", "pre-arm", vehicle_rows.pre_arm),
    Check("mode", "mode", vehicle_rows.mode),
    Check("armed", "armed", vehicle_rows.armed),
    Check("stop_bound", "stop bound", stop_rows.stop_bound),
    Check("gcs_failsafe", "GCS failsafe", stop_rows.gcs_failsafe),
    Check("failsafes", "failsafes", vehicle_rows.failsafes),
    Check("fence", "fence", vehicle_rows.fence),
    Check("battery", "battery", vehicle_rows.battery),
    Check("motors", "motors", vehicle_rows.motors),
)


def examine(facts: DoctorFacts) -> tuple[DoctorRow, ...]:
    """Return all rows."""
    return tuple(DoctorRow(id=row.id, title=row.title, **asdict(row.found)) for row in run_checks(CHAIN, facts))


def count_faults(rows: tuple[DoctorRow, ...]) -> int:
    """Return how many links stop the operator."""
    return sum(row.health is Health.FAULT for row in rows)
