"""`mavhelm mission start`, `pause`, `jump` and `check`, and `fence on` and `off`."""

from __future__ import annotations

import argparse
from collections.abc import Awaitable, Callable, Iterable
from itertools import zip_longest

from dialects.command_places import PLACELESS
from dialects.enums import Command, MissionType
from groundstation.formats.plan import for_vehicle, keeps_home
from groundstation.plan_key import Key, item_key
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.mission.plan import count_text, describe_item, download, plan_name, read_plan
from groundstation.verbs.session.reports import finish, wait_for_report
from groundstation.verbs.session.session import VerbSession
from link.services.mission.items import MissionItem
from link.services.param.float32 import shortest_float32

Run = Callable[[VerbSession, argparse.Namespace, Output], Awaitable[int]]

LAST_ITEM = 65_534
"""Largest number of an item: the sequence number has 16 bits, and 65535 means that none is current."""


def item_number(text: str) -> int:
    """Parse the number of an item. Raises ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 5 and int(text) <= LAST_ITEM):
        raise argparse.ArgumentTypeError(f"{text!r} is not the number of an item, as `mission show` prints it")
    return int(text)


async def start(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Start the mission, or go on with it; done when the heartbeat reports that the vehicle drives itself."""
    await session.need_only_vehicle(options.vehicle)
    state = session.vehicle
    if not state.armed:
        raise VerbError(ExitCode.REFUSED, f"{state.name} is disarmed; `mavhelm arm` arms it")
    if options.item is not None:
        report = await _set_current(session, options.item)
        if report.state is not RequestState.ACCEPTED:
            return finish(session, report, output)
    missions = session.services.missions
    report = await session.request(missions.start)
    accepted = report.state is RequestState.ACCEPTED
    if accepted and not await wait_for_report(session, lambda: state.drives_itself):
        raise VerbError(ExitCode.REFUSED, f"{state.name}: accepted, but its heartbeat reports {state.mode}")
    code = finish(session, report, output, "drives its mission", mode=state.mode)
    if accepted:
        keeps = "; `mavhelm watch` next keeps it going" if session.afterwards else ""
        output.note(f"{state.name} drives by itself{keeps}; `mavhelm stop` stops it")
    return code


async def pause(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Stop where the vehicle is; `start` goes on. Done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    report = await session.request(session.services.missions.pause)
    return finish(session, report, output, "pauses its mission", mode=session.vehicle.mode)


async def jump(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Make an item the current one; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    report = await _set_current(session, options.item)
    return finish(session, report, output, f"goes on with item {options.item}", item=options.item)


async def _set_current(session: VerbSession, item: int) -> RequestReport:
    """Choose an item by the number that the vehicle reports."""
    commands, what = session.services.commands, f"jump to item {item}"
    return await session.request(
        lambda number, now: commands.send(number, Command.DO_SET_MISSION_CURRENT, (float(item),), what, now)
    )


def check(kind: MissionType) -> Run:
    """Return the action that compares a plan of the vehicle with a file."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        plan = await read_plan(session.files, options.file, kind)
        wanted = for_vehicle(plan, kind, session.vehicle.autopilot)
        there = await download(session, kind)
        first = 1 if kind is MissionType.MISSION and keeps_home(session.vehicle.autopilot) else 0
        differing = _differing(wanted[first:], there[first:], first)
        for number, here, vehicle, fields in differing:
            output.line(f"{number:>4}  here     {here}\n{number:>4}  vehicle  {vehicle}")
            if fields:
                output.line(f"{number:>4}  differs  {', '.join(fields)}")
            output.record(seq=number, here=here, vehicle=vehicle, differs=fields)
        name = session.vehicle.name
        if differing:
            differ = "differs" if len(differing) == 1 else "differ"
            raise VerbError(ExitCode.DIFFERS, f"{name}: {count_text(len(differing))} {differ} from {options.file}")
        output.note(f"{name} has the {plan_name(kind)} of {options.file}, {count_text(len(plan.of(kind)))}")
        output.result(True, session.vehicle.system, items=len(plan.of(kind)))
        return ExitCode.DONE

    return run


def _differing(
    here: Iterable[MissionItem], there: Iterable[MissionItem], first: int
) -> list[tuple[int, str, str, list[str]]]:
    """Return the items that are not equal: number, that of the file, that of the vehicle, what differs."""
    pairs = enumerate(zip_longest(here, there), first)
    return [
        (number, _text(one), _text(two), _compare(one, two)) for number, (one, two) in pairs if _key(one) != _key(two)
    ]


def _text(item: MissionItem | None) -> str:
    return "--" if item is None else describe_item(item)


def _key(item: MissionItem | None) -> Key | None:
    return None if item is None else item_key(item, located=item.command not in PLACELESS)


def _compare(here: MissionItem | None, there: MissionItem | None) -> list[str]:
    """Return the fields that differ with both values, e.g. "param3 0 here, 2 there"; [] where one is missing."""
    one, two = _key(here), _key(there)
    if one is None or two is None:
        return []
    return [
        f"{name} {_number(value)} here, {_number(two[name])} there"
        for name, value in one.items()
        if name in two and two[name] != value
    ]


def _number(value: float | None) -> str:
    return "not set" if value is None else f"{shortest_float32(value):.10g}" if isinstance(value, float) else str(value)


def enable_fence(on: bool) -> Run:
    """Return the action that enables or disables the fence."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        await session.need_only_vehicle(options.vehicle)
        missions = session.services.missions
        report = await session.request(lambda number, now: missions.enable_fence(number, now, on=on))
        return finish(session, report, output, f"has accepted fence {'on' if on else 'off'}", enabled=on)

    return run
