"""How often a message comes on the link of a verb."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.verbs.session.session import VerbSession


async def request_interval(session: VerbSession, kind: type[m.Message], interval: float) -> RequestReport:
    """Request a message each `interval` us; 0: at its default rate, -1: no more.

    A vehicle that refuses sends it as often as before.
    """
    commands, params = session.services.commands, (float(kind.id), float(interval))
    return await session.request(
        lambda number, now: commands.send(number, Command.SET_MESSAGE_INTERVAL, params, f"rate of {kind.msgname}", now)
    )
