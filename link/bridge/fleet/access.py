"""The access rules of a router: which certificate may publish and hear under which keys. Sans-IO.

What no rule allows is denied, also to certificates of the fleet that fleet.toml does not name. Rules are those of
link/fleet/keys.py, in Zenoh's terms: https://zenoh.io/docs/manual/access-control/
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from link.bridge.fleet.fleet_file import ROUTER_NAME, FleetFile
from link.signing.role import ROLES

_PUBLISH = ("put",)
_TOKEN = ("liveliness_token",)
_HEAR = ("declare_subscriber",)
_HEAR_TOKENS = ("declare_liveliness_subscriber", "liveliness_query")
_GET = ("put", "liveliness_token", "declare_subscriber", "declare_liveliness_subscriber")
IN, OUT = "ingress", "egress"
"""From a member to the router, and the other way."""

_Rule = tuple[str, tuple[str, ...], list[str]]
"""Direction, kinds of Zenoh messages, keys."""


def build_access(fleet: FleetFile) -> dict[str, Any]:
    """Return `access_control` of a router's Zenoh configuration."""
    rules: list[dict[str, Any]] = []
    subjects, policies = [], []
    for certificate, allowed in _members(fleet):
        ids = []
        for number, (flow, messages, keys) in enumerate(allowed):
            ids.append(f"{certificate} {number}")
            rules.append(
                {"id": ids[-1], "permission": "allow", "flows": [flow], "messages": messages, "key_exprs": keys}
            )
        subjects.append({"id": certificate, "cert_common_names": [certificate]})
        policies.append({"subjects": [certificate], "rules": ids})
    found: dict[str, Any] = {"enabled": True, "default_permission": "deny"}
    return found | {"rules": rules, "subjects": subjects, "policies": policies}


_ALL = (*_GET, "liveliness_query")
"""What linked routers pass on to each other: each has checked it when it came from a member."""


def _members(fleet: FleetFile) -> Iterator[tuple[str, list[_Rule]]]:
    everything = [f"fleet/{fleet.fleet}/**"]
    yield ROUTER_NAME, [(IN, _ALL, everything), (OUT, _ALL, everything)]
    for name, vehicle in fleet.vehicles.items():
        yield vehicle.certificate, _vehicle_rules(f"fleet/{fleet.fleet}/{name}")
    for name, operator in fleet.operators.items():
        yield operator.certificate, _operator_rules(f"fleet/{fleet.fleet}/*", name, operator.role, ROLES)


def _vehicle_rules(base: str) -> list[_Rule]:
    return [
        (IN, _PUBLISH, [f"{base}/up/**"]),
        (IN, _TOKEN, [f"{base}/alive"]),
        (IN, _HEAR, [f"{base}/down/**"]),
        (IN, _HEAR_TOKENS, [f"{base}/gcs/**"]),
        (OUT, _GET, [f"{base}/**"]),
    ]


def _operator_rules(base: str, name: str, role: str, roles: Mapping[str, int]) -> list[_Rule]:
    granted = [word for word, rank in roles.items() if rank <= roles[role]]
    return [
        (IN, _PUBLISH, [f"{base}/down/{name}/*/{word}/**" for word in granted]),
        (IN, _TOKEN, [f"{base}/gcs/{name}/**"]),
        (IN, _HEAR, [f"{base}/up/{name}/**"]),
        (IN, _HEAR_TOKENS, [f"{base}/alive"]),
        (OUT, _GET, [f"{base}/up/{name}/**", f"{base}/alive", f"{base}/down/{name}/**", f"{base}/gcs/{name}/**"]),
    ]
