"""Rows of the chain about what stops the vehicle without us: the bounds that Drive shows, and settings to change."""

from __future__ import annotations

from groundstation.doctor.facts import DoctorFacts, SettingFact
from groundstation.doctor.finding import fault, ok, unknown, warn
from groundstation.doctor.link_rows import OBEYED
from groundstation.doctor.vehicle_rows import AFTER_VEHICLE
from groundstation.snapshot.drive import StopBound
from groundstation.views.doctor import ChainFinding, ParamFix

REMEDIES = {
    "RC_OVERRIDE_TIME": 0.5,
    "FS_GCS_ENABLE": 1.0,
    "FS_THR_ENABLE": 1.0,
    "COM_RC_IN_MODE": 1.0,
    "COM_RC_LOSS_T": 0.5,
    "NAV_RCL_ACT": 6.0,
    "COM_FAIL_ACT_T": 5.0,
    "COM_DL_LOSS_T": 10.0,
    "NAV_DLL_ACT": 6.0,
}
"""Parameter -> the value that its warning recommends (vehicles/stops/ardupilot_checks.py, px4_checks.py)."""

STOP_BOUNDS = ("RC_OVERRIDE_TIME", "FS_THR_ENABLE", "COM_RC_LOSS_T", "NAV_RCL_ACT", "COM_FAIL_ACT_T", "COM_RC_IN_MODE")
"""Parameters that decide when the motors stop without demands; the others decide on the ground station failsafe, but
for OBEYED, which the row of our id judges for the station that will drive."""


ENABLE, AUTO_GOES_ON = "FS_GCS_ENABLE", 2
"""The parameter of our rover and of ArduPilot; its value with which AUTO continues."""

COMMAND, STATION = ("no command", "... no RC", "... then"), "no station"
"""Names of the bounds that the Drive screen shows (vehicles/stops/stop_bounds.py)."""


def stop_bound(facts: DoctorFacts) -> ChainFinding:
    """Judge what the motors do when demands end."""
    if facts.vehicle is None:
        return AFTER_VEHICLE
    if facts.vehicle.undriven:
        return unknown("not driven from here")
    wrong = [each for each in facts.settings if each.warning and each.name in STOP_BOUNDS]
    if wrong:
        return _wrong(wrong[0])
    stops = tuple(each for each in facts.vehicle.stops if each.name in COMMAND)
    never = next((each for each in stops if each.never), None)
    if never is not None:
        return _never(never, stops, facts)
    if facts.unread:
        return warn(f"could not read {', '.join(facts.unread)}", "drive slowly: it is not known when it stops")
    known = [_words(each) for each in stops if each.bound is not None]
    return ok(f"{', '.join(known)} after the last demand") if known else unknown("not known yet")


def gcs_failsafe(facts: DoctorFacts) -> ChainFinding:
    """Judge what the vehicle does when the ground station is lost."""
    if facts.vehicle is None:
        return AFTER_VEHICLE
    wrong = [each for each in facts.settings if each.warning and each.name not in (*STOP_BOUNDS, *OBEYED)]
    if wrong:
        return _wrong(wrong[0])
    stop = next((each for each in facts.vehicle.stops if each.name == STATION), None)
    enable = facts.params.get(ENABLE)
    if stop is not None and stop.never:
        return _no_failsafe(stop, enable)
    if stop is None or stop.bound is None:
        return unknown("not known yet")
    except_auto = " except in AUTO" if enable == AUTO_GOES_ON else ""
    return ok(f"{stop.does} {stop.bound:g} s after the ground station is lost{except_auto}")


def _words(stop: StopBound) -> str:
    """Return a bound in words. ArduPilot's bounds without RC follow the one before."""
    without_rc = " later without RC" if stop.name == COMMAND[1] else ""
    return f"{stop.does} {stop.bound:g} s{without_rc} ({stop.source})"


def _never(never: StopBound, stops: tuple[StopBound, ...], facts: DoctorFacts) -> ChainFinding:
    """Return a bound that is switched off. Where another one still stops the motors, nothing follows it."""
    value = facts.params.get(never.source)
    before = [each for each in stops[: stops.index(never)] if each.name == never.name and each.bound is not None]
    if before:
        return warn(f"{_words(before[-1])}, then nothing", "select an action on the Params screen", "app.params")
    remedy = REMEDIES.get(never.source)
    fix = None if value is None or remedy is None else ParamFix(never.source, value, remedy)
    return fault(f"{never.source}: never stops when the link is lost", "change it on the Params screen",
                 "app.params", fix)  # fmt: skip


def _no_failsafe(stop: StopBound, enable: float | None) -> ChainFinding:
    """Return that nothing follows when the ground station is lost."""
    if enable == AUTO_GOES_ON:
        return warn(f"{ENABLE} 2: AUTO goes on when the ground station is lost", "set it to 1", "app.params",
                    ParamFix(ENABLE, enable, 1.0))  # fmt: skip
    if enable == 0:
        text = f"{ENABLE} 0: no failsafe when the ground station is lost"
        return warn(text, "set it to 1", "app.params", ParamFix(ENABLE, enable, 1.0))
    text = f"{stop.source}: its action is switched off, no failsafe when the ground station is lost"
    return warn(text, "select an action on the Params screen", "app.params")


def _wrong(setting: SettingFact) -> ChainFinding:
    """Return a setting to change. One by which the vehicle never stops is a fault."""
    evidence, _, _ = setting.warning.partition(";")
    value = REMEDIES.get(setting.name)
    fix = None if value is None else ParamFix(setting.name, setting.value, value)
    advice = f"set it to {value:g}" if value is not None else "change it"
    severe = "never stops" in setting.warning or "keys do not drive" in setting.warning
    return (fault if severe else warn)(evidence, advice, "app.params", fix)
