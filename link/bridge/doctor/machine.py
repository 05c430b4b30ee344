"""The ports of this machine, for `mavhelm bridge doctor` without endpoints: what is there, and who has it."""

from __future__ import annotations

from collections.abc import Iterator

from link.endpoint import DEFAULT_BAUD
from link.runtime.diagnosis import Finding, ReportRow, fault, ok, unknown, warn
from link.transport.processes import SocketKind, find_socket_holders
from link.transport.serial_ports import SerialPort, find_serial_ports

USUAL_PORTS: tuple[tuple[SocketKind, int], ...] = (("udp", 14550), ("udp", 14551), ("udp", 14540), ("tcp", 5760))
"""Ports of ground stations, of a second one, of offboard programs (PX4), and of ArduPilot's simulator."""


def examine_machine() -> Iterator[ReportRow[Finding]]:
    """Yield a row for each serial port and each usual port."""
    ports = find_serial_ports()
    for port in ports:
        yield ReportRow(f"serial {port.path}", "serial", _serial(port))
    if not ports:
        yield ReportRow("serial", "serial", unknown("no serial port is there", "plug the radio or autopilot in"))
    for kind, number in USUAL_PORTS:
        yield ReportRow(f"{kind} {number}", f"{kind} {number}", _socket(kind, number))


def _serial(port: SerialPort) -> Finding:
    text = " ".join(each for each in (port.path, port.description, port.driver) if each)
    if port.holder:
        return warn(f"{text}: open in {port.holder}", "end that program before the bridge opens the port")
    if not port.allowed:
        return fault(f"{text}: not allowed", "sudo usermod -aG dialout $USER, then log in again")
    return ok(f"{text}: free; examine it with: mavhelm bridge doctor serial:{port.path}:{DEFAULT_BAUD}")


def _socket(kind: SocketKind, number: int) -> Finding:
    holders = find_socket_holders(kind, number)
    if not holders:
        return ok("free to listen on")
    return warn(f"taken by {', '.join(holders)}", "another program cannot listen on it: choose another port")
