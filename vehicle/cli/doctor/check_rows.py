"""Rows of `mavhelm vehicle doctor` that judge what its `check` finds: file, motors, accessories, sensors, links."""

from __future__ import annotations

from collections.abc import Sequence

from link.runtime.diagnosis import Finding, fault, fault_of, ok, unknown, warn
from vehicle.cli.check import CheckResult
from vehicle.cli.doctor.facts import VehicleDoctorFacts

AFTER_CONFIG = unknown("after the errors of the file are corrected")
IN_USE = "in use by the vehicle that runs: not examined"
STOP_FIRST = "to examine it: sudo systemctl stop rover, then again"
STOPPED_AT = ("settings", "parameters")


def config(facts: VehicleDoctorFacts) -> Finding:
    """Judge the configuration file and the saved parameters."""
    failed = [each for each in facts.select(*STOPPED_AT) if not each.ok]
    if failed and failed[0].item == "parameters":
        return warn(*_split(failed[0].detail))
    if failed:
        more = f" (+{len(failed) - 1} more: mavhelm vehicle check {facts.path})" if len(failed) > 1 else ""
        evidence, advice = _split(failed[0].detail)
        return fault(f"{evidence}{more}", advice or f"correct it, then: mavhelm vehicle doctor {facts.path}")
    counts = "; ".join(each.detail for each in facts.select("parameters"))
    return ok(f"{facts.path}; parameters: {counts}")


def motors(facts: VehicleDoctorFacts) -> Finding:
    """Judge the motors' driver, opened in neutral and without power."""
    return _judge(facts, facts.select("motors"))


def accessories(facts: VehicleDoctorFacts) -> Finding:
    """Judge relays and servos, opened in their safe state."""
    return _judge(facts, facts.select("relay", "servo"))


def sensors(facts: VehicleDoctorFacts) -> Finding:
    """Judge battery monitor, GPS and encoders. A sensor that fails does not stop the rover."""
    found = _judge(facts, [each for each in facts.select("sensors.") if each.item != "sensors.computer"])
    failed = [each for each in facts.select("sensors.") if not each.ok and each.item != "sensors.computer"]
    if failed and not any(each.item == "sensors.battery" for each in failed):
        return warn(found.evidence, found.advice)
    return found


def links(facts: VehicleDoctorFacts) -> Finding:
    """Judge the endpoints, opened and closed again."""
    return _judge(facts, facts.select("endpoint"))


def _judge(facts: VehicleDoctorFacts, checks: Sequence[CheckResult]) -> Finding:
    """Return the first failure, or what all of them found."""
    if not facts.readable:
        return AFTER_CONFIG
    failed = [each for each in checks if not each.ok and not (each.busy and facts.running)]
    if failed:
        more = f" (+{len(failed) - 1} more)" if len(failed) > 1 else ""
        found = fault_of(_named(failed[0]))
        return fault(f"{found.evidence}{more}", found.advice)
    if any(not each.ok for each in checks):
        return unknown(IN_USE, STOP_FIRST)
    return ok("; ".join(map(_named, checks))) if checks else unknown("none is configured")


def _named(check: CheckResult) -> str:
    """Return the result with what it is about, unless the row's title says it."""
    name = check.item.removeprefix("endpoint ").removeprefix("sensors.")
    return check.detail if name in ("motors", "endpoints") else f"{name}: {check.detail}"


def _split(text: str) -> tuple[str, str]:
    evidence, _, advice = text.partition("; ")
    return evidence, advice
