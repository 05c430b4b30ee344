"""Command line of `mavhelm bridge fleet`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from link.bridge.fleet.certificates import CertificateError
from link.bridge.fleet.fleet_file import FILE, ROUTER, read_fleet_file
from link.bridge.fleet.members import PORT, FleetError, add_member, new_fleet, renew
from link.fleet.config import VEHICLE_ROLE
from link.runtime.command_line import CommandLineParser
from link.signing.role import ROLES
from link.toml.file import TomlError

HELP = """\
examples:
  mavhelm bridge fleet new farm --host fleet.example.org      makes the folder farm: authority, router, fleet.toml
  mavhelm bridge fleet add vehicle rover1 --folder farm       makes farm/rover1.json5, to be copied to the rover
  mavhelm bridge fleet add operator alice --role drive --folder farm
  mavhelm bridge fleet renew alice --folder farm              a new certificate for alice, before the old one ends
  mavhelm bridge router farm/fleet.toml                       on the machine fleet.example.org

roles: watch (see, and stop), drive (also arm, drive, change modes), setup (also parameters, plans, files).
docs/fleet.md tells the whole way. exit codes: 0 done, 2 usage error.
"""


def run(arguments: Sequence[str]) -> int:
    """Do what was asked, print what to do next, and return the exit code."""
    parser = build_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    try:
        lines = {"new": _new, "add": _add, "renew": _renew}[options.command](options)
    except (FleetError, TomlError, CertificateError) as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    except OSError as error:
        parser.exit(2, f"{parser.prog}: {error.filename}: {error.strerror}\n")
    sys.stdout.writelines(f"{line}\n" for line in lines)
    return 0


def _new(options: argparse.Namespace) -> list[str]:
    folder = Path(options.fleet) if options.folder is None else options.folder
    path = new_fleet(folder, options.fleet, options.host, options.port)
    return [
        f"{path}: made, with the authority and the router's certificate beside it",
        f"next: mavhelm bridge fleet add vehicle rover1 --folder {folder}",
        f"      mavhelm bridge fleet add operator alice --role drive --folder {folder}",
        f"      mavhelm bridge router {path}",
    ]


def _add(options: argparse.Namespace) -> list[str]:
    folder = options.folder or Path()
    is_vehicle = options.kind == "vehicle"
    own = add_member(folder / FILE, options.name, VEHICLE_ROLE if is_vehicle else options.role)
    fleet = read_fleet_file(folder / FILE).fleet
    end = f"zenoh:{own.name}/{fleet}"
    program = f"mavhelm vehicle --config rover.toml {end}/{options.name}" if is_vehicle else f"mavhelm {end}"
    return [
        f"{own}: made; copy it to {options.name} and to nobody else, mode 0600",
        f"there: {program}",
        "if the router runs, restart it: it reads fleet.toml at its start",
    ]


def _renew(options: argparse.Namespace) -> list[str]:
    folder = options.folder or Path()
    own = renew(folder / FILE, options.name)
    if own.name == ROUTER:
        return [f"{own}: renewed; restart the router"]
    return [f"{own}: renewed; copy it to {options.name} and to nobody else, mode 0600; fleet.toml stays as it is"]


def build_parser() -> CommandLineParser:
    """Return the parser of the command line."""
    parser = CommandLineParser(
        prog="mavhelm bridge fleet",
        description="Makes the certificates of a fleet.",
        epilog=HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="new|add|renew")
    new = commands.add_parser("new", help="make a fleet", allow_abbrev=False)
    new.add_argument("fleet", metavar="FLEET", help="its name")
    new.add_argument(
        "--host",
        metavar="HOST",
        action="append",
        required=True,
        help="name or address of the router's machine, as members reach it; may be given again",
    )
    new.add_argument("--port", metavar="PORT", type=int, default=PORT, help=f"of the router (default {PORT})")
    new.add_argument("--folder", metavar="DIR", type=Path, help="where to make it (default: the name of the fleet)")
    again = commands.add_parser("renew", help="give a member, or `router`, a new certificate", allow_abbrev=False)
    again.add_argument("name", metavar="NAME")
    again.add_argument("--folder", metavar="DIR", type=Path, help=f"where {FILE} is (default: here)")
    kinds = commands.add_parser("add", help="add a member", allow_abbrev=False).add_subparsers(
        dest="kind", required=True, metavar="vehicle|operator"
    )
    for kind in ("vehicle", "operator"):
        add = kinds.add_parser(kind, help=f"add a {kind}", allow_abbrev=False)
        add.add_argument("name", metavar="NAME")
        add.add_argument("--folder", metavar="DIR", type=Path, help=f"where {FILE} is (default: here)")
        if kind == "operator":
            add.add_argument("--role", choices=tuple(ROLES), required=True, help="what the operator may do")
    return parser
