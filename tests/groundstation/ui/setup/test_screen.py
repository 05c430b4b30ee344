"""The Setup screen: what its keys do, and above all what stops a motor."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from groundstation.intents.session import SetKeyGate
from groundstation.intents.setup import (
    Calibrate,
    ConfirmPosition,
    EndCalibration,
    RebootVehicle,
    RunChecks,
    StopMotorTest,
    TurnMotor,
    WatchSticks,
)
from groundstation.intents.vehicle import SetMode
from groundstation.intents.watch import Watch
from groundstation.snapshot import Snapshot
from groundstation.ui.params.model import ParamModel
from groundstation.ui.setup.screen import SetupScreen
from groundstation.ui.terminal.key_parser import KeyUp
from groundstation.views.doctor import DoctorRequest, DoctorView, ParamFix, StickRow
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.example_setup import EMPTY, LACKING, LAYING, doctor_view
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

STANDS = snapshot(vehicle=vehicle(armed=False))


async def open_setup(screen: Console, view: DoctorView | None = None, picture: Snapshot = STANDS) -> SetupScreen:
    await screen.press("f8")
    await until(lambda: screen.station.of(Watch))
    await offer(screen, view or doctor_view(), picture)
    top = screen.app.screen
    assert isinstance(top, SetupScreen)
    return top


async def offer(screen: Console, view: DoctorView, picture: Snapshot = STANDS) -> None:
    screen.station.offer_view(view)
    await screen.show(picture)


async def test_it_watches_the_chain_and_names_the_fault_at_the_cursor() -> None:
    async with console() as screen:
        await open_setup(screen)
        (request,) = screen.station.of(Watch)[-1].requests
        assert isinstance(request, DoctorRequest)
        assert "You cannot drive yet: pre-arm" in screen.text
        assert not screen.station.of(SetKeyGate)[-1].open


async def test_enter_does_what_the_line_proposes() -> None:
    async with console((140, 45)) as screen:
        await open_setup(screen)
        await screen.press("enter")
        assert screen.station.of(RunChecks) == [RunChecks(1, 1)]
        await screen.press("down", "enter")
        assert screen.station.of(SetMode) == [SetMode("MANUAL")]
        await screen.press("down", "enter")
        await until(lambda: screen.app.screen is screen.app.drive)


async def test_f_makes_the_fix_pending_and_writes_nothing() -> None:
    async with console((140, 45)) as screen:
        top = await open_setup(screen)
        await screen.press("f")
        await until(lambda: "no parameter helps here" in screen.text)
        await screen.press("down", "down", "down", "f")
        await until(lambda: "RC_OVERRIDE_TIME 3 → 0.5 is pending" in screen.text)
        params = top.context.keep(ParamModel)
        assert [(each.before, each.value) for each in params.pending.values()] == [(3.0, 0.5)]


async def test_checks_and_reboot() -> None:
    async with console() as screen:
        await open_setup(screen)
        await screen.press("c")
        assert screen.station.of(RunChecks) == [RunChecks(1, 1)]
        await screen.press("B")
        await until(lambda: "restart ArduPilot rover 1 · y does it" in screen.text)
        await screen.press("n", "B", "y")
        assert [intent.system for intent in screen.station.of(RebootVehicle)] == [1]
        ended = RequestLine(3, "refused", "reboot", "FAILED: Disarm before reboot", service="setup", system=1)
        await offer(screen, doctor_view(requests=(ended,)))
        await until(lambda: "reboot: refused, FAILED: Disarm before reboot" in screen.text)


# ---- motors ----


def stopped(screen: Console, before: int) -> bool:
    """Another stop was sent."""
    return len(screen.station.of(StopMotorTest)) > before


def says(screen: Console, words: str) -> bool:
    """The screen shows these words."""
    return words in screen.text


async def begin_test(screen: Console) -> None:
    await open_setup(screen)
    await screen.press("m")
    await until(lambda: "WHEELS OFF THE GROUND" in screen.text)
    await screen.press("y")
    await until(lambda: "hold a key" in screen.text)


async def test_no_key_turns_a_motor_before_the_answer() -> None:
    async with console() as screen:
        await open_setup(screen)
        await screen.press("1", "m", "1", "2")
        assert screen.station.of(TurnMotor) == []
        await screen.press("m", "y", "2")
        assert screen.station.of(TurnMotor) == [TurnMotor(system=1, motor=2, throttle=0.12)]


async def test_the_release_stops_it() -> None:
    async with console() as screen:
        await begin_test(screen)
        await screen.press("1")
        before = len(screen.station.of(StopMotorTest))
        screen.app.post_message(KeyUp("1"))
        await until(lambda: len(screen.station.of(StopMotorTest)) > before)
        assert isinstance(screen.station.wishes[-1], StopMotorTest)


async def test_every_other_key_stops_it() -> None:
    async with console() as screen:
        await begin_test(screen)
        for key in ("x", "space", "q", "c", "plus", "3", "up"):
            await screen.press("1")
            before = len(screen.station.of(StopMotorTest))
            await screen.press(key)
            await until(partial(stopped, screen, before))


@pytest.mark.parametrize("key", ["escape", "f6", "ctrl+g", "ctrl+p"])
async def test_what_comes_on_top_stops_it(key: str) -> None:
    async with console() as screen:
        await begin_test(screen)
        await screen.press("1")
        before = len(screen.station.of(StopMotorTest))
        await screen.press(key)
        await until(lambda: len(screen.station.of(StopMotorTest)) > before)


async def test_after_another_screen_the_keys_turn_nothing() -> None:
    async with console() as screen:
        await begin_test(screen)
        await screen.press("f6", "f8")
        await offer(screen, doctor_view())
        await screen.press("1")
        assert screen.station.of(TurnMotor) == []


async def test_where_no_motor_can_be_tested() -> None:
    cases = {
        "not known which motors": LACKING,
        "the vehicle is armed": doctor_view(armed=True),
        "MOT_TEST_MAX is 0": doctor_view(motor_limit=0.0),
        "no vehicle yet": EMPTY,
    }
    async with console() as screen:
        await open_setup(screen)
        for words, view in cases.items():
            await offer(screen, view)
            await screen.press("m")
            await until(partial(says, screen, words))
            await screen.press("y", "1")
        assert screen.station.of(TurnMotor) == []


async def test_the_strength_has_its_limits() -> None:
    async with console() as screen:
        await begin_test(screen)
        await screen.press(*["plus"] * 10, "1", *["minus"] * 14, "1")
        assert [intent.throttle for intent in screen.station.of(TurnMotor)] == [0.3, 0.04]


async def test_another_vehicle_ends_the_test() -> None:
    async with console() as screen:
        await begin_test(screen)
        await offer(screen, doctor_view(system=2))
        await screen.press("1")
        assert screen.station.of(TurnMotor) == []


async def test_v_reverses_the_motor_that_was_turned() -> None:
    async with console() as screen:
        await begin_test(screen)
        await screen.press("v")
        await until(lambda: "turn a motor first" in screen.text)
        await screen.press("1", "v")
        await until(lambda: "SERVO1_REVERSED 0 → 1 is pending" in screen.text)


# ---- calibration and the report ----


async def test_calibrations_ask_first() -> None:
    async with console() as screen:
        await open_setup(screen)
        await screen.press("A", "n", "Y", "y")
        assert screen.station.of(Calibrate) == [Calibrate(2, 1, "gyro")]
        await offer(screen, LAYING)
        await screen.press("enter")
        assert screen.station.of(ConfirmPosition) == [ConfirmPosition(1)]


async def test_what_the_vehicle_cannot_calibrate() -> None:
    async with console() as screen:
        await open_setup(screen, LACKING)
        await screen.press("C")
        await until(lambda: "this vehicle cannot calibrate that" in screen.text)
        assert screen.station.of(Calibrate) == []


def take_file(folder: Path) -> str:
    """Return the only file of a folder, and remove both."""
    (file,) = folder.glob("*")
    text = file.read_text("utf-8")
    file.unlink()
    folder.rmdir()
    return text


async def test_the_report(tmp_path: Path) -> None:
    async with console(folder=tmp_path) as screen:
        await open_setup(screen)
        await screen.press("S")
        await until(lambda: "saved doctor-" in screen.text)
        assert "X  pre-arm      Compass not calibrated (+1)" in take_file(tmp_path)
        await screen.press("S")
        await until(lambda: "not saved: No such file or directory" in screen.text)


async def test_the_tab_counts_what_stops_the_operator() -> None:
    async with console((140, 45)) as screen:
        await screen.show(snapshot(faults=2))
        await until(lambda: "F8 Setup 2✗" in screen.text)


STICKS = (StickRow(1, 1102, 1898, 1504, moved=True), StickRow(2, 1450, 1550, 1500, moved=False))
MOVED = doctor_view(
    sticks=STICKS, stick_changes=(ParamFix("RC1_MIN", 1100.0, 1102.0), ParamFix("RC1_MAX", 1900.0, 1898.0)),
    calibration="move all sticks to their ends, centre them, then ENTER (moved: 1)",
)  # fmt: skip


async def test_the_result_of_a_compass_is_written_when_it_is_there() -> None:
    async with console((140, 45)) as screen:
        await open_setup(screen, doctor_view(calibration="compass 1 40 %: turn it", calibration_share=0.4))
        await until(lambda: " 40% " in screen.text)
        await screen.press("W")
        await until(lambda: "there is no result of a compass to write" in screen.text)
        assert not screen.station.of(EndCalibration)
        await offer(screen, doctor_view(calibration="compass 1 fit 8.2", compass_ready=True))
        await screen.press("W", "x")
        assert [(intent.system, intent.accept) for intent in screen.station.of(EndCalibration)] == [
            (1, True), (1, False),
        ]  # fmt: skip


async def test_the_sticks_become_pending_parameters() -> None:
    async with console((140, 45)) as screen:
        top = await open_setup(screen)
        await screen.press("R", "n", "R", "y")
        assert screen.station.of(WatchSticks) == [WatchSticks(1)]
        await offer(screen, doctor_view(sticks=STICKS[1:]))
        await screen.press("enter")
        await until(lambda: "no stick was moved" in screen.text)
        await offer(screen, doctor_view(sticks=STICKS, sticks_unread=("RC1_TRIM",)))
        await screen.press("enter")
        await until(lambda: "RC1_TRIM is being read" in screen.text)
        await offer(screen, MOVED)
        await until(lambda: "1102" in screen.text and "1898" in screen.text)
        await screen.press("enter")
        await until(lambda: "2 changes are pending: F4, then W writes them" in screen.text)
        assert screen.station.of(WatchSticks) == [WatchSticks(1), WatchSticks(1, on=False)]
        params = top.context.keep(ParamModel)
        assert {each.name: each.value for each in params.pending.values()} == {"RC1_MIN": 1102.0, "RC1_MAX": 1898.0}
        await screen.press("x")
        assert screen.station.of(WatchSticks)[-1] == WatchSticks(1, on=False)
        assert not screen.station.of(EndCalibration)


async def test_the_sticks_of_an_armed_vehicle_are_not_calibrated() -> None:
    async with console() as screen:
        await open_setup(screen, doctor_view(armed=True))
        await screen.press("R")
        await until(lambda: "disarm it before the sticks are calibrated" in screen.text)
        assert not screen.station.of(WatchSticks)
