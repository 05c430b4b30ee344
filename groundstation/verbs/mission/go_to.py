"""`mavhelm goto`, `home` and `speed`: the vehicle drives by itself, and goes on when the verb has ended."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Autopilot, Command, MissionType, command_name
from dialects.mode_tables import HOLD
from dialects.modes import Mode
from groundstation.geo import LocalFrame, Place, find_separation, is_on_earth
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.arguments import finite
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.mission.plan import count_text, download, has_place
from groundstation.verbs.session.reports import finish, need_driven, wait_for_report
from groundstation.verbs.session.session import VerbSession
from link.services.command.client import CommandPlace

RELATIVE_FRAME = 6
"""MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: the altitude of 0 is that of home, and a rover ignores it."""
KEEP_SPEED, CHANGE_MODE = -1.0, 1.0
"""Parameters 1 and 2 of DO_REPOSITION."""
GROUND_SPEED, KEEP_THROTTLE = 1.0, -1.0
"""Parameters 1 and 3 of DO_CHANGE_SPEED."""
FARTHEST = 100_000.0
"""m; beyond that a plane is not a picture of the earth."""
RETURNING = (Mode.RTL.name, Mode.SMART_RTL.name, "AUTO_RTL")
"""Modes that drive home, of ArduRover, our vehicle and PX4."""
POSITION_TRIES = 3
"""Requests for the position: what follows the acknowledgement may get lost."""
AT_HOME = 3.0
"""m from home, about the error of a GPS."""
POSITION_WITHIN = 2.0
"""s for the position of the vehicle."""


WAYPOINT = "wp"
"""In the place of the latitude: an item of the mission follows."""
LAST_ITEM = 65535
"""Items have 16 bits."""


def latitude(text: str) -> float | str:
    """Parse a latitude, or WAYPOINT. Raises ArgumentTypeError."""
    return WAYPOINT if text == WAYPOINT else finite(text)


def check_place(options: argparse.Namespace) -> None:
    """Check where to go. Raises VerbError."""
    given = [options.latitude, options.longitude]
    if options.latitude == WAYPOINT:
        _check_item(options)
        return
    if options.by is not None and given != [None, None]:
        raise VerbError(ExitCode.USAGE, "LAT LON or --by, not both")
    if options.by is None and None in given:
        raise VerbError(ExitCode.USAGE, "write LAT LON in degrees, or --by NORTH EAST in metres")
    if options.by is not None:
        if max(map(abs, options.by)) > FARTHEST:
            raise VerbError(ExitCode.USAGE, f"--by: {FARTHEST:g} m at most")
        return
    if not is_on_earth(options.latitude, options.longitude) or given == [0.0, 0.0]:
        raise VerbError(ExitCode.USAGE, f"{options.latitude:g} {options.longitude:g} is not a latitude and longitude")


def _check_item(options: argparse.Namespace) -> None:
    number = options.longitude
    if options.by is not None or number is None:
        raise VerbError(ExitCode.USAGE, "write the number of an item as `mission show` has it: goto wp 7")
    if not (0 <= number <= LAST_ITEM and number == int(number)):
        raise VerbError(ExitCode.USAGE, f"{number:g} is not a mission item number")


async def go_to(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive to a place; done when the heartbeat reports a mode that drives by itself."""
    await session.need_only_vehicle(options.vehicle)
    _need_armed(session)
    place = await _find_place(session, options)
    params = (KEEP_SPEED, CHANGE_MODE, 0.0, math.nan, 0.0, 0.0, 0.0)
    where = CommandPlace(RELATIVE_FRAME, round(place.latitude * 1e7), round(place.longitude * 1e7))
    commands, what = session.services.commands, "goto"
    report = await session.request(
        lambda number, now: commands.send(number, Command.DO_REPOSITION, params, what, now, where)
    )
    done = f"drives to {place.latitude:.7f} {place.longitude:.7f}"
    return await _finish(session, report, output, done, lambda: session.vehicle.may_move)


