"""ROVER_OPERATOR_PRESENCE: inactive operators, old demands, sessions and the wrap of the echo."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import OperatorFlag
from dialects.messages import UINT16_MAX, RoverOperatorPresence
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, OTHER, Bench, said
from vehicle.drive.operator_presence import OperatorPresence


def say(bench: Bench, echo: int, age: int = 0, session: int = 1, flags: int = 1) -> None:
    bench.say(m.RoverOperatorPresence(1, 1, 0, echo, session, 1, age, flags))


def drive(bench: Bench, seconds: float, axes: Axes, delay: float = 0.1, age: int = 0) -> None:
    """Send demands at 20 Hz with an echo of `delay` s ago."""
    for _ in range(round(seconds / 0.05)):
        say(bench, int((bench.now - 100.0 - delay) * 1000), age=age)
        bench.stick(axes)
        bench.wait(0.05)


def going() -> Bench:
    bench = Bench()
    bench.wait(2.0)
    bench.arm()
    drive(bench, 0.2, NEUTRAL)
    drive(bench, 1.0, AHEAD)
    assert bench.turning
    return bench


def test_demands_that_are_old_on_arrival_are_rejected() -> None:
    bench = going()
    drive(bench, 1.2, AHEAD, delay=0.6)
    assert not bench.turning
    assert said(bench, "older than OPR_ECHO_MAX on arrival")


def test_a_demand_ends_when_its_echo_is_as_old_as_opr_echo_max() -> None:
    """It may be as old as that: to count 0.45 s from its arrival would obey it for twice as long."""
    bench = going()
    drive(bench, 0.05, AHEAD, delay=0.25)
    bench.wait(0.15)
    assert bench.turning
    assert bench.throttles[0] == 1.0, "0.20 s after it arrived"
    bench.wait(0.05)
    assert bench.throttles[0] < 1.0, "0.25 s after it arrived"


def test_a_stop_of_any_age_is_obeyed() -> None:
    bench = going()
    drive(bench, 0.1, NEUTRAL, delay=2.0)
    assert bench.throttles[0] < 1.0
    drive(bench, 0.4, NEUTRAL, delay=2.0)
    assert not bench.turning


def test_an_old_neutral_proves_no_stick_at_rest() -> None:
    bench = Bench()
    bench.wait(2.0)
    bench.arm()
    drive(bench, 0.5, NEUTRAL, delay=2.0)
    drive(bench, 0.5, AHEAD)
    assert not bench.turning


def test_an_echo_of_an_earlier_boot_is_rejected() -> None:
    bench = going()
    for _ in range(30):
        say(bench, 0x7FFFFFFF)
        bench.stick(AHEAD)
        bench.wait(0.05)
    assert not bench.turning


def without_echo(bench: Bench, axes: Axes) -> None:
    """Send demands for 1 s with an echo of 0."""
    for _ in range(20):
        say(bench, 0)
        bench.stick(axes)
        bench.wait(0.05)


def test_before_the_first_echo_demands_are_not_rejected() -> None:
    bench = Bench()
    bench.arm()
    without_echo(bench, NEUTRAL)
    without_echo(bench, AHEAD)
    assert bench.turning


def test_after_the_first_echo_an_echo_of_0_is_old() -> None:
    bench = going()
    without_echo(bench, AHEAD)
    assert not bench.turning
    assert said(bench, "older than OPR_ECHO_MAX on arrival")


def test_an_echo_of_0_does_not_stop_a_stop() -> None:
    bench = going()
    for axes in (AHEAD, NEUTRAL):
        say(bench, 0)
        bench.stick(axes)
    bench.wait(0.45)
    assert not bench.turning


def test_a_new_session_does_not_forget_that_there_was_an_echo() -> None:
    bench = going()
    for axes in (NEUTRAL, AHEAD):
        for _ in range(10):
            say(bench, 0, session=2)
            bench.stick(axes)
            bench.wait(0.05)
    assert not bench.turning
    drive_session(bench, 2, NEUTRAL)
    drive_session(bench, 2, AHEAD)
    assert bench.turning


def drive_session(bench: Bench, session: int, axes: Axes) -> None:
    """Send demands for 0.5 s with a current echo, in another session."""
    for _ in range(10):
        say(bench, int((bench.now - 100.0 - 0.1) * 1000), session=session)
        bench.stick(axes)
        bench.wait(0.05)


def test_a_key_without_input_stops_after_the_timeout() -> None:
    bench = going()
    drive(bench, 0.5, AHEAD, age=9_000)
    assert bench.turning
    drive(bench, 0.5, AHEAD, age=10_200)
    assert not bench.turning
    assert said(bench, "no operator input: stopping")
    drive(bench, 2.0, AHEAD, age=12_000)
    assert bench.mode is Mode.HOLD


def test_after_a_new_key_press_neutral_comes_first() -> None:
    bench = going()
    drive(bench, 0.5, AHEAD, age=10_200)
    assert not bench.turning
    drive(bench, 0.5, AHEAD)
    assert not bench.turning
    drive(bench, 0.1, NEUTRAL)
    drive(bench, 0.1, AHEAD)
    assert bench.turning


def test_a_lost_input_device_stops_at_once() -> None:
    bench = going()
    for _ in range(10):
        say(bench, int((bench.now - 100.0 - 0.1) * 1000), flags=4)
        bench.stick(AHEAD)
        bench.wait(0.05)
    assert not bench.turning


def test_a_new_session_requires_neutral_first() -> None:
    bench = going()
    drive_session(bench, 2, AHEAD)
    assert not bench.turning


def test_presence_messages_of_others_are_ignored() -> None:
    bench = going()
    bench.say(m.RoverOperatorPresence(1, 1, 0, 1, 9, 1, 65535, 4), OTHER)
    drive(bench, 0.2, AHEAD)
    assert bench.turning


def test_demand_behind_a_presence_moves_the_motors_on_arrival() -> None:
    # Both come in one moment. Were the ramp advanced by the first, nothing would be left for the second until a tick.
    bench = Bench()
    bench.wait(2.0)
    bench.arm()
    drive(bench, 0.5, NEUTRAL)
    bench.now += 0.01
    say(bench, int((bench.now - 100.0 - 0.1) * 1000))
    bench.stick(AHEAD)
    assert bench.turning


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
