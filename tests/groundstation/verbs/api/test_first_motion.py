"""How soon the wheels turn behind a call that drives: once our vehicle reports that a neutral demand counts."""

from __future__ import annotations

import asyncio

import pytest

from groundstation.station.driving.operator import NEUTRAL_LEAD
from tests.groundstation.verbs.api.virtual_program import STEP, VirtualProgram

DRIVE = ("drive", "--throttle", "60", "--for", "0.5")


async def time_to_motion(program: VirtualProgram) -> float:
    """Drive; return the s from the call to the first power of a wheel."""
    began = program.loop.time()
    call = asyncio.ensure_future(program.call(DRIVE))
    while not program.turning:
        assert not call.done(), call.result()
        await asyncio.sleep(STEP)
    moved = program.loop.time() - began
    assert (await call)["code"] == 0
    return moved


def test_wheels_turn_soon_where_our_vehicle_takes_neutral() -> None:
    program, times = VirtualProgram(0.0, 1), list[float]()

    async def run(program: VirtualProgram) -> None:
        await program.call(("arm", "--wait", "30"))
        for mode in ("MANUAL", "HOLD"):
            assert (await program.call(("mode", mode)))["code"] == 0
            times.append(await time_to_motion(program))

    program.run(run)
    assert max(times) < NEUTRAL_LEAD, "it waits for the report of the vehicle, not for a time"
    assert program.strays == []


LATE = 0.4
"""s each way: proofs are older than 0.45 s (OPR_ECHO_MAX) when they arrive, and prove nothing."""


def test_a_call_drives_what_was_armed_while_the_link_was_late() -> None:
    program = VirtualProgram(0.0, 1)

    async def run(program: VirtualProgram) -> None:
        await asyncio.sleep(2.0)
        for pipe in program.pipes:
            pipe.delay = LATE
        await asyncio.sleep(2.0)
        assert (await program.call(("arm", "--wait", "30")))["code"] == 0
        for pipe in program.pipes:
            pipe.delay = 0.0
        await asyncio.sleep(2.0)
        assert program.session.vehicle.control.session == 0, "the vehicle counts it as one without sessions"
        assert await time_to_motion(program) < 1.0

    program.run(run)
    assert program.strays == []


@pytest.mark.slow
def test_each_drive_turns_the_wheels_where_frames_get_lost() -> None:
    for seed in (111, 181):  # without a look at the vehicle's reports one drive of each moved nothing
        program = VirtualProgram(0.25, seed)
        program.run(drive_ten_times)
        assert program.driven >= 10
        assert program.strays == []


async def drive_ten_times(program: VirtualProgram) -> None:
    while (await program.call(("arm", "--wait", "30")))["code"]:
        pass
    for mode in ("MANUAL", "HOLD") * 5:
        await program.call(("mode", mode))
        while (await program.call(DRIVE))["code"]:
            pass
        await asyncio.sleep(0.3)
