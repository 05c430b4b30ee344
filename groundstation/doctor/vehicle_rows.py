"""Rows of the chain in the vehicle: control, pre-arm, mode, armed, fence, battery, motors."""

from __future__ import annotations

from dialects.enums import Autopilot, Sensor, SystemState, state_name
from dialects.mode_tables import HOLD
from groundstation.doctor.facts import DoctorFacts
from groundstation.doctor.finding import fault, ok, unknown, warn
from groundstation.doctor.prearm_advice import find_advice
from groundstation.snapshot import VehicleView
from groundstation.views.doctor import ChainFinding, ParamFix

AFTER_VEHICLE = unknown("after the vehicle is heard")

LOW_CHARGE = 0.2
"""Share of the charge from which on to go home."""


def control(facts: DoctorFacts) -> ChainFinding:
    """Judge who is in control."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    if facts.clash:
        return fault(
            "two programs send with the ids of the driver", f"end one of them, or {facts.another_id}", "app.links"
        )
    if view.in_control:
        return ok("this station")
    if view.duplicate_gcs:
        return fault(f"another program with our id {view.driver}", f"end it, or {facts.another_id}", "app.links")
    if view.driver == facts.system:
        return ok(f"ground station {view.driver}")
    if view.driver:
        waits = "" if view.control_wait is None else f", may answer for {view.control_wait:.0f} s"
        return fault(f"ground station {view.driver}{waits}", "request control", "vehicle.control")
    if view.armed:
        return _armed_without_control(view, facts)
    return ok("nobody: arming takes it" if view.driver == 0 else "not managed by this vehicle: arming takes it")


def _armed_without_control(view: VehicleView, facts: DoctorFacts) -> ChainFinding:
    """Judge an armed vehicle of which this program is not in control: a verb runs beside a station that may be."""
    if view.driver is None and facts.terminal is None:
        return unknown("armed; this vehicle does not report who is in control")
    return fault("armed, and not in control", "request control", "vehicle.control")


def pre_arm(facts: DoctorFacts) -> ChainFinding:
    """Judge the pre-arm checks."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    if view.armed:
        return ok("passed: the vehicle is armed")
    if view.prearm:
        return ok("passed")
    texts = facts.texts
    if not texts:
        if view.prearm is None and view.autopilot == Autopilot.PX4:
            return _pre_arm_of_px4(view)
        if view.prearm is None:
            return unknown("not reported by this vehicle", "run the checks", "setup.checks")
        return fault("fail, and the vehicle has not said why", "run the checks", "setup.checks")
    advice = find_advice(texts[0].text)
    more = f" (+{len(texts) - 1})" if len(texts) > 1 else ""
    return fault(f"{texts[0].text}{more}", advice or "put it right, then check again", "setup.checks")


def _pre_arm_of_px4(view: VehicleView) -> ChainFinding:
    """Judge by HEARTBEAT: STANDBY if its checks pass, else UNINIT, also while nobody sends MANUAL_CONTROL.

    Its reasons are EVENTs (https://docs.px4.io/main/en/concept/events_interface.html), which are not read.
    """
    if view.status == SystemState.STANDBY:
        return ok("passed: HEARTBEAT says STANDBY")
    text = f"its checks do not pass now: HEARTBEAT says {state_name(view.status).upper()}"
    return warn(text, "arm from Drive, which sends MANUAL_CONTROL first; its console says more: commander check")


