"""Collects what the doctor judges, from the snapshot and what the station knows beside it."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from dialects.enums import Autopilot, Sensor
from groundstation.doctor.facts import DoctorFacts, PathFact, SensorBits, SettingFact
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.station.links.link_stats import LinkStats
from groundstation.vehicles.calibration.calibration import CalibrationState
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.health.arming_checks import ArmingChecks
from groundstation.vehicles.readings.motor_outputs import TestedMotor, motors_of
from groundstation.vehicles.readings.outputs import PARAMS as FUNCTION_PARAMS
from groundstation.vehicles.readings.outputs import servo_functions, servo_names
from groundstation.vehicles.state.doctor_params import DoctorParams
from groundstation.views.doctor import MotorRow, ParamFix, SensorRow, TerminalFacts
from link.core import Outgoing
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

    @classmethod
    def of(cls, contact: Contact, outbox: list[Outgoing], ids: tuple[int, int]) -> VehicleReport:
        """Return an empty one for a vehicle; `outbox` gets what is sent to it, `ids` are ours."""
        state = contact.state
        target = (state.system, state.component)
        params, calibration = DoctorParams(state.autopilot, ids, target), CalibrationState(outbox, ids, target)
        return cls(ArmingChecks(state.component), params, calibration, state.component)


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
        paths=_paths(contact, links, now),
        id_conflict=snapshot.id_conflict,
        free_id=snapshot.free_id,
        terminal=terminal,
        firmware=contact.details.firmware if contact else "",
        rover_dialect=bool(state and state.has_rover_dialect),
        unknown_share=sum(each.unknown for each in newest) / frames if frames else None,
        mismatched=tuple(sorted({name for each in newest for name in each.dialect_mismatch})),
        version_1=state is not None and any(state.system in each.version_1 for each in newest),
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


def _paths(contact: Contact | None, links: LinkStats, now: float) -> tuple[PathFact, ...]:
    """Return the paths to the vehicle that are heard and whose route is known."""
    known = {each.peer for each in contact.state.paths.live(now)} if contact else set()
    return tuple(
        PathFact(report.name, *route)
        for report in links.newest
        for peer, route in report.routes.items()
        if peer in known
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


def find_motors(contact: Contact | None) -> tuple[TestedMotor, ...]:
    """Return the motors of a vehicle that can be tested: none before all are known, as their numbers would change."""
    if contact is None:
        return ()
    state = contact.state
    if state.autopilot == Autopilot.ARDUPILOT and contact.drive.params.is_reading(FUNCTION_PARAMS.values()):
        return ()
    functions = servo_functions(contact.drive.params.values)
    return motors_of(state.autopilot, state.drive_info, functions, rover_dialect=state.has_rover_dialect)


def motor_rows(
    contact: Contact, report: VehicleReport, tested: frozenset[int], vehicle: VehicleView | None
) -> tuple[MotorRow, ...]:
    """Return a row for each motor, with its output as the screens show it, and the change that reverses it."""
    values = {output.name: output.value for output in vehicle.outputs} if vehicle is not None else {}
    return tuple(
        MotorRow(number, motor.name, motor.output, values.get(motor.name), number in tested, _reversal(motor, report))
        for number, motor in enumerate(find_motors(contact), 1)
    )


def _reversal(motor: TestedMotor, report: VehicleReport) -> ParamFix | None:
    """Return the change that lets a motor turn the other way, where its parameter is known."""
    value = report.params.values.get(motor.reverse)
    return None if value is None else ParamFix(motor.reverse, value, 0.0 if value else 1.0)


def vehicle_facts(contact: Contact) -> tuple[tuple[str, str], ...]:
    """Return name and text of what is known of the vehicle itself."""
    state, values = contact.state, contact.drive.params.values
    known = len(contact.services.params.client.params) if contact.services is not None else 0
    axes = "operator presence" if state.has_rover_dialect else "MANUAL_CONTROL"
    lines = {
        "firmware": contact.details.firmware,
        "system": f"{state.system}/{state.component}",
        "dialect": "rover" if state.has_rover_dialect else "common",
        "demands": axes,
        "motors": ", ".join(servo_names(values).values()) if servo_functions(values) else "",
        "params": f"{known} known" if known else "",
        "signing": "on, verified" if contact.verified else "with a key that is not here" if contact.signs else "",
    }
    return tuple((name, text) for name, text in lines.items() if text)
