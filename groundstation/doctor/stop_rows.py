"""Rows of the chain about what stops the vehicle without us: stop bound, settings that switch a failsafe off."""

from __future__ import annotations

from groundstation.doctor.facts import DoctorFacts, SettingFact
from groundstation.doctor.finding import Finding, fault, ok, unknown, warn
from groundstation.doctor.vehicle_rows import AFTER_VEHICLE
from groundstation.views.doctor import ParamFix

REMEDIES = {
    "RC_OVERRIDE_TIME": 0.5,
    "FS_GCS_ENABLE": 1.0,
    "FS_THR_ENABLE": 1.0,
    "COM_RC_IN_MODE": 1.0,
    "COM_RC_LOSS_T": 0.5,
    "NAV_RCL_ACT": 1.0,
    "COM_DL_LOSS_T": 10.0,
    "NAV_DLL_ACT": 1.0,
}
"""Parameter -> the value that its warning recommends (vehicles/ardupilot_checks.py, px4_checks.py)."""

STOP_BOUNDS = ("RC_OVERRIDE_TIME", "FS_THR_ENABLE", "COM_RC_LOSS_T", "NAV_RCL_ACT", "COM_RC_IN_MODE")
"""Parameters that decide when the motors stop without demands; the others decide on the ground station failsafe."""


def stop_bound(facts: DoctorFacts) -> Finding:
    """Judge what the motors do when demands end."""
    if facts.vehicle is None:
        return AFTER_VEHICLE
    wrong = [each for each in facts.settings if each.warning and each.name in STOP_BOUNDS]
    if wrong:
        return _wrong(wrong[0])
    if facts.rover_dialect and facts.manual_timeout is not None:
        return ok(f"neutral {facts.manual_timeout:g} s after the last demand (MAN_TIMEOUT)")
    if facts.unread:
        return warn(f"could not read {', '.join(facts.unread)}", "drive slowly: it is not known when it stops")
    return ok(facts.vehicle.without_link) if facts.vehicle.without_link else unknown("not known yet")


def gcs_failsafe(facts: DoctorFacts) -> Finding:
    """Judge what the vehicle does when the ground station is lost."""
    if facts.vehicle is None:
        return AFTER_VEHICLE
    wrong = [each for each in facts.settings if each.warning and each.name not in STOP_BOUNDS]
    if wrong:
        return _wrong(wrong[0])
    enable, timeout = facts.params.get("FS_GCS_ENABLE"), facts.params.get("FS_GCS_TIMEOUT")
    if enable == 0:
        fix = ParamFix("FS_GCS_ENABLE", 0.0, 1.0)
        return warn("FS_GCS_ENABLE 0: no failsafe when the ground station is lost", "set it to 1", "app.params", fix)
    if enable is not None and timeout is not None:
        except_auto = " except in AUTO" if enable == 2 else ""
        return ok(f"HOLD {timeout:g} s after the ground station is lost{except_auto}")
    if facts.settings:
        return ok("on")
    return unknown("not known yet")


def _wrong(setting: SettingFact) -> Finding:
    """Return a setting to change. One by which the vehicle never stops is a fault."""
    evidence, _, _ = setting.warning.partition(";")
    value = REMEDIES.get(setting.name)
    fix = None if value is None else ParamFix(setting.name, setting.value, value)
    advice = f"set it to {value:g}" if value is not None else "change it"
    severe = "never stops" in setting.warning or "keys do not drive" in setting.warning
    return (fault if severe else warn)(evidence, advice, "app.params", fix)
