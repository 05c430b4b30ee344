"""fleet.toml: who belongs to a fleet, and what each operator may do. `mavhelm bridge router` reads it at its start."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from link.endpoint import FLEET_NAME, FLEET_NAME_RULE, EndpointError, parse_endpoint
from link.toml.errors import explain_error
from link.toml.file import TomlError, read_toml

FILE = "fleet.toml"
AUTHORITY, AUTHORITY_KEY = "authority.pem", "authority.key"
"""Signs all certificates. Its key is needed to add members only, not by the router."""
ROUTER, ROUTER_KEY = "router.pem", "router.key"
ROUTER_NAME = "router"
"""Common name of its certificate; those of members end with a random number."""

TEMPLATE = """\
# Who belongs to the fleet {fleet}. `mavhelm bridge router {file}` reads this at its start.
# To withdraw a certificate, delete the lines of its owner and restart the router.
fleet = "{fleet}"
listen = ["tls/[::]:{port}"]
# Where vehicles and operators connect; written into their files.
routers = [{routers}]
"""

Name = Annotated[str, msgspec.Meta(min_length=1)]


class FleetVehicle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One vehicle."""

    certificate: Name
    """Common name of its certificate: of several that were made for the same name, only this one counts."""


class FleetOperator(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One operator."""

    role: Literal["watch", "drive", "setup"]
    certificate: Name


class FleetFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole file."""

    fleet: Name
    listen: Annotated[list[Name], msgspec.Meta(min_length=1)]
    routers: Annotated[list[Name], msgspec.Meta(min_length=1)]
    vehicles: dict[str, FleetVehicle] = {}
    operators: dict[str, FleetOperator] = {}

    @property
    def names(self) -> set[str]:
        """All names that are taken."""
        return {*self.vehicles, *self.operators}


def read_fleet_file(path: Path) -> FleetFile:
    """Read and check the file. Raises TomlError: file, key, error, remedy."""
    table = read_toml(path)
    try:
        found = msgspec.convert(table, FleetFile)
    except msgspec.ValidationError as error:
        raise TomlError(f"{path}: {explain_error(error, FleetFile, '')}") from None
    for problem in _find_problems(found):
        raise TomlError(f"{path}: {problem}")
    return found


def add_row(path: Path, kind: str, name: str, row: dict[str, str]) -> str:
    """Return the text of the file with one more member at its end; what the user wrote stays."""
    lines = [f"[{kind}.{_quoted(name)}]", *(f'{key} = "{value}"' for key, value in row.items())]
    return path.read_text().rstrip("\n") + "\n\n" + "\n".join(lines) + "\n"


def _quoted(name: str) -> str:
    return f'"{name}"' if "." in name else name


def _find_problems(found: FleetFile) -> Iterator[str]:
    for name in (found.fleet, *found.names):
        if not re.fullmatch(FLEET_NAME, name):
            yield f"{name!r} is not a name; it has {FLEET_NAME_RULE}"
    for key in ("listen", "routers"):
        for locator in getattr(found, key):
            if problem := locator_problem(locator):
                yield f"{key}: {problem}"
    for name in set(found.vehicles) & set(found.operators):
        yield f"{name} is a vehicle and an operator; rename one of them"
    certificates = [each.certificate for each in found.vehicles.values()]
    certificates += [each.certificate for each in found.operators.values()]
    for certificate in {each for each in certificates if certificates.count(each) > 1}:
        yield f"certificate {certificate} is given twice; each member has its own"


def locator_problem(locator: str) -> str | None:
    """Return why this is not an address with certificates, or None."""
    try:
        parse_endpoint(f"zenoh:{locator}/fleet")
    except EndpointError:
        return f"{locator!r} is not an address; write tls/HOST:PORT or quic/HOST:PORT"
    if not locator.startswith(("tls/", "quic/")):
        return f"{locator!r} has no certificates; write tls/ or quic/"
    return None
