"""Keys on the screen, and what the screen itself does: by Textual's Pilot."""

from __future__ import annotations

import math
from typing import Any

import pytest

from groundstation.intents import (
    ACTIONS,
    Arm,
    ClearEmergencyStop,
    Disarm,
    DriveKeyDown,
    EmergencyStop,
    Quit,
    RenewLease,
    SetKeyGate,
    StartSimulator,
    Stop,
)
from groundstation.snapshot import LinkView
from groundstation.ui.key_gate import GateLevel
from groundstation.ui.key_parser import KeyEventParser, KeyRepeat
from groundstation.ui.screens.help import HelpScreen
from tests.groundstation.ui.examples import snapshot, vehicle, waiting
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import until

DISARMED = snapshot(vehicle=vehicle(armed=False))
STOPPED = snapshot(vehicle=vehicle(armed=False, emergency_stop=True))


async def test_a_drive_key_is_a_push() -> None:
    async with console() as screen:
        await screen.press("i", "up", "w")
        assert [push.key for push in screen.station.of(DriveKeyDown)] == ["i", "up", "w"]


async def test_the_lease_is_renewed_by_the_loop_and_not_without_it() -> None:
    """The loop stands still in this test's own code: no thread of ours may renew meanwhile."""
    async with console() as screen:
        await until(lambda: len(screen.station.of(RenewLease)) > 3)
        before = len(screen.station.of(RenewLease))
        _busy_for(0.5)
        assert len(screen.station.of(RenewLease)) == before
        await until(lambda: len(screen.station.of(RenewLease)) > before)


def _busy_for(seconds: float) -> None:
    import time

    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


async def test_arming_asks_and_a_second_key_answers() -> None:
    async with console(picture=DISARMED) as screen:
        await screen.press("r")
        assert screen.station.of(Arm) == []
        await until(lambda: "Arm? y = yes" in screen.text)
        await screen.press("y")
        assert screen.station.of(Arm) == [Arm()]


@pytest.mark.parametrize("key", ["n", "space", "i", "escape", "r"])
async def test_any_other_key_is_a_no(key: str) -> None:
    async with console(picture=DISARMED) as screen:
        await screen.press("r", key, "y")
        assert screen.station.of(Arm) == []


async def test_the_gate_is_shut_while_a_question_is_open() -> None:
    async with console(picture=DISARMED) as screen:
        await screen.press("r")
        await until(lambda: screen.app.gate.closure is not None)
        assert screen.app.gate.closure is not None
        assert screen.app.gate.closure.level is GateLevel.STOPS
        await screen.press("n")
        await until(lambda: screen.app.gate.closure is None)


async def test_disarming_is_one_key_and_no_question() -> None:
    async with console() as screen:
        await screen.press("r")
        assert screen.station.of(Disarm) == [Disarm()]
        assert screen.app.drive.question is None


async def test_the_emergency_stop_is_released_with_two_keys() -> None:
    async with console(picture=STOPPED) as screen:
        await screen.press("t", "y")
        assert screen.station.of(ClearEmergencyStop) == [ClearEmergencyStop()]


@pytest.mark.parametrize("opener", ["question_mark", "ctrl+p"])
async def test_another_screen_is_neutral_and_still_stops(opener: str) -> None:
    async with console() as screen:
        await screen.press(opener)
        await until(lambda: screen.app.screen is not screen.app.drive)
        assert screen.station.of(SetKeyGate)[-1].open is False
        assert screen.station.of(Stop)
        await screen.press("exclamation_mark")
        assert screen.station.of(EmergencyStop)
        assert not screen.station.of(Disarm)


async def test_help_shows_every_key_and_goes_back() -> None:
    async with console(size=(100, 50)) as screen:
        await screen.press("question_mark")
        assert type(screen.app.screen).__name__ == "HelpScreen"
        assert "Motors off and locked" in screen.text
        await screen.press("escape")
        await until(lambda: screen.app.gate.closure is None)
        assert screen.app.screen is screen.app.drive


def type_in(screen: Console, data: str) -> None:
    """One read of the terminal: its keys are with the station when this returns, and the loop has had no turn yet."""
    for event in KeyEventParser(screen.app.gate).feed(data):
        event.set_sender(screen.app)
        screen.app.post_message(event)


def helps(screen: Console) -> int:
    return sum(isinstance(each, HelpScreen) for each in screen.app.screen_stack)


