"""OperatorPresence by itself: ages, sessions and the wrap of the echo."""

from __future__ import annotations

import math

import pytest

from dialects.enums import OperatorFlag
from dialects.messages import UINT16_MAX, RoverOperatorPresence
from vehicle.drive.operator_presence import OperatorPresence


def message(*, session: int = 1, echo: int = 0, age: int = 0, flags: int = 0) -> RoverOperatorPresence:
    return RoverOperatorPresence(1, 1, 0, echo, session, 1, age, flags)


def test_a_driver_who_does_not_send_it_is_never_lost() -> None:
    presence = OperatorPresence()
    assert not presence.known
    assert presence.echo_age(1e9) == -math.inf
    assert not presence.is_lost(10.0, 1e9)


def test_the_first_session_is_not_a_new_one() -> None:
    presence = OperatorPresence()
    assert not presence.handle(message(session=1), 0.0, 0.0)
    assert presence.known
    assert not presence.handle(message(session=1), 0.0, 0.0)
    assert presence.handle(message(session=2), 0.0, 0.0)
    assert not presence.handle(message(session=2), 0.0, 0.0)


def test_it_is_lost_when_its_input_is_older_than_the_timeout() -> None:
    presence = OperatorPresence()
    presence.handle(message(age=500), 0.0, 100.0)
    assert not presence.is_lost(10.0, 109.5)
    assert presence.is_lost(10.0, 109.51)


def test_without_any_input_or_device_it_is_lost() -> None:
    presence = OperatorPresence()
    presence.handle(message(age=UINT16_MAX), 0.0, 100.0)
    assert presence.is_lost(60.0, 100.0)
    presence.handle(message(age=UINT16_MAX - 1), 0.0, 100.0)
    assert not presence.is_lost(70.0, 100.0)
    presence.handle(message(flags=OperatorFlag.INPUT_LOST), 0.0, 100.0)
    assert presence.is_lost(60.0, 100.0)
    presence.handle(message(flags=int(~OperatorFlag.INPUT_LOST) & 0xFF), 0.0, 100.0)
    assert not presence.is_lost(60.0, 100.0)


@pytest.mark.parametrize(
    ("echo", "since_boot", "age"),
    [(0, 50.0, -math.inf), (1, 50.0, 49.999), (49_500, 50.0, 0.5), (50_000, 50.0, 0.0),
     (50_001, 50.0, 2**32 / 1000 - 0.001), (2**32 - 500, 2**32 / 1000 + 0.5, 1.0)],
)  # fmt: skip
def test_the_age_of_an_echo(echo: int, since_boot: float, age: float) -> None:
    presence = OperatorPresence()
    presence.handle(message(echo=echo), since_boot, 100.0)
    assert presence.echo_age(100.0) == pytest.approx(age)
    assert presence.echo_age(100.25) == pytest.approx(age + 0.25)
