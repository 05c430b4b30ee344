"""The Drive screen: arming by a held key, and what it shows."""

from __future__ import annotations

import math

import pytest

from groundstation.intents.driving import ClearEmergencyStop, DriveKeyDown, EmergencyStop
from groundstation.intents.session import SetKeyGate, StartSimulator
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.snapshot import EmergencyProgress, LinkView
from groundstation.ui.display.alerts import LIMITS
from tests.groundstation.ui.examples import snapshot, vehicle, waiting, wheels
from tests.groundstation.ui.pilots import console
from tests.waits import until

DISARMED = snapshot(vehicle=vehicle(armed=False))
STOPPED = snapshot(vehicle=vehicle(armed=False, emergency_stop=True))


async def test_arming_shows_a_bar_and_needs_the_key_held() -> None:
    async with console(picture=DISARMED) as screen:
        begun = screen.clock()
        with screen.clock.stand():
            await screen.press("r")
            assert screen.station.of(Arm) == []
            await until(lambda: "Arm: hold r" in screen.text)
        await screen.hold("r", lambda: screen.station.of(Arm))
        (arm,) = screen.station.of(Arm)
        assert HOLD_TIME <= arm.held <= screen.clock() - begun


async def test_the_bar_ends_by_itself_and_a_late_answer_does_nothing() -> None:
    async with console(picture=DISARMED) as screen:
        with screen.clock.stand():
            await screen.press("r")
            await until(lambda: "Arm: hold r" in screen.text)
        await until(lambda: "disarmed: hold r to arm" in screen.text)
        await screen.press("y", "r", "y")
        assert screen.station.of(Arm) == []


@pytest.mark.parametrize("key", ["n", "space", "i", "escape", "y"])
async def test_another_key_cancels(key: str) -> None:
    async with console(picture=DISARMED) as screen:
        with screen.clock.stand():
            await screen.press("r")
            assert screen.app.gate.hold is not None
            await screen.press(key)
        assert screen.app.gate.hold is None
        assert screen.station.of(Arm) == []


async def test_disarming_is_one_press() -> None:
    async with console() as screen:
        await screen.press("r")
        assert screen.station.of(Disarm) == [Disarm()]
        assert screen.app.gate.hold is None


async def test_the_emergency_stop_is_released_by_a_held_key() -> None:
    async with console(picture=STOPPED) as screen:
        await screen.press("t")
        assert not screen.station.of(ClearEmergencyStop)
        await screen.hold("t", lambda: screen.station.of(ClearEmergencyStop))
        assert screen.station.of(ClearEmergencyStop)[0].held >= HOLD_TIME


async def test_without_a_vehicle_enter_starts_the_simulator() -> None:
    async with console(picture=waiting()) as screen:
        assert "waiting for a vehicle on udpin:127.0.0.1:14550" in screen.text
        await screen.press("enter")
        assert screen.station.of(StartSimulator) == [StartSimulator()]


async def test_with_a_vehicle_enter_starts_nothing() -> None:
    async with console() as screen:
        await screen.press("enter")
        assert not screen.station.of(StartSimulator)


async def test_a_small_terminal_says_what_it_needs_and_still_stops() -> None:
    async with console(size=(39, 12)) as screen:
        assert "needs 40 x 10" in screen.text
        assert "Rover 1 · MANUAL · ARMED\n" in screen.text
        assert screen.station.of(SetKeyGate)[-1].open is False
        await screen.press("space", "exclamation_mark")
        assert screen.station.of(EmergencyStop)


async def test_a_small_terminal_arms_nothing_and_shows_the_state() -> None:
    async with console(size=(60, 9), picture=DISARMED) as screen:
        await screen.press("r")
        assert screen.app.gate.hold is None
        await screen.clock.hold(lambda: screen.press("r"))
        assert not screen.station.of(Arm)
        assert "Rover 1 · MANUAL · DISARMED\n" in screen.text
        await screen.show(STOPPED)
        assert "DISARMED · EMERGENCY STOP\n" in screen.text
        await screen.show(snapshot())
        await screen.press("r")
        assert screen.station.of(Disarm)


