"""`groundstation goto`, `home` and `speed`: the vehicle drives by itself, and goes on when the verb has ended."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Autopilot, Command
from dialects.modes import Mode
from groundstation.station.arming import CONFIRM_WITHIN
from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.vehicles.track import METRES_PER_DEGREE
from groundstation.vehicles.vehicle_details import MAX_LATITUDE, MAX_LONGITUDE, Place
from groundstation.verbs.exit_codes import ExitCode, VerbError
from groundstation.verbs.output import Output
from groundstation.verbs.reports import finish
from groundstation.verbs.session import VerbSession
from link.services.command.client import CommandPlace

RELATIVE_FRAME = 6
"""MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: the altitude of 0 is that of home, and a rover ignores it."""
KEEP_SPEED, CHANGE_MODE = -1.0, 1.0
"""Parameters 1 and 2 of DO_REPOSITION."""
GROUND_SPEED, KEEP_THROTTLE = 1.0, -1.0
"""Parameters 1 and 3 of DO_CHANGE_SPEED."""
FARTHEST = 100_000.0
"""m; beyond that a plane is no picture of the earth."""
PX4_RETURN = 4 << 16 | 5 << 24
"""custom_mode of PX4's AUTO_RTL."""
POSITION_WITHIN = 2.0
"""s for the position of the vehicle."""


def check_place(options: argparse.Namespace) -> None:
    """Check where to go. Raises VerbError."""
    given = [options.latitude, options.longitude]
    if options.by is not None and given != [None, None]:
        raise VerbError(ExitCode.USAGE, "LAT LON or --by, not both")
    if options.by is None and None in given:
        raise VerbError(ExitCode.USAGE, "write LAT LON in degrees, or --by NORTH EAST in metres")
    if options.by is not None:
        if max(map(abs, options.by)) > FARTHEST:
            raise VerbError(ExitCode.USAGE, f"--by: {FARTHEST:g} m at most")
        return
    if abs(options.latitude) > MAX_LATITUDE or abs(options.longitude) > MAX_LONGITUDE or given == [0.0, 0.0]:
        raise VerbError(ExitCode.USAGE, f"{options.latitude:g} {options.longitude:g} is no latitude and longitude")


async def go_to(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive to a place; done when the heartbeat reports a mode that drives by itself."""
    await session.need_only_vehicle(options.vehicle)
    _need_armed(session)
    place = Place(options.latitude, options.longitude) if options.by is None else await _place_at(session, options.by)
    params = (KEEP_SPEED, CHANGE_MODE, 0.0, math.nan, 0.0, 0.0, 0.0)
    where = CommandPlace(RELATIVE_FRAME, round(place.latitude * 1e7), round(place.longitude * 1e7))
    commands, what = session.services.commands, "goto"
    report = await session.request(
        lambda number, now: commands.send(number, Command.DO_REPOSITION, params, what, now, where)
    )
    done = f"drives to {place.latitude:.7f} {place.longitude:.7f}"
    return await _finish(session, report, output, done, lambda: session.vehicle.drives_itself)


async def home(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive home; done when the heartbeat reports RTL."""
    await session.need_only_vehicle(options.vehicle)
    _need_armed(session)
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(number, Command.NAV_RETURN_TO_LAUNCH, (), "home", now)
    )
    return await _finish(session, report, output, "drives home", lambda: _returns(session))


async def speed(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set the speed of modes that drive by themselves; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    commands, params = session.services.commands, (GROUND_SPEED, options.speed, KEEP_THROTTLE)
    report = await session.request(
        lambda number, now: commands.send(number, Command.DO_CHANGE_SPEED, params, "speed", now)
    )
    return finish(session, report, output, f"drives by itself at {options.speed:g} m/s", speed=options.speed)


async def _finish(
    session: VerbSession, report: RequestReport, output: Output, done: str, confirmed: Callable[[], bool]
) -> int:
    state = session.vehicle
    if report.state is RequestState.ACCEPTED and not await session.wait_for(confirmed, CONFIRM_WITHIN):
        words = f"accepted, but its heartbeat reports {state.mode}, {'armed' if state.armed else 'disarmed'}"
        output.error(f"{state.name}: {report.what}: {words}")
        output.result(False, state.system, mode=state.mode, detail=words)
        return ExitCode.REFUSED
    code = finish(session, report, output, done, mode=state.mode)
    if code is ExitCode.DONE:
        output.note(f"{state.name} drives by itself; this program no longer sends heartbeats, and `stop` stops it")
    return code


def _need_armed(session: VerbSession) -> None:
    if not session.vehicle.armed:
        raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} is disarmed; `groundstation arm` arms it")


def _returns(session: VerbSession) -> bool:
    if session.vehicle.autopilot == Autopilot.PX4:
        return session.services.modes.current == PX4_RETURN
    return session.vehicle.mode in (Mode.RTL.name, Mode.SMART_RTL.name)


async def _place_at(session: VerbSession, by: tuple[float, float]) -> Place:
    """Return the place so many m north and east of the vehicle. Raises VerbError if its position is not known."""
    details, commands = session.contact.details, session.services.commands
    if details.place is None:
        params = (float(m.GlobalPositionInt.id),)
        await session.request(
            lambda number, now: commands.send(number, Command.REQUEST_MESSAGE, params, "position", now)
        )
        await session.wait_for(lambda: details.place is not None, POSITION_WITHIN)
    place = details.place
    if place is None:
        raise VerbError(ExitCode.DIFFERS, f"{session.vehicle.name} has no position; give LAT LON")
    latitude = place.latitude + by[0] / METRES_PER_DEGREE
    longitude = place.longitude + by[1] / (METRES_PER_DEGREE * math.cos(math.radians(place.latitude)))
    if abs(latitude) > MAX_LATITUDE:
        raise VerbError(ExitCode.USAGE, "--by leads beyond the pole")
    return Place(latitude, (longitude + 180.0) % 360.0 - 180.0)
