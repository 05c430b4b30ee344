"""The folder of a fleet: makes it, and adds vehicles and operators. Each gets one file to copy."""

from __future__ import annotations

import base64
import json
import re
import secrets
from collections.abc import Sequence
from pathlib import Path

from link.bridge.fleet.certificates import KeyPair, make_authority, make_member
from link.bridge.fleet.fleet_file import (
    AUTHORITY,
    AUTHORITY_KEY,
    FILE,
    ROUTER,
    ROUTER_KEY,
    ROUTER_NAME,
    TEMPLATE,
    FleetFile,
    add_row,
    locator_problem,
    read_fleet_file,
)
from link.endpoint import FLEET_NAME, FLEET_NAME_RULE
from link.fleet.config import VEHICLE_ROLE
from link.fleet.locator import read_locator
from link.runtime.whole_file import PRIVATE, SHARED, replace_file

PORT = 7447
"""Zenoh's usual one."""


class FleetError(Exception):
    """What was asked for cannot be done; one line."""


def new_fleet(folder: Path, fleet: str, hosts: Sequence[str], port: int = PORT) -> Path:
    """Make the folder of a fleet; return its fleet.toml. Raises FleetError, CertificateError and OSError."""
    _check_name(fleet)
    routers = [f"tls/{f'[{each}]' if ':' in each else each}:{port}" for each in hosts]
    for locator in routers:
        if problem := locator_problem(locator):
            raise FleetError(f"--host: {problem}")
    path = folder / FILE
    if path.exists():
        raise FleetError(f"{path} exists already; add to it with `mavhelm bridge fleet add`, or name another folder")
    authority = make_authority(fleet)
    router = make_member(ROUTER_NAME, authority, hosts)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    _write_pair(folder, AUTHORITY, AUTHORITY_KEY, authority)
    _write_pair(folder, ROUTER, ROUTER_KEY, router)
    named = ", ".join(f'"{each}"' for each in routers)
    replace_file(path, TEMPLATE.format(fleet=fleet, file=path, port=port, routers=named).encode())
    return path


def add_member(path: Path, name: str, role: str) -> Path:
    """Add a vehicle, or an operator with a role; return the file to copy. Raises FleetError, TomlError, OSError."""
    fleet = read_fleet_file(path)
    _check_name(name)
    if name in fleet.names:
        raise FleetError(f"{path} has {name} already; delete its lines first, which withdraws its certificate")
    common_name = f"{name}-{secrets.token_hex(4)}"
    pair = make_member(common_name, _read_authority(path.parent))
    own = path.parent / f"{name}.json5"
    replace_file(own, _member_file(fleet, name, role, path.parent, pair), mode=PRIVATE)
    row = {"certificate": common_name} if role == VEHICLE_ROLE else {"role": role, "certificate": common_name}
    text = add_row(path, "vehicles" if role == VEHICLE_ROLE else "operators", name, row)
    replace_file(path, text.encode(), mode=SHARED)
    return own


def renew(path: Path, name: str) -> Path:
    """Give a member, or the router, a certificate that holds anew for its whole time; return the file.

    Its name in the certificate stays, so that no other file changes and the router need not restart for a member. The
    old certificate holds until its own end. Raises FleetError, TomlError, CertificateError and OSError.
    """
    fleet = read_fleet_file(path)
    authority = _read_authority(path.parent)
    if name == ROUTER_NAME and name not in fleet.names:
        hosts = [place.host for each in fleet.routers if (place := read_locator(each))]
        _write_pair(path.parent, ROUTER, ROUTER_KEY, make_member(ROUTER_NAME, authority, hosts))
        return path.parent / ROUTER
    operator, vehicle = fleet.operators.get(name), fleet.vehicles.get(name)
    if operator is None and vehicle is None:
        raise FleetError(f"{path} has no {name}; it has {', '.join(sorted(fleet.names)) or 'no members'}")
    role, row = (operator.role, operator.certificate) if operator else (VEHICLE_ROLE, vehicle.certificate)  # type: ignore[union-attr]
    pair = make_member(row, authority)
    own = path.parent / f"{name}.json5"
    replace_file(own, _member_file(fleet, name, role, path.parent, pair), mode=PRIVATE)
    return own


def read_encoded(path: Path) -> str:
    """Return a file as Zenoh's settings take it."""
    return base64.b64encode(path.read_bytes()).decode()


def _member_file(fleet: FleetFile, name: str, role: str, folder: Path, pair: KeyPair) -> bytes:
    tls = {
        "root_ca_certificate_base64": read_encoded(folder / AUTHORITY),
        "connect_certificate_base64": base64.b64encode(pair.certificate).decode(),
        "connect_private_key_base64": base64.b64encode(pair.key).decode(),
        "enable_mtls": True,
    }
    config = {
        "connect": {"endpoints": fleet.routers},
        "metadata": {"mavhelm": {"fleet": fleet.fleet, "name": name, "role": role}},
        "transport": {"link": {"tls": tls}},
    }
    note = f"// {name} in the fleet {fleet.fleet}. Who has this file is {name}: keep it to its user (mode 0600).\n"
    return (note + json.dumps(config, indent=2) + "\n").encode()


def _check_name(name: str) -> None:
    if not re.fullmatch(FLEET_NAME, name):
        raise FleetError(f"{name!r} is not a name; it has {FLEET_NAME_RULE}")


def _read_authority(folder: Path) -> KeyPair:
    return KeyPair((folder / AUTHORITY).read_bytes(), (folder / AUTHORITY_KEY).read_bytes())


def _write_pair(folder: Path, certificate: str, key: str, pair: KeyPair) -> None:
    replace_file(folder / certificate, pair.certificate)
    replace_file(folder / key, pair.key, mode=PRIVATE)
