"""Reads and writes plan files for the Map screen, in a process of its own.

    python -m groundstation.verbs.mission.plan_converter read FILE             PlanDocument to stdout
    python -m groundstation.verbs.mission.plan_converter layer FILE            LayerDocument to stdout
    python -m groundstation.verbs.mission.plan_converter write FILE [replace]  PlanDocument from stdin; what it loses

The screen's process does not load the dialect, and a large or damaged file must not hold up its event loop, which
renews the lease. Errors are one line on stderr, with exit code 2.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import PurePath

import msgspec

from groundstation.formats.errors import FileFormatError
from groundstation.formats.geojson import format_geojson
from groundstation.formats.geojson_layer import parse_layer, thin
from groundstation.formats.layer import LayerDocument
from groundstation.formats.plan import Plan, PlannedHome
from groundstation.formats.plan_of_name import WAYPOINT_SUFFIXES, format_named, lost_in_named, parse_named
from groundstation.geo import Place
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.local_file import check_new_file, read_text, write_text
from groundstation.views.plan import MAX_ITEMS, PlanDocument, PlanItem
from link.services.mission.items import Items, MissionItem

GEOJSON_SUFFIXES = (".geojson", ".json")
MAX_DRAWN = 2000
"""Places of a layer: a map of 200 columns has no more dots to tell them apart."""


def read(path: str) -> bytes:
    """Return the plans of a file, encoded. Raises VerbError and FileFormatError."""
    plan = parse_named(read_text(path), path)
    for name, items in (("mission", plan.mission), ("fence", plan.fence), ("rally points", plan.rally)):
        if len(items) > MAX_ITEMS:
            text = f"{path}: {name} of {len(items)} items, this screen edits {MAX_ITEMS} at most"
            raise VerbError(ExitCode.USAGE, f"{text}: use mavhelm mission put")
    home = None if plan.home is None else Place(plan.home.latitude, plan.home.longitude)
    altitude = plan.home.altitude if plan.home is not None else 0.0
    plans = (_for_screen(plan.mission), _for_screen(plan.fence), _for_screen(plan.rally))
    return msgspec.msgpack.encode(PlanDocument(plans, home, altitude))


def read_layer(path: str) -> bytes:
    """Return the shapes of a GeoJSON file, thinned and encoded. Raises VerbError and FileFormatError."""
    shapes = parse_layer(read_text(path), path)
    total = sum(len(shape.places) for shape in shapes)
    return msgspec.msgpack.encode(LayerDocument(thin(shapes, MAX_DRAWN), total))


def write(path: str, data: bytes, *, replace: bool) -> str:
    """Write plans to a file, whole or not at all; return what it cannot hold. Raises VerbError, FileFormatError."""
    document = msgspec.msgpack.decode(data, type=PlanDocument)
    at = document.home
    home = None if at is None else PlannedHome(at.latitude, at.longitude, document.home_altitude)
    mission, fence, rally = map(_from_screen, document.plans)
    plan = Plan(mission, fence, rally, home)
    suffix = _suffix(path)
    if suffix not in (*WAYPOINT_SUFFIXES, *GEOJSON_SUFFIXES, ".plan"):
        raise VerbError(ExitCode.USAGE, f"{path}: name it .plan, .waypoints or .geojson")
    check_new_file(path, overwrite=replace)
    if suffix in GEOJSON_SUFFIXES:
        write_text(path, format_geojson(plan))
        return ""
    try:
        text = format_named(plan, path)
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    write_text(path, text)
    return lost_in_named(plan, path)


def main(arguments: Sequence[str]) -> int:
    """Do it; return the exit code."""
    action, path, *options = arguments
    try:
        if action in READERS:
            sys.stdout.buffer.write(READERS[action](path))
        else:
            sys.stdout.write(write(path, sys.stdin.buffer.read(), replace="replace" in options))
    except (VerbError, FileFormatError) as error:
        sys.stderr.write(f"{error}\n")
        return ExitCode.USAGE
    return 0


READERS = {"read": read, "layer": read_layer}
"""Action -> what reads a file."""


def _suffix(path: str) -> str:
    return PurePath(path).suffix.lower()


def _for_screen(items: Items) -> tuple[PlanItem, ...]:
    return tuple(PlanItem(each.command, each.frame, each.params, each.x, each.y, each.z, each.autocontinue)
                 for each in items)  # fmt: skip


def _from_screen(items: Sequence[PlanItem]) -> Items:
    return tuple(MissionItem(each.command, each.frame, each.params, each.x, each.y, each.z, each.autocontinue)
                 for each in items)  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
