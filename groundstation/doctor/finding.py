"""Finding: what one row of the chain found."""

from __future__ import annotations

from dataclasses import dataclass

from groundstation.views.doctor import Health, ParamFix


@dataclass(frozen=True, slots=True)
class Finding:
    """How a link of the chain stands, why, and what to do."""

    health: Health
    evidence: str
    advice: str = ""
    action: str = ""
    """As DoctorRow.action."""
    fix: ParamFix | None = None


def ok(evidence: str) -> Finding:
    """Return that all is well."""
    return Finding(Health.OK, evidence)


def warn(evidence: str, advice: str = "", action: str = "", fix: ParamFix | None = None) -> Finding:
    """Return something to look at."""
    return Finding(Health.WARNING, evidence, advice, action, fix)


def fault(evidence: str, advice: str = "", action: str = "", fix: ParamFix | None = None) -> Finding:
    """Return what keeps keys from driving, or the vehicle from stopping."""
    return Finding(Health.FAULT, evidence, advice, action, fix)


def unknown(evidence: str, advice: str = "", action: str = "") -> Finding:
    """Return that it is not known, does not apply, or comes later."""
    return Finding(Health.UNKNOWN, evidence, advice, action)
