"""Rows of `mavhelm vehicle doctor` about the device files of the configuration: permissions, serial ports, pins."""

from __future__ import annotations

from link.runtime.diagnosis import Finding, fault, ok, unknown
from vehicle.cli.doctor.check_rows import AFTER_CONFIG
from vehicle.cli.doctor.facts import Device, VehicleDoctorFacts

CONSOLE = "sudo raspi-config nonint do_serial_cons 1 removes the login console, then reboot"
LOGINS = ("getty", "agetty")


def permissions(facts: VehicleDoctorFacts) -> Finding:
    """Judge whether this user may open the device files."""
    if not facts.readable:
        return AFTER_CONFIG
    needed = [*facts.serial, *facts.buses, *(facts.gpio if facts.pins and not facts.simulated_pins else ())]
    present = [each for each in needed if each.present]
    refused = [each for each in present if not each.allowed]
    if refused:
        groups = ",".join(sorted({each.group for each in refused}))
        names = ", ".join(each.path for each in refused)
        return fault(f"{facts.user} may not open {names}", f"sudo usermod -aG {groups} $USER, then log in again")
    if not present:
        return ok("no device file is needed")
    return ok(f"{facts.user} may open {', '.join(each.path for each in present)}")


def serial_ports(facts: VehicleDoctorFacts) -> Finding:
    """Judge the serial ports of motors and links."""
    if not facts.readable:
        return AFTER_CONFIG
    if not facts.serial:
        return unknown("none is configured")
    wrong = [found for each in facts.serial if (found := _port_fault(each, facts))]
    if wrong:
        return wrong[0]
    if any(each.holder for each in facts.serial):
        return unknown("in use by the vehicle that runs")
    return ok(", ".join(f"{each.path} is there and free" for each in facts.serial))


def _port_fault(port: Device, facts: VehicleDoctorFacts) -> Finding | None:
    if not port.present:
        return fault(f"{port.path} is not there", "plug it in; names in /dev/serial/by-id/ stay the same")
    if port.console:
        return fault(f"{port.path}: the kernel writes its messages there (console=)", CONSOLE)
    if not port.holder or (facts.running and not port.holder.startswith(LOGINS)):
        return None
    login = port.holder.startswith(LOGINS)
    return fault(f"{port.path} is open in {port.holder}", CONSOLE if login else "end that program")


def pins(facts: VehicleDoctorFacts) -> Finding:
    """Judge the pins of the header and the I2C buses."""
    if not facts.readable:
        return AFTER_CONFIG
    missing = [each for each in facts.buses if not each.present]
    if missing:
        return fault(f"{missing[0].path} is not there", "sudo raspi-config nonint do_i2c 0 enables bus 1")
    used = ", ".join([*facts.pins, *(each.path for each in facts.buses)])
    if not used:
        return unknown("none is configured")
    if facts.pins and facts.simulated_pins:
        return ok(f"{used}; the pins are simulated (GPIOZERO_PIN_FACTORY)")
    if facts.pins and not facts.gpio:
        return fault(f"{', '.join(facts.pins)} needed, and there is no /dev/gpiochip*", "is this a Raspberry Pi?")
    return ok(f"{used}: each is used once")
