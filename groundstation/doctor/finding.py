"""ChainFinding: what one row of the chain found, and the key or the parameter that mends it."""

from __future__ import annotations

import msgspec

from groundstation.views.doctor import ParamFix
from link.runtime.diagnosis import Health


class ChainFinding(msgspec.Struct, frozen=True):
    """How a link of the chain stands, why, and what to do."""

    health: Health
    evidence: str
    advice: str = ""
    action: str = ""
    """As DoctorRow.action."""
    fix: ParamFix | None = None


def ok(evidence: str) -> ChainFinding:
    """Return that all is well."""
    return ChainFinding(Health.OK, evidence)


def warn(evidence: str, advice: str = "", action: str = "", fix: ParamFix | None = None) -> ChainFinding:
    """Return something to look at."""
    return ChainFinding(Health.WARNING, evidence, advice, action, fix)


def fault(evidence: str, advice: str = "", action: str = "", fix: ParamFix | None = None) -> ChainFinding:
    """Return what keeps keys from driving, or the vehicle from stopping."""
    return ChainFinding(Health.FAULT, evidence, advice, action, fix)


def unknown(evidence: str, advice: str = "", action: str = "") -> ChainFinding:
    """Return that it is not known, does not apply, or comes later."""
    return ChainFinding(Health.UNKNOWN, evidence, advice, action)
