"""CHAIN: every link from the finger to the wheel, in order. A new one is a function and a row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from groundstation.doctor import link_rows, stop_rows, vehicle_rows
from groundstation.doctor.facts import DoctorFacts
from groundstation.doctor.finding import Finding
from groundstation.views.doctor import DoctorRow, Health


@dataclass(frozen=True, slots=True)
class ChainRow:
    """One link of the chain."""

    id: str
    title: str
    find: Callable[[DoctorFacts], Finding]


CHAIN: tuple[ChainRow, ...] = (
    ChainRow("keys", "keys", link_rows.keys),
    ChainRow("station", "station", link_rows.station),
    ChainRow("link", "link", link_rows.link),
    ChainRow("vehicle", "vehicle", link_rows.vehicle),
    ChainRow("dialect", "dialect", link_rows.dialect),
    ChainRow("our_id", "our id", link_rows.our_id),
    ChainRow("control", "control", vehicle_rows.control),
    ChainRow("pre_arm", "pre-arm", vehicle_rows.pre_arm),
    ChainRow("mode", "mode", vehicle_rows.mode),
    ChainRow("armed", "armed", vehicle_rows.armed),
    ChainRow("stop_bound", "stop bound", stop_rows.stop_bound),
    ChainRow("gcs_failsafe", "GCS failsafe", stop_rows.gcs_failsafe),
    ChainRow("failsafes", "failsafes", vehicle_rows.failsafes),
    ChainRow("fence", "fence", vehicle_rows.fence),
    ChainRow("battery", "battery", vehicle_rows.battery),
    ChainRow("motors", "motors", vehicle_rows.motors),
)


def examine(facts: DoctorFacts) -> tuple[DoctorRow, ...]:
    """Return all rows."""
    return tuple(_row(each, each.find(facts)) for each in CHAIN)


def _row(link: ChainRow, found: Finding) -> DoctorRow:
    return DoctorRow(
        id=link.id,
        title=link.title,
        health=found.health,
        evidence=found.evidence,
        advice=found.advice,
        action=found.action,
        fix=found.fix,
    )


def count_faults(rows: tuple[DoctorRow, ...]) -> int:
    """Return how many links stop the operator."""
    return sum(row.health is Health.FAULT for row in rows)