@pytest.mark.parametrize("size", [(40, 10), (60, 15), (79, 23)])
async def test_on_strip_keys_drive_and_the_driver_sees_what_matters(size: tuple[int, int]) -> None:
    async with console(size=size) as screen:
        assert screen.app.gate.closure is None
        await screen.press("i")
        assert screen.station.of(DriveKeyDown)
        await until(lambda: screen.text.startswith(" ARMED  MANUAL  Rover 1"))
        words = ("0.84 m/s", "you drive", "hold i to drive", "stops when you let go", "! E-STOP")
        await until(lambda: all(map(screen.text.__contains__, words)))  # drawn one after the other
        await screen.show(DISARMED)
        with screen.clock.stand():
            await screen.press("r")
            await until(lambda: "? Arm: hold r" in screen.text)
        await screen.hold("r", lambda: screen.station.of(Arm))
        assert screen.text.startswith(" DISARMED  MANUAL")


async def test_the_strip_has_caps_bars_and_bounds_where_there_is_room() -> None:
    words = ("stops without", " steering ", " j   k   l ")
    async with console(size=(60, 20)) as screen:
        await until(lambda: all(map(screen.text.__contains__, words)))
        bound = "stops when you let go"
        assert screen.text.count(bound) == 1, "beside the caps, and not in a line of its own, too"
    async with console(size=(60, 12)) as screen:
        await until(lambda: "0.84 m/s" in screen.text)
        assert screen.text.count(bound) == 1
        assert not any(map(screen.text.__contains__, words))


@pytest.mark.parametrize("size", [(40, 10), (60, 15)])
async def test_the_strip_shows_the_first_alert_and_arming_in_any_case(size: tuple[int, int]) -> None:
    bad = vehicle(
        name="ArduPilot rover 111", armed=True, emergency_stop=True, emergency_progress=EmergencyProgress.UNANSWERED,
        warnings=tuple(f"SETTING_{number} 0: never stops when the link is lost" for number in range(9)),
        refusal="mode AUTO denied: no mission", limits=tuple(LIMITS),
    )  # fmt: skip
    async with console(size=size, picture=snapshot(vehicle=bad)) as screen:
        assert screen.text.startswith(" ARMED  E-STOP SENT  MANUAL")
        flat = " ".join(screen.text.split())
        assert "EMERGENCY STOP sent, NOT acknowledged, but the vehicle reports ARMED" in flat
        assert "F6 lists all" in flat


async def test_growing_opens_the_gate() -> None:
    async with console(size=(39, 20)) as screen:
        await screen.pilot.resize_terminal(80, 24)
        await until(lambda: screen.app.gate.closure is None)
        await screen.show(snapshot())
        assert "you drive" in screen.text


async def test_a_pressed_key_lights_up_before_the_station_knows() -> None:
    async with console() as screen:
        caps = screen.app.drive.query_one("#keycaps")
        dark = caps.render_line(0)
        for _ in range(20):  # a cap stays lit for 0.15 s: on a loaded machine one press may be over when we look
            await screen.pilot.press("u")
            if caps.render_line(0) != dark:
                break
        else:
            pytest.fail("it stayed dark")
        await until(lambda: caps.render_line(0) == dark)


async def test_numbers_that_are_none_do_not_break_the_screen() -> None:
    nan = math.nan
    strange = vehicle(
        position=(nan, math.inf), heading=nan, roll=nan, pitch=math.inf, speed=nan, battery_voltage=nan,
        battery_remaining=nan, demand=(nan, nan), outputs=wheels(nan, math.inf), command_age=nan, latency=math.inf,
    )  # fmt: skip
    for size in ((80, 24), (140, 45)):
        links = (LinkView(name="x", loss=nan, round_trip=nan),)
        async with console(size, snapshot(vehicle=strange, links=links)) as screen:
            assert "ARMED" in screen.text
