"""Who may send a command, and what the denial says."""

from __future__ import annotations

import math

import pytest

from dialects.enums import Command, Result
from link.core import Peer
from link.services.command.request import CommandRequest
from tests.vehicle.conversations import conversation
from vehicle.commands.access import Access, CommandAccess, is_invalid_position, parse_altitude, parse_position
from vehicle.drive.control import Control
from vehicle.navigation.geo import Home
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue

DRIVER, OTHER = 255, 254
HOME = Home(48.1, 11.5, 500.0, 0.0, 0.0)


def request(
    system: int = DRIVER,
    *,
    introduced: bool = True,
    may_ask: bool = True,
    command: int = Command.DO_SET_HOME,
    position: tuple[float, float, float] = (48.1, 11.5, 10.0),
    frame: int | None = None,
) -> CommandRequest:
    return CommandRequest(
        command=command,
        params=(0.0, 0.0, 0.0, 0.0, *position),
        frame=frame,
        x=0,
        y=0,
        is_int=frame is not None,
        system=system,
        component=190,
        peer=Peer(0, "gcs"),
        introduced=introduced,
        may_ask=may_ask,
    )


class Denials:
    """Access control with DRIVER in control; `texts` are its reports."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        texts = StatusTextQueue(lambda severity, text: self.texts.append(text))
        control = Control(Params(), texts, system=1, boot=0.0)
        control.take(conversation(DRIVER), 0.0)
        self.access = CommandAccess(control.ownership, texts)
        self.texts.clear()


@pytest.mark.parametrize(
    ("access", "sender", "result"),
    [
        (Access.CONNECTED, request(introduced=False), None),
        (Access.CONNECTED, request(introduced=False, may_ask=False), Result.TEMPORARILY_REJECTED),
        (Access.INTRODUCED, request(OTHER), None),
        (Access.INTRODUCED, request(introduced=False), Result.FAILED),
        (Access.DRIVER_OR_UNCLAIMED, request(), None),
        (Access.DRIVER_OR_UNCLAIMED, request(OTHER), Result.FAILED),
        (Access.DRIVER_OR_UNCLAIMED, request(introduced=False), Result.FAILED),
    ],
)
def test_access_levels(access: Access, sender: CommandRequest, result: Result | None) -> None:
    assert Denials().access.deny(access, sender, 1.0) is result


def test_a_denial_names_the_command_or_its_number() -> None:
    denials = Denials()
    denials.access.deny(Access.DRIVER_OR_UNCLAIMED, request(OTHER), 1.0)
    denials.access.deny(Access.DRIVER_OR_UNCLAIMED, request(OTHER, command=Command.DO_SET_GLOBAL_ORIGIN), 1.0)
    denials.access.deny(Access.DRIVER_OR_UNCLAIMED, request(OTHER, command=65000), 1.0)
    assert denials.texts == [
        "GCS 254: DO_SET_HOME refused: GCS 255 is in control",
        "GCS 254: DO_SET_GLOBAL_ORIGIN refused: GCS 255 is in control",
        "GCS 254: command 65000 refused: GCS 255 is in control",
    ]


def test_a_position_of_command_long_is_in_degrees() -> None:
    assert parse_position(request()) == pytest.approx((481000000.0, 115000000.0))
    assert parse_position(request(position=(91.0, 0.0, 0.0))) is Result.DENIED
    assert parse_position(request(frame=1)) is Result.UNSUPPORTED_FRAME


def test_an_altitude_counts_from_home_in_relative_frames() -> None:
    assert parse_altitude(request(), HOME) == 10.0
    assert parse_altitude(request(frame=6), HOME) == 510.0
    assert parse_altitude(request(frame=6), None) == 10.0
    assert parse_altitude(request(position=(1.0, 1.0, math.nan)), HOME) is None


@pytest.mark.parametrize("place", [(0, 0), (2**31 - 1, 2**31 - 1), (math.nan, 0), (91e7, 0), (0, 181e7)])
def test_invalid_positions(place: tuple[float, float]) -> None:
    assert is_invalid_position(*place)
