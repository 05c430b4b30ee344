"""Collects what the doctor judges, from the snapshot and what the station knows beside it."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from dialects.enums import Sensor
from groundstation.doctor.facts import DoctorFacts, SensorBits, SettingFact
from groundstation.snapshot import Snapshot
from groundstation.station.links.link_stats import LinkStats
from groundstation.vehicles.calibration.calibration import CalibrationState
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.health.arming_checks import ArmingChecks
from groundstation.vehicles.state.doctor_params import DoctorParams
from groundstation.views.doctor import SensorRow, TerminalFacts
from link.runtime.diagnosis import Health

SENSOR_NAMES: Mapping[Sensor, str] = {
    Sensor.GYRO: "gyros",
    Sensor.ACCELEROMETER: "accelerometers",
    Sensor.COMPASS: "compass",
    Sensor.GPS: "GPS",
    Sensor.AHRS: "estimator",
    Sensor.BATTERY: "battery",
    Sensor.LOGGING: "logging",
    Sensor.GEOFENCE: "fence",
    Sensor.MOTOR_OUTPUTS: "motor outputs",
}
"""Bits of SYS_STATUS that are listed, in this order."""


class VehicleReport(msgspec.Struct):
    """What the doctor keeps of one vehicle."""

    checks: ArmingChecks
    params: DoctorParams
    calibration: CalibrationState
    component: int
    """Of the vehicle that they ask."""


def collect(
    snapshot: Snapshot,
    contact: Contact | None,
    report: VehicleReport | None,
    links: LinkStats,
    *,
    system: int,
    terminal: TerminalFacts | None,
    tested: frozenset[int],
    now: float,
) -> DoctorFacts:
    """Return the facts about the selected vehicle."""
    newest = links.newest
    frames = sum(each.frames for each in newest)
    state = None if contact is None else contact.state
    settings = None if contact is None else contact.settings_check
    return DoctorFacts(
        system=system,
        vehicle=snapshot.vehicle,
        operator=snapshot.operator,
        links=snapshot.links,
        endpoints=snapshot.endpoints,
        id_conflict=snapshot.id_conflict,
        terminal=terminal,
        firmware=contact.details.firmware if contact else "",
        rover_dialect=bool(state and state.has_rover_dialect),
        unknown_share=sum(each.unknown for each in newest) / frames if frames else None,
        mismatched=tuple(sorted({name for each in newest for name in each.dialect_mismatch})),
        own_id=any(each.own_id for each in newest),
        clash=bool(state and state.control.clash),
        signs=bool(contact and contact.signs),
        verified=bool(contact and contact.verified),
        sensors=report.checks.bits if report else None,
        texts=report.checks.texts(now) if report else (),
        settings=tuple(SettingFact(*each) for each in settings.findings) if settings else (),
        unread=settings.missing if settings else (),
        params=_params(contact, report),
        motors_tested=tested,
    )


def _params(contact: Contact | None, report: VehicleReport | None) -> Mapping[str, float]:
    """Return what is known; where a parameter was read twice, the value that the Drive screen shows."""
    settings = contact.settings_check.values if contact is not None and contact.settings_check is not None else {}
    return {
        **(report.params.values if report is not None else {}),
        **settings,
        **(contact.drive.params.values if contact is not None else {}),
    }


def sensor_rows(bits: SensorBits | None) -> tuple[SensorRow, ...]:
    """Return the subsystems that the vehicle has."""
    if bits is None:
        return ()
    return tuple(
        SensorRow(name, _health(bits, sensor)) for sensor, name in SENSOR_NAMES.items() if bits.present & sensor
    )


def _health(bits: SensorBits, sensor: Sensor) -> Health:
    if not bits.enabled & sensor:
        return Health.UNKNOWN
    return Health.OK if bits.health & sensor else Health.FAULT
