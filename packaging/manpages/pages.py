"""All pages: one for each program, one for each verb of `mavhelm` and each subcommand of `vehicle`."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module

from groundstation.cli import options as station_options
from groundstation.cli.verb_help import LOCAL_VERBS, PROGRAMS
from groundstation.verbs.main import build_parser as build_verb_parser
from groundstation.verbs.table import VERBS
from link.bridge.__main__ import build_parser as build_bridge_parser
from manpages.roff import Page
from vehicle.cli import options as vehicle_options
from vehicle.cli.subcommands import SUBCOMMANDS
from vehicle.cli.subcommands import build_parser as build_subcommand_parser

STATION, VEHICLE, BRIDGE = "mavhelm", "vehicle", "mavhelm-bridge"
SHORT_NAMES = {"groundstation": STATION}
"""Program -> the program whose page it shows."""
BUILDERS = {"replay": "build_replay_parser"}
"""Verb without a vehicle -> the function of its module that returns its parser, where it is not build_parser."""


def build_pages() -> Iterator[Page]:
    """Yield every page."""
    parser, _ = station_options.build_parser()
    parser.epilog = station_options.build_epilog()
    verbs = [f"{STATION}-{verb}" for verb in (*VERBS, *LOCAL_VERBS)]
    yield Page(STATION, "drive a MAVLink vehicle from a terminal", parser, (), [VEHICLE, BRIDGE, *verbs])
    for verb, row in VERBS.items():
        examples = [(each.command, each.note) for each in row.examples]
        yield Page(f"{STATION}-{verb}", row.help, build_verb_parser(verb), examples, [STATION])
    for verb, row in LOCAL_VERBS.items():
        build_parser = getattr(import_module(f"groundstation.cli.local.{verb}"), BUILDERS.get(verb, "build_parser"))
        yield Page(f"{STATION}-{verb}", row.help, build_parser(), (), [STATION])
    yield Page(BRIDGE, PROGRAMS["bridge"].help, build_bridge_parser(), (), [STATION])
    names = [f"{VEHICLE}-{name}" for name in SUBCOMMANDS]
    yield Page(VEHICLE, "control the motors of a rover over MAVLink", vehicle_options.build_parser(), (), names)
    for name, subcommand in SUBCOMMANDS.items():
        yield Page(f"{VEHICLE}-{name}", subcommand.help, build_subcommand_parser(name), (), [VEHICLE])
