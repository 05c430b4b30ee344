"""ONBOARD_COMPUTER_STATUS: sent where the computer is watched, and always fit to send."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result
from tests.examples import examples
from tests.vehicle.bench import EVERYTHING, Bench
from vehicle.readings import ComputerReadings

WELL = ComputerReadings(
    temperature=48.6, load=0.25, memory_used=300 * 2**20, memory_total=1024 * 2**20, uptime=90.5,
    under_voltage=False, throttled=False,
)  # fmt: skip


def watched(computer: ComputerReadings) -> Bench:
    bench = Bench()
    bench.readings = replace(EVERYTHING, computer=computer)
    return bench


def test_it_is_sent_every_two_seconds() -> None:
    bench = watched(WELL)
    bench.wait(20.0)
    assert len(bench.all(m.OnboardComputerStatus)) in (10, 11)
    told = bench.newest(m.OnboardComputerStatus)
    assert (told.uptime, told.ram_usage, told.ram_total, told.status_flags) == (90_500, 300, 1024, 0)
    assert (told.temperature_core[0], told.cpu_cores[0]) == (49, 25)
    assert (told.temperature_core[1], told.cpu_cores[1], told.temperature_board) == (127, 255, 127)


def test_without_a_watched_computer_there_is_none() -> None:
    bench = Bench()
    bench.readings = replace(EVERYTHING, computer=None)
    bench.wait(5.0)
    assert not bench.all(m.OnboardComputerStatus)
    bench.heartbeat()
    assert bench.command(Command.REQUEST_MESSAGE, m.OnboardComputerStatus.id) is Result.FAILED


def test_it_can_be_asked_for() -> None:
    bench = watched(WELL)
    bench.wait(3.0)
    count = len(bench.all(m.OnboardComputerStatus))
    bench.heartbeat()
    assert bench.command(Command.REQUEST_MESSAGE, 390) is Result.ACCEPTED
    assert len(bench.all(m.OnboardComputerStatus)) == count + 1


@pytest.mark.parametrize(("under_voltage", "throttled", "flags"), [(True, False, 1), (False, True, 2), (True, True, 3)])
def test_a_weak_supply_and_a_slow_processor_are_flags(under_voltage: bool, throttled: bool, flags: int) -> None:
    bench = watched(replace(WELL, under_voltage=under_voltage, throttled=throttled))
    bench.wait(3.0)
    assert bench.newest(m.OnboardComputerStatus).status_flags == flags


def test_what_nobody_knows_is_said_so() -> None:
    bench = watched(ComputerReadings())
    bench.wait(3.0)
    told = bench.newest(m.OnboardComputerStatus)
    assert (told.temperature_core, told.cpu_cores) == ([127] * 8, [255] * 8)
    assert (told.ram_usage, told.ram_total, told.status_flags) == (2**32 - 1, 2**32 - 1, 0)


NUMBER = st.one_of(st.none(), st.floats(), st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e300]))
BYTES = st.one_of(st.none(), st.integers(min_value=-(2**70), max_value=2**70))


@settings(max_examples=examples(60))
@given(
    st.builds(ComputerReadings, temperature=NUMBER, load=NUMBER, uptime=NUMBER, memory_used=BYTES, memory_total=BYTES)
)
def test_no_reading_of_the_computer_breaks_a_message(computer: ComputerReadings) -> None:
    """The bench encodes every message that leaves."""
    bench = watched(computer)
    bench.wait(2.5)
    assert bench.all(m.OnboardComputerStatus)
