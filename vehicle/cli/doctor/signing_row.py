"""The row `signing` of `mavhelm vehicle doctor`: who may send commands over a network."""

from __future__ import annotations

from link.runtime.diagnosis import Finding, fault, fault_of, ok, warn
from vehicle.cli.doctor.check_rows import AFTER_CONFIG
from vehicle.cli.doctor.facts import VehicleDoctorFacts

NEW_KEY = "mavhelm vehicle key new NAME, then install it at the ground station (docs/security.md)"
SHOWN = "write each name under [signing] private as `ip link` shows it, and restart after the tunnel has come up"
CLOSE = "remove allow_unsigned; each ground station then needs a key (docs/security.md)"


def signing(facts: VehicleDoctorFacts) -> Finding:
    """Judge keys, and the links that a whole network reaches."""
    if not facts.readable:
        return AFTER_CONFIG
    if facts.key_problem:
        return fault_of(facts.key_problem)
    keys = f"keys: {', '.join(facts.keys)}" if facts.keys else "no key"
    if facts.signing.required:
        return ok(f"{keys}; nothing unsigned is obeyed") if facts.keys else fault("required, but no key", NEW_KEY)
    if facts.missing_interfaces:
        return warn(f"private names no interface of now: {', '.join(facts.missing_interfaces)}", SHOWN)
    if not facts.open_links:
        reasons = ", ".join(dict.fromkeys(facts.trusted_links.values()))
        return ok(f"{keys}; no link is open to a network: {reasons}")
    links = ", ".join(facts.open_links)
    if facts.signing.allow_unsigned:
        return warn(f"{links}: everybody in the network may drive (allow_unsigned)", CLOSE)
    if facts.keys:
        return ok(f"{keys}; {links}: others may watch and stop")
    return warn(f"{links}: nobody may drive over the network, there is no key", NEW_KEY)
