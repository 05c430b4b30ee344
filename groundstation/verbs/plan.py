"""`groundstation mission`, `fence` and `rally`: show, get, put and clear a plan of a vehicle."""

from __future__ import annotations

import argparse
import math
from collections.abc import Awaitable, Callable, Sequence
from pathlib import PurePath
from typing import Any

from dialects.enums import MissionType, command_name
from groundstation.formats.plan import for_vehicle, from_vehicle
from groundstation.formats.plan_file import format_plan, parse_plan
from groundstation.formats.waypoint_file import format_waypoints, parse_waypoints
from groundstation.vehicles.requests import RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.local_file import check_new_file, read_text, write_text
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession
from link.services.mission.items import GLOBAL_FRAMES, UNSET_COORDINATE, Items, MissionItem
from link.services.param.float32 import shortest_float32

Run = Callable[[VerbSession, argparse.Namespace, Output], Awaitable[int]]

WAYPOINT_SUFFIXES = (".waypoints", ".txt", ".wpl")
"""Of QGC WPL 110; anything else is a .plan."""


def show(kind: MissionType) -> Run:
    """Return the action that prints a plan."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        items = await _download(session, kind)
        current = session.services.plans.current if kind is MissionType.MISSION else None
        for number, item in enumerate(items):
            mark = ">" if number == current else " "
            output.line(f"{mark}{number:>4}  {_describe(item)}")
            output.record(**_fields(number, item), current=number == current)
        if not items:
            output.note(f"{session.vehicle.name} has no {_name(kind)}")
        return ExitCode.DONE

    return run


def get(kind: MissionType) -> Run:
    """Return the action that downloads a plan into a file."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        check_new_file(options.file, overwrite=options.yes)
        if _is_waypoints(options.file) and kind is not MissionType.MISSION:
            raise VerbError(ExitCode.USAGE, f"{options.file}: only a .plan can hold a {_name(kind)}")
        items = await _download(session, kind)
        plan = from_vehicle(items, kind, session.vehicle.autopilot)
        write_text(options.file, (format_waypoints if _is_waypoints(options.file) else format_plan)(plan))
        count = len(plan.of(kind))
        output.note(f"{_count(count)} of {session.vehicle.name} saved to {options.file}")
        output.result(True, session.vehicle.system, file=options.file, items=count)
        return ExitCode.DONE

    return run


def put(kind: MissionType) -> Run:
    """Return the action that uploads the plan of a file."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        text = read_text(options.file)
        parse = parse_waypoints if _is_waypoints(options.file) else parse_plan
        plan = parse(text, options.file)
        if not plan.of(kind):
            raise VerbError(ExitCode.DIFFERS, f"{options.file}: no {_name(kind)} in it; `clear` removes the vehicle's")
        await session.need_only_vehicle(options.vehicle)
        items = for_vehicle(plan, kind, session.vehicle.autopilot)
        return await _change(
            session, output, lambda number, now: session.services.plans.upload(number, kind, items, now),
            f"{_count(len(plan.of(kind)))} uploaded",
        )  # fmt: skip

    return run


def clear(kind: MissionType) -> Run:
    """Return the action that clears a plan."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        await session.need_only_vehicle(options.vehicle)
        services, done = session.services, f"{_name(kind)} cleared"
        return await _change(session, output, lambda number, now: services.plans.clear(number, kind, now), done)

    return run


async def _download(session: VerbSession, kind: MissionType) -> Items:
    """Return the plan of the vehicle. Raises VerbError."""
    report = await session.request(lambda number, now: session.services.plans.download(number, kind, now))
    if report.state is not RequestState.ACCEPTED:
        raise VerbError(code_of(report), f"{session.vehicle.name}: {report.text}")
    return session.services.plans.plans[kind]


async def _change(session: VerbSession, output: Output, start: Callable[[int, float], None], done: str) -> int:
    report = await session.request(start)
    name, system = session.vehicle.name, session.vehicle.system
    if report.state is RequestState.ACCEPTED:
        output.note(f"{name}: {done}")
        output.result(True, system)
    else:
        output.error(f"{name}: {report.text}")
        output.result(False, system, detail=report.detail, text=report.reason)
    return code_of(report)


def _is_waypoints(path: str) -> bool:
    return PurePath(path).suffix.lower() in WAYPOINT_SUFFIXES


def _describe(item: MissionItem) -> str:
    """Return an item as a line: command, position, altitude, parameters that are not 0."""
    params = " ".join(f"{at}={_short(value)}" for at, value in enumerate(item.params, 1) if value != 0)
    return f"{command_name(item.command):<28} {_place(item):<38} {params}".rstrip()


def _place(item: MissionItem) -> str:
    if item.frame not in GLOBAL_FRAMES or UNSET_COORDINATE in (item.x, item.y) or (item.x, item.y) == (0, 0):
        return ""
    return f"{item.latitude:.7f} {item.longitude:.7f} {_short(item.z)} m"


def _fields(number: int, item: MissionItem) -> dict[str, Any]:
    """Return an item with the field names of MISSION_ITEM_INT."""
    one, two, three, four = map(shortest_float32, item.params)
    return {
        "seq": number, "command": item.command, "name": command_name(item.command), "frame": item.frame,
        "param1": one, "param2": two, "param3": three, "param4": four, "x": item.x, "y": item.y,
        "z": shortest_float32(item.z), "autocontinue": item.autocontinue,
    }  # fmt: skip


def _short(value: float) -> str:
    return "--" if math.isnan(value) else f"{shortest_float32(value):.9g}"


def _name(kind: MissionType) -> str:
    return {MissionType.FENCE: "fence", MissionType.RALLY: "rally points"}.get(kind, "mission")


def _count(number: int) -> str:
    return "1 item" if number == 1 else f"{number} items"


KINDS: Sequence[tuple[str, MissionType]] = (
    ("mission", MissionType.MISSION),
    ("fence", MissionType.FENCE),
    ("rally", MissionType.RALLY),
)
"""Verb -> the plan that it is about."""