def helps_pushed(screen: Console, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Grows with each screen that is opened from now on: how many help screens there are then."""
    depths: list[int] = []
    push = screen.app.push_screen

    def noted(*arguments: Any, **options: Any) -> Any:
        pushed = push(*arguments, **options)
        depths.append(helps(screen))
        return pushed

    monkeypatch.setattr(screen.app, "push_screen", noted)
    return depths


async def test_several_keys_of_one_read_open_one_help_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as screen:
        depths = helps_pushed(screen, monkeypatch)
        type_in(screen, "???")
        await until(lambda: depths)
        await screen.pilot.pause()
        assert set(depths) == {1}


async def test_the_palette_opens_no_second_help_screen() -> None:
    async with console() as screen:
        await screen.press("question_mark")
        screen.app.choose_action(ACTIONS["app.help"])
        await screen.pilot.pause()
        assert helps(screen) == 1


STORMS = {
    "whole": "\x1b[?1u\x1b[?2048$p",
    "without escape": "[?1u[?2048$p",
    "cut": "\x1b[?1\x1b[?2048$",
    "doubled": "\x1b\x1b[?1u?\x1b\x1b[?2048$p?",
}
"""What a terminal answers to questions about itself, as bad lines hand it over."""


@pytest.mark.parametrize("storm", STORMS.values(), ids=STORMS)
async def test_a_storm_of_broken_answers_piles_up_nothing_and_keeps_no_stop_waiting(
    storm: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with console() as screen:
        depths = helps_pushed(screen, monkeypatch)
        type_in(screen, storm * 200 + "!")
        assert screen.station.of(EmergencyStop)
        type_in(screen, storm * 200 + "\x11")
        await until(lambda: screen.app.return_value == 0)
        assert max(depths, default=0) <= 1


async def test_an_action_of_the_palette_is_done() -> None:
    async with console() as screen:
        await screen.press("ctrl+p")
        await until(lambda: screen.app.screen is not screen.app.drive)
        for letter in "disarm":
            await screen.press(letter)
        await until(lambda: "Disarm" in screen.text)
        await screen.press("down", "enter")
        await until(lambda: screen.station.of(Disarm))


@pytest.mark.parametrize("key", ["ctrl+q", "ctrl+c"])
@pytest.mark.parametrize("first", [(), ("question_mark",), ("ctrl+p",)])
async def test_quit_needs_no_question_and_works_everywhere(key: str, first: tuple[str, ...]) -> None:
    async with console() as screen:
        await screen.press(*first, key)
        assert screen.app.return_value == 0
        assert screen.station.of(SetKeyGate)[-1].reason == "quitting"


LEAVES = snapshot(left_armed=("Rover 1 is left ARMED in MANUAL",))


@pytest.mark.parametrize("key", ["ctrl+q", "ctrl+c"])
async def test_quitting_armed_disarms_first_and_a_second_key_leaves_it_armed(key: str) -> None:
    async with console(picture=LEAVES) as screen:
        await screen.press(key)
        assert screen.app.return_value is None
        assert screen.station.of(Quit) == [Quit(disarm=True)]
        assert screen.station.of(SetKeyGate)[-1].open is False
        await screen.show(LEAVES)
        assert "disarming in 2 s; Ctrl-Q again leaves it ARMED" in screen.text
        await screen.press(key)
        assert screen.app.return_value == 0
        assert screen.station.of(Quit) == [Quit(disarm=True)], "the client sends the second one when it closes"


async def test_a_held_quit_key_is_one_request() -> None:
    async with console(picture=LEAVES) as screen:
        await screen.press("ctrl+q")
        for _ in range(5):
            await screen.app.on_event(KeyRepeat("ctrl+q", None))
        await screen.pilot.pause()
        assert screen.app.return_value is None


async def test_after_quitting_armed_the_screen_ends_with_the_station() -> None:
    async with console(picture=LEAVES) as screen:
        await screen.press("ctrl+q")
        screen.station.alive = False
        screen.station.offer(LEAVES)
        await until(lambda: screen.app.return_value == 0)


async def test_without_a_station_one_key_quits() -> None:
    async with console(picture=LEAVES) as screen:
        screen.station.alive = False
        await screen.press("ctrl+q")
        assert screen.app.return_value == 0


async def test_without_a_vehicle_enter_starts_the_simulator() -> None:
    async with console(picture=waiting()) as screen:
        assert "waiting for a vehicle on udpin:127.0.0.1:14550" in screen.text
        await screen.press("enter")
        assert screen.station.of(StartSimulator) == [StartSimulator()]
        await screen.press("f5")
        assert len(screen.station.of(StartSimulator)) == 2


async def test_with_a_vehicle_enter_starts_nothing() -> None:
    async with console() as screen:
        await screen.press("enter")
        assert not screen.station.of(StartSimulator)


async def test_a_small_terminal_says_what_it_needs_and_still_stops() -> None:
    async with console(size=(70, 20)) as screen:
        assert "needs 80 x 24" in screen.text
        assert screen.station.of(SetKeyGate)[-1].open is False
        await screen.press("space", "exclamation_mark")
        assert screen.station.of(EmergencyStop)


async def test_growing_opens_the_gate() -> None:
    async with console(size=(70, 20)) as screen:
        await screen.pilot.resize_terminal(80, 24)
        await until(lambda: screen.app.gate.closure is None)
        await screen.show(snapshot())
        assert "you drive" in screen.text


async def test_a_dead_station_is_said() -> None:
    async with console() as screen:
        screen.station.alive = False
        await until(lambda: "the station process has ended" in screen.text)
        assert screen.station.of(SetKeyGate)[-1].reason == "the station has ended"


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
        battery_remaining=nan, demand=(nan, nan), outputs=(nan, math.inf), command_age=nan, latency=math.inf,
    )  # fmt: skip
    for size in ((80, 24), (140, 45)):
        links = (LinkView(name="x", loss=nan, round_trip=nan),)
        async with console(size, snapshot(vehicle=strange, links=links)) as screen:
            assert "ARMED" in screen.text


async def test_a_beat_after_the_screens_are_gone_is_no_fault() -> None:
    # Textual takes the screens down before it stops the timers.
    async with console() as screen:
        app = screen.app
    assert not app.screen_stack
    app._tick()