async def home(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive home; done when the heartbeat reports RTL, or HOLD at home: a rover that is there need not drive."""
    await session.need_only_vehicle(options.vehicle)
    _need_armed(session)
    details, commands = session.contact.details, session.services.commands
    await _ask_for(session, m.HomePosition, lambda: details.home is not None, tries=1)
    await _ask_for(session, m.GlobalPositionInt, lambda: details.place is not None, tries=1)
    report = await session.request(
        lambda number, now: commands.send(number, Command.NAV_RETURN_TO_LAUNCH, (), "home", now)
    )
    return await _finish(session, report, output, "drives home", lambda: _returns(session) or _holds_at_home(session))


SPEED_MODES = "ArduPilot takes a speed in AUTO, RTL and SMART_RTL, and in GUIDED on the way to a place (`goto`)"


async def speed(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set the speed of modes that drive by themselves; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    need_driven(session.vehicle)
    commands, params = session.services.commands, (GROUND_SPEED, options.speed, KEEP_THROTTLE)
    report = await session.request(
        lambda number, now: commands.send(number, Command.DO_CHANGE_SPEED, params, "speed", now)
    )
    if report.state is RequestState.REFUSED and session.vehicle.autopilot == Autopilot.ARDUPILOT:
        output.note(f"{session.vehicle.name} is in {session.vehicle.mode}: {SPEED_MODES}")
    return finish(
        session, report, output, f"goes at {options.speed:g} m/s when it drives by itself", speed=options.speed
    )


async def _finish(
    session: VerbSession, report: RequestReport, output: Output, done: str, confirmed: Callable[[], bool]
) -> int:
    state = session.vehicle
    if report.state is RequestState.ACCEPTED and not await wait_for_report(session, confirmed):
        words = f"accepted, but its heartbeat reports {state.mode}, {'armed' if state.armed else 'disarmed'}"
        output.error(f"{state.name}: {report.what}: {words}")
        output.result(False, state.system, mode=state.mode, detail=words)
        return ExitCode.REFUSED
    code = finish(session, report, output, done, mode=state.mode)
    if code is ExitCode.DONE:
        output.note(f"{state.name} drives by itself{session.afterwards}; `mavhelm stop` stops it")
    return code


def _need_armed(session: VerbSession) -> None:
    need_driven(session.vehicle)
    if not session.vehicle.armed:
        raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} is disarmed; `mavhelm arm` arms it")


def _returns(session: VerbSession) -> bool:
    return session.vehicle.mode in RETURNING


def _holds_at_home(session: VerbSession) -> bool:
    """Return whether it stands at home: it has arrived between two heartbeats, or was there already."""
    way = find_separation(session.contact.details.place, session.contact.details.home)
    return way is not None and way.distance <= AT_HOME and session.vehicle.mode == HOLD


async def _find_place(session: VerbSession, options: argparse.Namespace) -> Place:
    """Return where to go. Raises VerbError."""
    if options.latitude == WAYPOINT:
        return await _place_of(session, int(options.longitude))
    return Place(options.latitude, options.longitude) if options.by is None else await _place_at(session, options.by)


async def _place_of(session: VerbSession, number: int) -> Place:
    """Return the place of an item of the vehicle's mission. Raises VerbError if there is none."""
    items, name = await download(session, MissionType.MISSION), session.vehicle.name
    if number >= len(items):
        raise VerbError(
            ExitCode.DIFFERS, f"{name}: there is no item {number}, its mission has {count_text(len(items))}"
        )
    item = items[number]
    if not has_place(item):
        raise VerbError(ExitCode.DIFFERS, f"{name}: item {number} has no place: {command_name(item.command)}")
    return Place(item.latitude, item.longitude)


async def _place_at(session: VerbSession, by: tuple[float, float]) -> Place:
    """Return the place so many m north and east of the vehicle. Raises VerbError if its position is not known."""
    details = session.contact.details
    await _ask_for(session, m.GlobalPositionInt, lambda: details.place is not None, tries=POSITION_TRIES)
    place = details.place
    if place is None:
        raise VerbError(ExitCode.DIFFERS, f"{session.vehicle.name} has no position; give LAT LON")
    goal = LocalFrame(place).to_place(by)
    if not is_on_earth(*goal):
        raise VerbError(ExitCode.USAGE, "--by leads beyond the pole")
    return goal


async def _ask_for(session: VerbSession, kind: type[m.Message], known: Callable[[], bool], tries: int) -> None:
    """Request a message of the vehicle unless what it reports is known already."""
    for _ in range(tries):
        if known():
            return
        await session.request_message(kind, POSITION_WITHIN, known)
