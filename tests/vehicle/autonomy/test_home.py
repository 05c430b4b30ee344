"""DO_SET_HOME: position, altitude, and values that are left out."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result
from tests.vehicle.bench import EVERYTHING, Bench

HERE = (481_000_000, 115_000_000, 500_000)
THERE = (481_010_000, 115_020_000)


def placed() -> Bench:
    bench = Bench()
    bench.readings = EVERYTHING
    bench.heartbeat()
    bench.wait(3.0)
    return bench


def home(bench: Bench) -> tuple[int, int, int]:
    """Return the reported home: degrees x 1e7 and mm."""
    bench.wait(0.1)
    told = bench.newest(m.HomePosition)
    return told.latitude, told.longitude, told.altitude


def set_home(bench: Bench, frame: int, altitude: float) -> int:
    bench.say(m.CommandInt(1, 1, frame, Command.DO_SET_HOME, 0, 0, 0, 0, 0, 0, *THERE, altitude))
    return int(bench.newest(m.CommandAck).result)


@pytest.mark.parametrize(
    ("frame", "altitude", "expected"),
    [(0, 520, 520_000), (5, 520, 520_000), (3, 20, 520_000), (6, -20, 480_000), (0, math.nan, 500_000)],
)
def test_home_has_a_position_and_an_altitude_in_its_frame(frame: int, altitude: float, expected: int) -> None:
    bench = placed()
    assert home(bench) == HERE
    assert set_home(bench, frame, altitude) == Result.ACCEPTED
    assert home(bench) == (*THERE, expected)


@pytest.mark.parametrize("altitude", [math.inf, -math.inf, 1e6])
def test_an_invalid_altitude_is_denied(altitude: float) -> None:
    bench = placed()
    assert set_home(bench, 0, altitude) == Result.DENIED
    assert home(bench) == HERE


def test_home_can_be_set_to_the_present_position() -> None:
    bench = placed()
    set_home(bench, 0, 520)
    assert bench.command(Command.DO_SET_HOME, 1) is Result.ACCEPTED
    assert home(bench) == pytest.approx(HERE, abs=1000)  # it drifts


@pytest.mark.parametrize("altitude", [None, math.nan])
def test_home_at_the_present_position_keeps_an_unknown_altitude(altitude: float | None) -> None:
    bench = placed()
    set_home(bench, 0, 520)
    bench.readings = replace(EVERYTHING, altitude=altitude)
    bench.wait(0.1)
    assert bench.command(Command.DO_SET_HOME, 1) is Result.ACCEPTED
    assert home(bench)[2] == 520_000
