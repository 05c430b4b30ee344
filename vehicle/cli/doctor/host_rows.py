"""Rows of `mavhelm vehicle doctor` about the computer: service, power, clock, disk."""

from __future__ import annotations

from link.runtime.diagnosis import Finding, fault, fault_of, ok, unknown, warn
from vehicle.cli.doctor.facts import VehicleDoctorFacts

WARM = 80.0
"""degrees C from which on a Pi slows its processor down."""
OLDEST_YEAR = 2025
"""A clock before it was never set: a Pi without a clock chip starts with the time of its last shutdown or of 1970."""
KEPT_FREE = 8
"""MB that logs leave free (vehicle/storage/tlog_files.py)."""
JOURNAL = "journalctl -u rover -n 20 shows why"


def service(facts: VehicleDoctorFacts) -> Finding:
    """Judge the unit that starts the vehicle with the computer."""
    unit = facts.service
    if unit is None:
        return unknown("systemd does not run here")
    if unit.get("LoadState") != "loaded":
        return unknown("no rover.service: start the vehicle by hand", "docs/pi.md, As a service")
    state, restarts = unit.get("ActiveState", ""), unit.get("NRestarts", "0")
    if state == "failed":
        return fault(f"rover.service has failed (exit code {unit.get('ExecMainStatus', '-')})", JOURNAL)
    if unit.get("SubState") == "auto-restart":
        return fault(f"rover.service ends and restarts, {restarts} times so far", JOURNAL)
    if state == "active":
        again = f", restarted {restarts} times" if restarts not in ("", "0") else ""
        return ok(f"rover.service runs{again}") if unit.get("UnitFileState") == "enabled" else warn(
            f"rover.service runs{again}, and does not start with the computer", "sudo systemctl enable rover"
        )  # fmt: skip
    return unknown(f"rover.service is {state or 'stopped'}", "sudo systemctl start rover")


def power(facts: VehicleDoctorFacts) -> Finding:
    """Judge supply voltage and temperature, as the failsafe of the vehicle does (FS_PI_TEMP)."""
    health, limit = facts.health, facts.params.get("FS_PI_TEMP", 85.0)
    degrees = "temperature unknown" if health.temperature is None else f"{health.temperature:.0f} degrees C"
    if health.under_voltage:
        return fault(f"under-voltage, {degrees}", "use a stronger supply and a shorter, thicker cable")
    if health.temperature is not None and limit and health.temperature > limit:
        return fault(f"{degrees}, above FS_PI_TEMP {limit:g}", "cool the computer, or give it air")
    if health.throttled or (health.temperature is not None and health.temperature >= WARM):
        return warn(f"{degrees}: the processor is slowed down", "cool the computer, or give it air")
    if health.under_voltage is None:
        return unknown(f"{degrees}; this computer does not report its supply voltage")
    return ok(f"supply voltage ok, {degrees}")


def clock(facts: VehicleDoctorFacts) -> Finding:
    """Judge the wall clock: logs have its time. The control loop does not use it."""
    if facts.clock.year < OLDEST_YEAR:
        return warn(f"the clock says {facts.clock.year}: logs get wrong times", "connect to a network, or set it")
    if facts.clock.synchronized is None:
        return unknown("the kernel does not tell whether the clock is set")
    if not facts.clock.synchronized:
        return warn("not synchronized: logs may get wrong times", "timedatectl shows why; connect to a network")
    return ok("synchronized")


def disk(facts: VehicleDoctorFacts) -> Finding:
    """Judge the folders that the vehicle writes to, and their free space."""
    failed = [each for each in facts.select("state", "log.") if not each.ok]
    if failed:
        return fault_of(failed[0].detail)
    if not facts.spaces:
        return unknown("after the errors of the file are corrected")
    least = min(facts.spaces, key=lambda each: each.free)
    free, wanted = least.free / 1e6, facts.params.get("LOG_FILE_MB_FREE", 0.0)
    text = f"{free:.0f} MB free for {least.folder}"
    if free < KEPT_FREE:
        return fault(f"{text}: nothing is saved", "free some space: df -h shows where")
    if free < wanted:
        return warn(
            f"{text}, below LOG_FILE_MB_FREE {wanted:g}: the oldest logs are removed", "download or delete logs"
        )
    return ok(text)
