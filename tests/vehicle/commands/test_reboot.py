"""PREFLIGHT_REBOOT_SHUTDOWN: bad input 57, and the exit codes of a real process."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from tests.rows import each_row
from tests.vehicle.bench import AHEAD, DRIVER, OTHER, Bench, said
from tests.vehicle.ground import Ground, drive, running
from vehicle.commands.reboot import RebootRequest
from vehicle.runtime.shutdown import Shutdown

REBOOT = Command.PREFLIGHT_REBOOT_SHUTDOWN
NAN = math.nan


class TestReboot:
    def test_without_the_setting_it_is_denied(self) -> None:
        bench = Bench()
        for wish in ((1, 0), (0, 1), (0, 2)):
            assert bench.command(REBOOT, *wish) is Result.DENIED
        bench.wait(2.0)
        assert bench.rover.reboot_request(bench.now) is None

    @pytest.mark.parametrize("enabled", [0, 2])
    def test_57_while_armed_it_fails(self, enabled: float) -> None:
        bench = Bench(REBOOT_ENABLE=enabled)
        bench.drive()
        assert bench.command(REBOOT, 1, 0, 0, 0, 0, 20190226) is Result.FAILED
        bench.wait(1.0, AHEAD)
        assert bench.turning
        assert bench.rover.reboot_request(bench.now) is None
        assert said(bench, "PREFLIGHT_REBOOT_SHUTDOWN refused: armed")

    @each_row(
        ("wish", "leave"),
        [
            ((1, 0), RebootRequest.RESTART),
            ((0, 1), RebootRequest.REBOOT),
            ((1, 1), RebootRequest.REBOOT),
            ((0, 2), RebootRequest.POWER_OFF),
            ((1, 2), RebootRequest.POWER_OFF),
            ((1, *(NAN,) * 6), RebootRequest.RESTART),  # MAVSDK 4
            ((2, *(NAN,) * 6), RebootRequest.POWER_OFF),
            ((1, 1, 1, 1), RebootRequest.REBOOT),  # MAVSDK before
            ((2, 2, 2, 2), RebootRequest.POWER_OFF),
            ((0, 0, 1, 0), RebootRequest.RESTART),  # all components
            ((0, 0, 2, 1), RebootRequest.POWER_OFF),  # this one
            ((1, 0, 1, 100), RebootRequest.RESTART),  # a camera that we have not
        ],
    )
    def test_first_the_answer_then_the_end(self, wish: tuple[float, ...], leave: RebootRequest) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        assert bench.command(REBOOT, *wish) is Result.ACCEPTED
        assert bench.rover.reboot_request(bench.now) is None
        bench.wait(0.3)
        assert bench.command(REBOOT, *wish) is Result.ACCEPTED  # its answer was lost: the same end
        bench.wait(0.22)
        assert bench.rover.reboot_request(bench.now) is leave
        assert said(bench, f"GCS {DRIVER}: {leave.label}")

    @pytest.mark.parametrize(
        "wish",
        [
            (0, 0),
            (3, 0),
            (1, 3),
            (2, 1),
            (NAN, 0),
            (NAN,) * 7,
            (0.5, 0),
            (-1, 0),
            (math.inf, 0),
            (0, 0, 1, 100),
            (0, 0, 3, 0),
            (1, 0, 2, 1),
            (2, 0, 1, 0),
        ],
    )
    def test_what_is_not_offered_is_denied(self, wish: tuple[float, ...]) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        assert bench.command(REBOOT, *wish) is Result.DENIED
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None

    def test_the_setting_may_allow_the_program_only(self) -> None:
        bench = Bench(REBOOT_ENABLE=1)
        assert bench.command(REBOOT, 0, 1) is Result.DENIED
        assert bench.command(REBOOT, 2) is Result.DENIED
        assert said(bench, "PREFLIGHT_REBOOT_SHUTDOWN refused: REBOOT_ENABLE is 1")
        assert bench.command(REBOOT, 1, 0) is Result.ACCEPTED

    def test_who_arms_in_time_keeps_it(self) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        bench.command(REBOOT, 1)
        bench.arm()
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None
        assert said(bench, "Restart cancelled: armed")

    def test_only_who_is_in_control_may(self) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        bench.arm()
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        assert bench.command(REBOOT, 1, system=OTHER) is Result.FAILED
        assert bench.command(REBOOT, 1, introduced=False) is Result.FAILED
        assert bench.command(REBOOT, 1, target=0) is None
        assert bench.command(REBOOT, 1) is Result.ACCEPTED

    def test_no_ground_station_sets_the_setting(self) -> None:
        bench = Bench()
        bench.heartbeat()
        bench.say(m.ParamSet(1, 1, b"REBOOT_ENABLE", 2, 9))
        assert bench.newest(m.ParamValue).param_value == 0


@pytest.mark.e2e
@pytest.mark.parametrize(("wish", "code"), [((1, 0), 80), ((0, 1), 81), ((0, 2), 82)])
def test_the_process_ends_with_the_code_that_says_what_is_wanted(
    tmp_path: Path, wish: tuple[float, float], code: int
) -> None:
    words = ("--param", "REBOOT_ENABLE=2", "--param", "FS_DISARM_T=300")
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, *words) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ask(ground, REBOOT, *wish, until=lambda: Result.FAILED in answers(ground, REBOOT))
        ground.wait(vehicle.turning, "they turn still")
        ground.demand = None
        ask(ground, Command.COMPONENT_ARM_DISARM, until=lambda: not ground.armed and not vehicle.turning())
        ask(ground, REBOOT, *wish, until=lambda: vehicle.process.poll() is not None)
        ended, lines = vehicle.ended()
        assert ended == code
        assert lines[-1] == f"vehicle: {RebootRequest(code).label} as requested by a ground station, motors neutral"
        ground.drain()
        assert answers(ground, REBOOT)[-1] == Result.ACCEPTED


def ask(ground: Ground, command: int, *params: float, until: Callable[[], bool]) -> None:
    """Again and again, as clients do."""
    one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))

    def over() -> bool:
        ground.say(m.CommandLong(1, 1, command, 0, one, two, three, four, five, six, seven))
        return until()

    ground.wait(over, f"what {command} is for")


def answers(ground: Ground, command: int) -> list[int]:
    return [each.result for each in ground.heard if isinstance(each, m.CommandAck) and each.command == command]


def test_a_signal_that_came_first_decides_the_code() -> None:
    ended: list[str] = []

    class Nothing:
        def shutdown(self, now: float) -> None:
            ended.append("motors")

        def stop(self) -> None:
            ended.append("links")

    import asyncio

    async def both() -> int:
        ending = Shutdown(Nothing(), Nothing())  # type: ignore[arg-type]
        ending._end("stopped by SIGTERM")
        ending.handle_reboot_request(RebootRequest.POWER_OFF)
        return ending._code

    assert asyncio.run(both()) == 0
    assert ended == ["motors", "links"]