def mode(facts: DoctorFacts) -> ChainFinding:
    """Judge whether the mode lets sticks drive."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    if view.undriven:
        return fault(view.undriven, "drive a rover or a boat")
    if view.drivable:
        return ok(f"{view.mode}: keys drive")
    if view.mode == HOLD and not view.armed:
        return warn("HOLD: arming changes to MANUAL", "set MANUAL", "vehicle.manual")
    if view.mode == HOLD:
        return fault("HOLD: the sticks do nothing", "set MANUAL", "vehicle.manual")
    return fault(f"{view.mode}: the vehicle drives itself, keys do not", "set MANUAL", "vehicle.manual")


def armed(facts: DoctorFacts) -> ChainFinding:
    """Judge the emergency stop and the arming."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    if view.emergency_stop:
        return fault("EMERGENCY STOP: the motors are locked", "release it on Drive", "app.drive")
    if view.undriven:
        return unknown("armed, not from here" if view.armed else "no, and not from here")
    if view.armed:
        return ok("armed: keys drive on Drive (F1)")
    if view.refusal and view.refusal.startswith("arm"):
        return fault(view.refusal, "put it right, then arm on Drive", "app.drive")
    return unknown("no", "arm it on Drive", "app.drive")


def failsafes(facts: DoctorFacts) -> ChainFinding:
    """Judge which failsafes act now."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    others = [each for each in view.failsafes if each != "estop"]
    if others:
        return fault(f"active: {', '.join(others)}", "see the log for the reason", "app.log")
    if view.status in (5, 6) and not view.emergency_stop:
        return fault("the vehicle reports a failsafe or a fault", "see the log for the reason", "app.log")
    return ok("none acts")


def fence(facts: DoctorFacts) -> ChainFinding:
    """Judge the fence."""
    return AFTER_VEHICLE if facts.vehicle is None else _fence(facts.vehicle, facts)


def _fence(view: VehicleView, facts: DoctorFacts) -> ChainFinding:
    bits = facts.sensors
    if view.breach:
        return fault(f"{view.name} is {view.breach}", "drive back in MANUAL", "app.log")
    if "fence" in view.failsafes or "fence" in view.limits:
        return fault("breached, or it stops the vehicle here", "drive back in MANUAL", "app.log")
    if bits is None or not bits.present & Sensor.GEOFENCE:
        return unknown("none is loaded")
    if not bits.enabled & Sensor.GEOFENCE:
        if facts.rover_dialect:
            return warn("loaded, but off", "switch it on", fix=ParamFix("FENCE_ENABLE", 0.0, 1.0))
        return unknown("off; `fence show` says whether one is loaded")
    return ok("on, and inside") if bits.health & Sensor.GEOFENCE else fault("breached", "drive back", "app.log")


def battery(facts: DoctorFacts) -> ChainFinding:
    """Judge the battery."""
    view = facts.vehicle
    if view is None:
        return AFTER_VEHICLE
    if view.battery_voltage is None:
        return unknown("not reported")
    charge = "" if view.battery_remaining is None else f", {view.battery_remaining:.0%}"
    text = f"{view.battery_voltage:.1f} V{charge}"
    low = facts.params.get("BATT_LOW_VOLT")
    if low and view.battery_voltage <= low:
        return warn(f"{text}: below BATT_LOW_VOLT {low:g}", "charge it")
    if view.battery_remaining is not None and view.battery_remaining < LOW_CHARGE:
        return warn(text, "charge it")
    return ok(f"{text}, above BATT_LOW_VOLT {low:g}" if low else text)


def motors(facts: DoctorFacts) -> ChainFinding:
    """Judge the outputs."""
    view, bits = facts.vehicle, facts.sensors
    if view is None:
        return AFTER_VEHICLE
    has = bits is not None and bits.present & Sensor.MOTOR_OUTPUTS and bits.enabled & Sensor.MOTOR_OUTPUTS
    if has and bits is not None and not bits.health & Sensor.MOTOR_OUTPUTS:
        return fault("the motor driver has failed", "see the log for the reason", "app.log")
    if view.armed and any(output.value for output in view.outputs):
        return ok(", ".join(f"{output.name} {output.value:+.0%}" for output in view.outputs))
    tested = ", ".join(map(str, sorted(facts.motors_tested)))
    if tested:
        return ok(f"tested in this session: {tested}")
    return unknown(_outputs(view), "test them, wheels off the ground", "setup.motors")


def _outputs(view: VehicleView) -> str:
    names = ", ".join(output.name for output in view.outputs)
    return f"{names}: not tested in this session" if names else "not tested in this session"
