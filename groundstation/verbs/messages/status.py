"""`mavhelm status`, `vehicles` and `links`: what was heard. Requests single messages, and changes nothing."""

from __future__ import annotations

import argparse
import asyncio
import math
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime
from typing import Any

from dialects import messages as m
from dialects.enums import Result, SystemState, state_name
from groundstation.snapshot import VehicleView
from groundstation.station.links.link_stats import lost_frames
from groundstation.vehicles.requests.requests import RequestState
from groundstation.vehicles.state.senders import DIFFERS_FOR
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.common.tables import format_table
from groundstation.verbs.messages.status_changes import ChangePrinter
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.session import VerbSession
from link.core import LinkReport

ASKED = (m.SysStatus, m.BatteryStatus, m.GpsRawInt, m.GlobalPositionInt, m.VfrHud, m.AutopilotVersion, m.ControlStatus)
"""Messages that `status` requests where they are not heard: ArduPilot sends nothing that nobody has requested."""
ASKED_ONCE = (m.AutopilotVersion, m.ControlStatus)
"""Those of them that do not change."""
NOT_YET = Result.TEMPORARILY_REJECTED
ARRIVES_WITHIN = 2.0
"""s for a message after its request was accepted. It comes at once unless a frame is lost or a program late."""
ARRIVES_LATER = 0.3
"""s for one of those after COMPLETE_WITHIN: a vehicle may accept requests and send nothing."""
COMPLETE_WITHIN = 1.5
"""s for messages that a vehicle refuses at first or sends once a second: ours answers only who has been heard."""
ASK_PERIOD = 0.1
"""s between two rounds of requests within that time."""
BAD_STATES = (SystemState.CRITICAL, SystemState.EMERGENCY)
PERIOD = 1.0
"""s between two lines of `status --watch`."""
CHANGES_PERIOD = 0.1
"""s between two looks for changes: that of the screen's snapshots."""


