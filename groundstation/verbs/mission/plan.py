"""`mavhelm mission`, `fence` and `rally`: show, get, put and clear a plan of a vehicle."""

from __future__ import annotations

import argparse
import math
from collections.abc import Awaitable, Callable
from typing import Any

from dialects.enums import MissionType, command_name
from groundstation.formats.plan import Plan, for_vehicle, from_vehicle
from groundstation.formats.plan_of_name import format_named, lost_in_named, parse_named
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.common.files import Files
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
from link.services.mission.items import GLOBAL_FRAMES, UNSET_COORDINATE, Items, MissionItem
from link.services.param.float32 import shortest_float32

Run = Callable[[VerbSession, argparse.Namespace, Output], Awaitable[int]]


def show(kind: MissionType) -> Run:
    """Return the action that prints a plan."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        items = await download(session, kind)
        current = session.services.progress.current if kind is MissionType.MISSION else None
        for number, item in enumerate(items):
            mark = ">" if number == current else " "
            output.line(f"{mark}{number:>4}  {describe_item(item)}")
            output.record(**_fields(number, item), current=number == current)
        if not items:
            output.note(f"{session.vehicle.name} has no {plan_name(kind)}")
        return ExitCode.DONE

    return run


def get(kind: MissionType) -> Run:
    """Return the action that downloads a plan into a file."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        await session.files.check_new(options.file, overwrite=options.yes)
        items = await download(session, kind)
        plan = from_vehicle(items, kind, session.vehicle.autopilot)
        await session.files.write_text(options.file, format_named(plan, options.file))
        count = len(plan.of(kind))
        output.note(f"{count_text(count)} of {session.vehicle.name} saved to {options.file}")
        if lost := lost_in_named(plan, options.file):
            output.note(f"{options.file}: {lost}")
        output.result(True, session.vehicle.system, file=options.file, items=count, lost=lost or None)
        return ExitCode.DONE

    return run


def put(kind: MissionType) -> Run:
    """Return the action that uploads the plan of a file."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        plan = await read_plan(session.files, options.file, kind)
        if others := _other_kinds(plan, kind):
            output.note(f"{options.file} has {others}, too")
        await session.need_only_vehicle(options.vehicle)
        items = for_vehicle(plan, kind, session.vehicle.autopilot)
        return await _change(
            session, output, lambda number, now: session.services.plans.upload(number, kind, items, now),
            f"has taken {count_text(len(plan.of(kind)))}",
        )  # fmt: skip

    return run


async def read_plan(files: Files, path: str, kind: MissionType) -> Plan:
    """Return the plan of a file that has one of this kind. Raises VerbError, FileFormatError."""
    plan = parse_named(await files.read_text(path), path)
    if not plan.of(kind):
        others = _other_kinds(plan, kind)
        hint = f"but {others}" if others else "`clear` removes the vehicle's"
        raise VerbError(ExitCode.DIFFERS, f"{path}: no {plan_name(kind)} in it; {hint}")
    return plan


def _other_kinds(plan: Plan, kind: MissionType) -> str:
    """Return what else a file holds, and the verb for it, e.g. "a fence of 4 items (`fence put`)"."""
    texts = [f"{_A[each]} of {count_text(len(plan.of(each)))} (`{_VERBS[each]} put`)" for each in plan.kinds]
    return " and ".join(text for each, text in zip(plan.kinds, texts, strict=True) if each is not kind)


_A = {MissionType.MISSION: "a mission", MissionType.FENCE: "a fence", MissionType.RALLY: "rally points"}
_VERBS = {MissionType.MISSION: "mission", MissionType.FENCE: "fence", MissionType.RALLY: "rally"}


def clear(kind: MissionType) -> Run:
    """Return the action that clears a plan."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        await session.need_only_vehicle(options.vehicle)
        services, done = session.services, f"has no {plan_name(kind)} now"
        return await _change(session, output, lambda number, now: services.plans.clear(number, kind, now), done)

    return run


async def download(session: VerbSession, kind: MissionType) -> Items:
    """Return the plan of the vehicle. Raises VerbError."""
    report = await session.request(lambda number, now: session.services.plans.download(number, kind, now))
    if report.state is not RequestState.ACCEPTED:
        raise VerbError(code_of(report), f"{session.vehicle.name}: {report.text}")
    return session.services.plans.plans[kind]


async def _change(session: VerbSession, output: Output, start: Callable[[int, float], None], done: str) -> int:
    return finish(session, await session.request(start), output, done)


def describe_item(item: MissionItem) -> str:
    """Return an item as a line: command, position, altitude, parameters that are not 0."""
    params = " ".join(f"{at}={_short(value)}" for at, value in enumerate(item.params, 1) if value != 0)
    return f"{command_name(item.command):<28} {_place(item):<38} {params}".rstrip()


def has_place(item: MissionItem) -> bool:
    """Return whether an item is at a place on earth."""
    return item.frame in GLOBAL_FRAMES and UNSET_COORDINATE not in (item.x, item.y) and (item.x, item.y) != (0, 0)


def _place(item: MissionItem) -> str:
    if not has_place(item):
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


def plan_name(kind: MissionType) -> str:
    """Return what a plan is called."""
    return {MissionType.FENCE: "fence", MissionType.RALLY: "rally points"}.get(kind, "mission")


def count_text(number: int) -> str:
    """Return so many items."""
    return "1 item" if number == 1 else f"{number} items"
