"""`mavhelm command`, `request` and `rate`: any MAV_CMD, one message, and how often a message comes."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from dialects import messages as m
from dialects import rover
from dialects.command_places import to_command_int
from dialects.enums import Command
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.nearest import describe_nearest
from groundstation.verbs.common.output import Output
from groundstation.verbs.messages.message_values import find_message
from groundstation.verbs.messages.messages import print_message
from groundstation.verbs.session.rates import request_interval
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
from link.core import Received
from link.services.command.client import CommandPlace

PREFIX = "MAV_CMD_"
LARGEST = 65535
STEERS = frozenset(
    (
        rover.MAV_CMD_CONDITION_YAW,
        rover.MAV_CMD_DO_SET_SERVO,
        rover.MAV_CMD_DO_REPEAT_SERVO,
        rover.MAV_CMD_DO_SET_ACTUATOR,
        rover.MAV_CMD_DO_REPOSITION,
        rover.MAV_CMD_DO_MOTOR_TEST,
        rover.MAV_CMD_NAV_SET_YAW_SPEED,
        rover.MAV_CMD_ACTUATOR_TEST,
        43002,  # MAV_CMD_GUIDED_CHANGE_HEADING of ArduPilot's dialect
    )
)
"""Commands that steer a vehicle or turn its motors, and so are sent to one vehicle at a time."""
ARRIVES_WITHIN = 2.0
"""s for a message after its requests were accepted."""
TRIES = 3
"""Requests of one message: what follows the acknowledgement may get lost."""
STOP = -1
"""Interval of SET_MESSAGE_INTERVAL: send no more."""


def check_command(options: argparse.Namespace) -> None:
    """Find the command by its name or number. Raises VerbError."""
    options.number = find_command(options.name)
    if options.number in STEERS and (options.all or options.group):
        raise VerbError(ExitCode.USAGE, f"{options.name.upper()} steers, which is for one vehicle at a time: --vehicle")
    if len(options.params) > 7:
        raise VerbError(ExitCode.USAGE, f"{len(options.params)} parameters, but a command has 7")
    options.place = find_place(options.number, options.params) if options.int else None


def find_place(command: int, params: Sequence[float]) -> CommandPlace:
    """Return the position of a COMMAND_INT from parameters 5 and 6 of a command. Raises VerbError."""
    message = to_command_int(m.CommandLong(0, 0, command, 0, *params, *(0.0,) * (7 - len(params))))
    if message is None:
        raise VerbError(ExitCode.USAGE, "parameters 5 and 6 are too large for the integers of a COMMAND_INT")
    return CommandPlace(message.frame, message.x, message.y)


def find_command(text: str) -> int:
    """Return the number of a command. Raises VerbError."""
    if text.isascii() and text.isdecimal() and int(text) <= LARGEST:
        return int(text)
    names = {entry.name.removeprefix(PREFIX): number for number, entry in rover.enums["MAV_CMD"].items()}
    names |= {command.name: int(command) for command in Command}
    name = text.upper().removeprefix(PREFIX)
    if name not in names:
        raise VerbError(ExitCode.USAGE, f"there is no command {text!r}{describe_nearest(name, names)}")
    return names[name]


async def command(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Send a command; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    commands, params, what = session.services.commands, tuple(options.params), options.name.upper()
    report = await session.request(
        lambda number, now: commands.send(number, options.number, params, what, now, options.place)
    )
    return finish(session, report, output, f"has accepted {what}", command=options.number)


def check_message(options: argparse.Namespace) -> None:
    """Find the message. Raises VerbError."""
    options.kind = find_message(options.name)


async def request(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Request one message and print it."""
    heard: list[m.Message] = []

    def tap(received: Received, now: float) -> None:
        if type(received.message) is options.kind and received.system == session.vehicle.system:
            heard.append(received.message)

    session.core.taps.append(tap)
    commands, name = session.services.commands, options.kind.msgname
    params = (float(options.kind.id), *options.params)
    for _ in range(TRIES):
        report = await session.request(
            lambda number, now: commands.send(number, Command.REQUEST_MESSAGE, params, f"request {name}", now)
        )
        if report.state is not RequestState.ACCEPTED:
            return finish(session, report, output)
        if await session.wait_for(lambda: bool(heard), ARRIVES_WITHIN / TRIES):
            break
    else:
        raise VerbError(ExitCode.NO_ANSWER, f"{session.vehicle.name}: {name} was accepted, but has not come")
    print_message(heard[-1], output)
    return ExitCode.DONE


async def rate(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set how often a message comes on this link, and read back what the vehicle made of it."""
    name, kind = options.kind.msgname, options.kind
    report = await request_interval(session, kind, STOP if options.rate == 0 else round(1e6 / options.rate))
    if report.state is not RequestState.ACCEPTED:
        return finish(session, report, output)
    set_to = await _read_interval(session, kind.id)
    hz = None if set_to is None else 0.0 if set_to <= 0 else 1e6 / set_to
    done = f"sends {name} at {options.rate if hz is None else hz:g} Hz on this link"
    return finish(session, report, output, done, name=name, interval_us=set_to, rate=hz)


async def _read_interval(session: VerbSession, message: int) -> int | None:
    """Return the interval that the vehicle reports, us; None if it reports none."""
    heard: list[int] = []

    def tap(received: Received, now: float) -> None:
        answer = received.message
        if isinstance(answer, m.MessageInterval) and answer.message_id == message:
            heard.append(answer.interval_us)

    session.core.taps.append(tap)
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(number, Command.GET_MESSAGE_INTERVAL, (float(message),), "interval", now)
    )
    if report.state is RequestState.ACCEPTED:
        await session.wait_for(lambda: bool(heard), 1.0)
    return heard[-1] if heard else None
