"""ROWS: all that `mavhelm vehicle doctor` examines, in order. A new one is a function and a row here."""

from __future__ import annotations

from link.runtime.diagnosis import Check, Finding, ReportRow, run_checks
from vehicle.cli.doctor import check_rows, device_rows, host_rows, signing_row
from vehicle.cli.doctor.facts import VehicleDoctorFacts

ROWS: tuple[Check[VehicleDoctorFacts, Finding], ...] = (
    Check("config", "config", check_rows.config),
    Check("service", "service", host_rows.service),
    Check("permissions", "permissions", device_rows.permissions),
    Check("serial_ports", "serial ports", device_rows.serial_ports),
    Check("pins", "pins", device_rows.pins),
    Check("motors", "motors", check_rows.motors),
    Check("accessories", "accessories", check_rows.accessories),
    Check("sensors", "sensors", check_rows.sensors),
    Check("links", "links", check_rows.links),
    Check("signing", "signing", signing_row.signing),
    Check("power", "power", host_rows.power),
    Check("clock", "clock", host_rows.clock),
    Check("disk", "disk", host_rows.disk),
)
"""Causes come before their effects: a running service explains motors in use."""


def examine(facts: VehicleDoctorFacts) -> tuple[ReportRow[Finding], ...]:
    """Return all rows."""
    return run_checks(ROWS, facts)
