"""Build the finding of a row of the chain: all is well, a warning, a fault, or not known."""

from __future__ import annotations

from groundstation.views.doctor import ChainFinding, ParamFix
from link.runtime.diagnosis import Health


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
