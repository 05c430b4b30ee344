"""What a vehicle says of itself as diagnostic_msgs and as lines of /rosout."""

from __future__ import annotations

from dialects.enums import Severity
from groundstation.ros.vehicle import Values
from groundstation.snapshot import VehicleView

OK, WARN, ERROR, STALE = 0, 1, 2, 3
"""diagnostic_msgs/msg/DiagnosticStatus."""
LOG_LEVELS = {
    Severity.EMERGENCY: 50, Severity.ALERT: 50, Severity.CRITICAL: 50, Severity.ERROR: 40, Severity.WARNING: 30,
    Severity.NOTICE: 20, Severity.INFO: 20, Severity.DEBUG: 10,
}  # fmt: skip
"""MAV_SEVERITY -> level of rcl_interfaces/msg/Log."""


def diagnostics(view: VehicleView, driving: bool, now: int) -> Values:
    """Return a DiagnosticArray with one status. `driving`: this program demands; `now`: Unix time, us."""
    level, message = _judge(view)
    facts = {
        "armed": view.armed,
        "mode": view.mode,
        "driver": "" if view.driver is None else view.driver,
        "driven from ROS": driving,
        "failsafes": " ".join(view.failsafes),
        "silence": f"{view.silence:.1f}",
    }
    status = {
        "level": level,
        "name": f"mavhelm: {view.name}",
        "message": message,
        "hardware_id": str(view.system),
        "values": [{"key": key, "value": str(value)} for key, value in facts.items()],
    }
    return {"header": (now, ""), "status": [status]}


def log_line(text: str, severity: int, name: str, now: int) -> Values:
    """Return a Log of a text of the vehicle. `now`: Unix time, us."""
    level = LOG_LEVELS.get(Severity(severity), 20) if severity in set(Severity) else 20
    return {"stamp": (now,), "level": level, "name": name, "msg": text, "file": "", "function": "", "line": 0}


def _judge(view: VehicleView) -> tuple[int, str]:
    if not view.alive:
        return STALE, f"not heard for {view.silence:.0f} s"
    if view.failsafes:
        return ERROR, f"failsafe: {' '.join(view.failsafes)}"
    if view.prearm is False and not view.armed:
        return WARN, view.prearm_reason or "not ready to arm"
    return OK, f"{'armed' if view.armed else 'disarmed'}, {view.mode}"