async def status(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print the state of the vehicle, once, each second or when it changes."""
    asker = _Asker(session)
    await asker.ask(every=True)
    if options.all or options.group:
        _print_short(session.contact, session.now, output)
        return ExitCode.DONE
    if not options.watch:
        await _compare_senders(session, output)
        _print(session.contact, session.now, output)
        return ExitCode.DONE
    end = math.inf if options.seconds is None else session.now + options.seconds
    if options.changes:
        return await _print_changes(session, asker, end, output)
    while session.now < end:
        _print_short(session.contact, session.now, output)
        await asyncio.sleep(min(PERIOD, max(0.0, end - session.now)))
        await asker.ask(every=False)
    return ExitCode.DONE


def check_status(options: argparse.Namespace) -> None:
    """Raise VerbError for options that mean nothing without --watch, and where it is for many vehicles."""
    if options.watch and (options.all or options.group):
        raise VerbError(ExitCode.USAGE, "status --watch is for one vehicle; the Links screen shows all of them")
    if not options.watch and (options.changes or options.seconds is not None):
        raise VerbError(ExitCode.USAGE, "--changes and --for belong to status --watch")
    if (options.speak or options.bell) and not options.changes:
        raise VerbError(ExitCode.USAGE, "--speak and --bell belong to status --watch --changes")


async def _print_changes(session: VerbSession, asker: _Asker, end: float, output: Output) -> int:
    contact = session.contact
    printer = ChangePrinter(contact, output, lambda now: _steady_state(contact, now), lambda now: _fields(contact, now))
    asked = session.now
    while session.now < end:
        printer.print_changes(session.now)
        await asyncio.sleep(min(CHANGES_PERIOD, max(0.0, end - session.now)))
        if session.now - asked >= PERIOD:
            asked = session.now
            await asker.ask(every=False)
    return ExitCode.DONE


def _steady_state(contact: VehicleContact, now: float) -> dict[str, str]:
    """Return the lines of `status` that change seldom, and the link."""
    view = contact.state.build_view(now)
    lines = {label: text(contact, view) for label, text in _LINES if label in _STEADY}
    return {**lines, "link": "up" if view.alive else "lost"}


async def vehicles(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print all vehicles that are heard."""
    await session.hear_all(max(0.0, options.seconds))
    contacts = [session.core.contacts[system] for system in sorted(session.core.contacts)]
    now = session.now
    rows = [(str(each.state.system), *_cells(each, now)) for each in contacts]
    for line in format_table(("id", "name", "mode", "state", "driver", "battery", "heard"), rows):
        output.line(line)
    for each in contacts:
        output.record(**_fields(each, now))
    return ExitCode.DONE


async def links(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print what arrived on each link, also without any vehicle; then the code is 3."""
    await session.wait_for(lambda: bool(session.core.contacts), options.wait)
    began = session.now
    await asyncio.sleep(options.seconds)
    await session.wait_for(lambda: bool(session.core.reports), PERIOD * 2)
    reports, over = session.core.reports, session.now - began
    for line in format_table(_LINK_TITLES, [_link_cells(report) for report in reports]):
        output.line(line)
    for report in reports:
        output.record(**_link_fields(report))
    if not session.core.contacts:
        raise VerbError(ExitCode.NO_VEHICLE, f"no vehicle within {options.wait + over:g} s")
    for each in session.of_others():
        await _compare_senders(each, output)
    return ExitCode.DONE


async def _compare_senders(session: VerbSession, output: Output) -> None:
    """Say if several vehicles use the id of this one; senders that differ are heard until a late link is none."""
    senders = session.vehicle.senders
    await session.wait_until_true(
        lambda: not senders.differ(session.now) or bool(senders.describe_duplicates(session.now)), DIFFERS_FOR + PERIOD
    )
    if duplicates := senders.describe_duplicates(session.now):
        output.error(f"several vehicles use system id {session.vehicle.system}: {duplicates}")


class _Asker:
    """Requests messages that do not come by themselves, as long as the vehicle answers."""

    def __init__(self, session: VerbSession) -> None:
        self._session = session
        self._refused: set[type[m.Message]] = set()

    async def ask(self, *, every: bool) -> None:
        """Request what was not heard lately; `every`: also what is asked for once only, until COMPLETE_WITHIN."""
        until = self._session.now + COMPLETE_WITHIN
        while await self._ask_round(until, every=every) and every and self._missing() and self._session.now < until:
            await self._session.wait_until_true(lambda: not self._missing(), ASK_PERIOD)

    async def _ask_round(self, until: float, *, every: bool) -> bool:
        """Request each message once, as long as the vehicle takes requests; return whether it answers at all."""
        for kind in ASKED:
            once = kind in ASKED_ONCE
            fresh = self._session.now - self._session.heard_at(kind) < PERIOD
            if fresh or kind in self._refused or (once and not every):
                continue
            within = max(ARRIVES_LATER, min(ARRIVES_WITHIN, until - self._session.now))
            report = await self._session.request_message(kind, within)
            if report.state is RequestState.NO_ANSWER:
                return False
            if report.answer == NOT_YET:
                break
            if report.state is not RequestState.ACCEPTED:
                self._refused.add(kind)
        return True

    def _missing(self) -> bool:
        """Return whether a message that may still come was never heard."""
        return any(kind not in self._refused and self._session.heard_at(kind) == -math.inf for kind in ASKED)


def _print(contact: VehicleContact, now: float, output: Output) -> None:
    fields = _fields(contact, now)
    output.record(**fields)
    view = contact.state.build_view(now)
    lines = [(label, text(contact, view)) for label, text in _LINES]
    for label, words in lines:
        output.line(f"{label:<9} {words}")


def _print_short(contact: VehicleContact, now: float, output: Output) -> None:
    view, clock = contact.state.build_view(now), datetime.now(UTC)
    output.record(time=clock.isoformat(timespec="milliseconds").replace("+00:00", "Z"), **_fields(contact, now))
    cells = (_state(contact), _battery(view), _speed(view), _position(contact), _gps(view), _failsafes(view))
    heard = "" if view.alive else f"  link lost for {view.silence:.0f} s"
    duplicates = contact.state.senders.describe_duplicates(now)
    heard += f"  several vehicles use its id: {duplicates}" if duplicates else ""
    output.line(f"{clock:%H:%M:%SZ} {contact.state.mode:<9} {'  '.join(cells)}{heard}")
    output.flush()


def _state(contact: VehicleContact) -> str:
    if contact.state.emergency_stop:
        return "EMERGENCY STOP"
    return "ARMED" if contact.state.armed else "disarmed"


def _driver(contact: VehicleContact) -> str:
    driver = contact.state.driver
    return "--" if driver is None else f"GCS {driver}" if driver else "nobody"


def _battery(view: VehicleView) -> str:
    volts = "--" if view.battery_voltage is None else f"{view.battery_voltage:.1f} V"
    return volts if view.battery_remaining is None else f"{volts} {100 * view.battery_remaining:.0f} %"


def _speed(view: VehicleView) -> str:
    return "--" if view.speed is None else f"{view.speed:z.1f} m/s"


def _position(contact: VehicleContact) -> str:
    place = contact.details.place
    return "--" if place is None else f"{place.latitude:.7f} {place.longitude:.7f}"


def _gps(view: VehicleView) -> str:
    if view.gps_fix is None:
        return "--"
    satellites = "" if view.gps_satellites is None else f", {view.gps_satellites} satellites"
    return f"{'no fix' if view.gps_fix < 2 else f'{min(view.gps_fix, 3)}D fix'}{satellites}"


def _failsafes(view: VehicleView) -> str:
    found = [*view.failsafes, *([view.breach] if view.breach else [])]
    if not found and view.status in BAD_STATES:
        return f"not named; HEARTBEAT says {state_name(view.status).upper()}"
    return ", ".join(found) or "none"


def _prearm(contact: VehicleContact, view: VehicleView) -> str:
    if view.prearm is None:
        return "--"
    return "ready to arm" if view.prearm else view.prearm_reason or "not ready to arm"


_LINES: Sequence[tuple[str, Callable[[VehicleContact, VehicleView], str]]] = (
    ("vehicle", lambda contact, _: f"{contact.state.name} {contact.details.firmware}".rstrip()),
    ("mode", lambda contact, _: contact.state.mode),
    ("state", lambda contact, _: f"{_state(contact)}, {state_name(contact.state.status)}"),
    ("control", lambda contact, _: _driver(contact)),
    ("pre-arm", _prearm),
    ("failsafe", lambda _, view: _failsafes(view)),
    ("battery", lambda _, view: _battery(view)),
    ("gps", lambda _, view: _gps(view)),
    ("position", lambda contact, _: _position(contact)),
    ("speed", lambda _, view: _speed(view)),
    ("heading", lambda _, view: "--" if view.heading is None else f"{math.degrees(view.heading):.0f} deg"),
)
"""Lines of `status`: label and text."""

_STEADY = ("mode", "state", "control", "pre-arm", "failsafe")
"""Lines that `status --watch --changes` compares."""


def _cells(contact: VehicleContact, now: float) -> tuple[str, ...]:
    view = contact.state.build_view(now)
    return (
        contact.state.name, contact.state.mode, _state(contact), _driver(contact), _battery(view),
        f"{view.silence:.1f} s ago",
    )  # fmt: skip


def _fields(contact: VehicleContact, now: float) -> dict[str, Any]:
    """Return the state with JSON names; units are SI, angles degrees."""
    state, view, place = contact.state, contact.state.build_view(now), contact.details.place
    return {
        "vehicle": state.system, "name": state.name, "firmware": contact.details.firmware or None, "mode": state.mode,
        "armed": state.armed, "emergency_stop": state.emergency_stop, "system_status": state_name(state.status),
        "gcs_main": state.driver, "prearm": view.prearm, "prearm_reason": view.prearm_reason or None,
        "failsafes": list(view.failsafes), "breach": view.breach or None,
        "voltage": view.battery_voltage, "battery_remaining": view.battery_remaining,
        "fix_type": view.gps_fix, "satellites_visible": view.gps_satellites,
        "lat": place.latitude if place else None, "lon": place.longitude if place else None,
        "groundspeed": view.speed, "heading": None if view.heading is None else math.degrees(view.heading),
        "silence": view.silence, "duplicates": contact.state.senders.describe_duplicates(now) or None,
    }  # fmt: skip


_LINK_TITLES = ("link", "peers", "frames in", "bytes in", "bytes out", "lost", "bad", "unknown", "state")


def _link_cells(report: LinkReport) -> tuple[str, ...]:
    lost = lost_frames(report)
    numbers = (report.peers, report.frames, report.bytes_received, report.bytes_sent, lost, report.crc_errors)
    return (report.name, *map(str, numbers), str(report.unknown), _link_state(report))


def _link_state(report: LinkReport) -> str:
    if report.down:
        return report.down
    if report.dialect_mismatch:
        return f"another dialect: {', '.join(report.dialect_mismatch)}"
    if report.frames:
        return f"MAVLink 1: {_systems(report.version_1)}" if report.version_1 else "MAVLink"
    return "bytes, but no MAVLink" if report.bytes_received else "nothing heard"


def _systems(systems: Collection[int]) -> str:
    return f"system{'s' if len(systems) > 1 else ''} {', '.join(map(str, sorted(systems)))}"


def _link_fields(report: LinkReport) -> dict[str, Any]:
    return {
        "link": report.name, "peers": report.peers, "frames": report.frames, "bytes_received": report.bytes_received,
        "bytes_sent": report.bytes_sent, "lost": lost_frames(report),
        "crc_errors": report.crc_errors, "unknown": report.unknown, "down": report.down,
        "version_1": sorted(report.version_1), "dialect_mismatch": list(report.dialect_mismatch),
    }  # fmt: skip
