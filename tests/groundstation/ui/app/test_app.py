"""Keys on every screen, and what the app itself does: by Textual's Pilot."""

from __future__ import annotations

import time

import pytest
from textual import events

from groundstation.actions import ACTIONS
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import REST_PERIOD, Quit, RenewLease, SetKeyGate
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.snapshot import StationOutage
from groundstation.ui.app.app import AT_REST, TICK, WITHOUT_SNAPSHOT
from groundstation.ui.app.ticks import Ticks
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.terminal.key_parser import KeyRepeat
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console, helps_pushed, type_in
from tests.waits import until

DISARMED = snapshot(vehicle=vehicle(armed=False))


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


async def test_a_resting_station_is_renewed_rarely_until_its_rest_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console(picture=snapshot(vehicle=vehicle(armed=False), rests=True)) as screen:
        ticks = screen.app._ticks
        await until(lambda: ticks.period == REST_PERIOD)
        before = len(screen.station.of(RenewLease))
        screen.station.offer(snapshot(vehicle=vehicle(armed=True)))
        await until(lambda: ticks.period == TICK)
        assert len(screen.station.of(RenewLease)) > before
        screen.station.offer(snapshot(vehicle=vehicle(armed=False), rests=True))
        await until(lambda: ticks.period == REST_PERIOD)
        periods = _noted_periods(ticks, monkeypatch)
        await screen.press("j")
        await until(lambda: periods == [TICK, REST_PERIOD])  # the light of a key goes out in time


def _noted_periods(ticks: Ticks, monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return a list that gets each change of the period from now on, also one that is over before a test can look."""
    periods: list[float] = []
    set_period = ticks.set_period

    def note(period: float) -> None:
        if period != ticks.period:
            periods.append(period)
        set_period(period)

    monkeypatch.setattr(ticks, "set_period", note)
    return periods


def _busy_for(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


async def test_another_screen_cancels() -> None:
    async with console(picture=DISARMED) as screen:
        await screen.press("r")
        screen.app.choose_action(ACTIONS["app.help"])
        assert screen.app.gate.hold is None
        await screen.press(*["r"] * 5)  # the first one closes the help; more would be a hold on a slow machine
        assert screen.station.of(Arm) == []


async def test_a_lost_focus_cancels() -> None:
    async with console(picture=DISARMED) as screen:
        await screen.press("r")
        screen.app.post_message(events.AppBlur())
        await until(lambda: screen.app.gate.closure is not None)
        assert screen.app.gate.hold is None


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


STORMS = {
    "whole": "\x1b[?1u\x1b[?2048$p",
    "without escape": "[?1u[?2048$p",
    "cut": "\x1b[?1\x1b[?2048$",
    "doubled": "\x1b\x1b[?1u?\x1b\x1b[?2048$p?",
}
"""What a terminal answers to questions about itself, as bad lines hand it over."""
STORM = 40
"""Answers in one read: a screen that opens one more help for each holds 40 then."""


@pytest.mark.parametrize("storm", STORMS.values(), ids=STORMS)
async def test_storm_of_broken_answers_piles_up_nothing_and_stops_pass(
    storm: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with console() as screen:
        depths = helps_pushed(screen, monkeypatch)
        type_in(screen, storm * STORM + "!")
        assert screen.station.of(EmergencyStop)
        type_in(screen, storm * STORM + "\x11")
        await until(lambda: screen.app.return_value == 0)
        assert max(depths, default=0) <= 1


@pytest.mark.parametrize("key", ["ctrl+q", "ctrl+c"])
@pytest.mark.parametrize("first", [(), ("question_mark",), ("ctrl+p",)])
async def test_quit_needs_no_question_and_works_everywhere(key: str, first: tuple[str, ...]) -> None:
    async with console() as screen:
        await screen.press(*first, key)
        assert screen.app.return_value == 0
        assert screen.station.of(SetKeyGate)[-1].reason == "quitting"


class Beats:
    """An app whose time stands still from `count` on, and how often it has drawn the Drive screen since then."""

    def __init__(self) -> None:
        self._stands_at: float | None = None
        self.drawn = 0

    def clock(self) -> float:
        return time.monotonic() if self._stands_at is None else self._stands_at

    def count(self, screen: Console, monkeypatch: pytest.MonkeyPatch) -> None:
        show = screen.app.drive.show_state
        self._stands_at = time.monotonic()

        def counted(now: DisplayState) -> None:
            self.drawn += 1
            show(now)

        monkeypatch.setattr(screen.app.drive, "show_state", counted)

    async def after(self, seconds: float, screen: Console) -> int:
        """Return how often it has drawn after this time and two renewals of the lease."""
        assert self._stands_at is not None
        self._stands_at += seconds
        renewals = len(screen.station.of(RenewLease))
        await until(lambda: len(screen.station.of(RenewLease)) > renewals + 2)
        return self.drawn


async def test_without_a_snapshot_an_armed_vehicle_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    beats = Beats()
    async with console(clock=beats.clock) as screen:
        beats.count(screen, monkeypatch)
        assert await beats.after(1.0, screen) == 1
        assert await beats.after(WITHOUT_SNAPSHOT / 2, screen) == 1
        assert await beats.after(WITHOUT_SNAPSHOT, screen) == 2


async def test_at_rest_it_draws_seldom_but_what_changes_here_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    beats = Beats()
    async with console(picture=DISARMED, clock=beats.clock) as screen:
        beats.count(screen, monkeypatch)
        assert await beats.after(1.0, screen) == 1
        assert await beats.after(AT_REST / 2, screen) == 1
        assert await beats.after(AT_REST, screen) == 2
        screen.app.post_message(events.AppBlur())
        await until(lambda: screen.app.gate.closure is not None)
        assert await beats.after(WITHOUT_SNAPSHOT + 0.01, screen) == 3
        assert "focus" in screen.text


async def test_a_dead_station_is_said() -> None:
    async with console() as screen:
        screen.station.alive = False
        await until(lambda: "station process ended" in screen.text)
        assert screen.station.of(SetKeyGate)[-1].reason == "the station has ended"


async def test_station_that_does_not_respond_closes_the_gate_meanwhile() -> None:
    text = "station not responding: neutral is sent to Rover 1"
    async with console(picture=snapshot()) as screen:
        await until(lambda: screen.app.gate.closure is None)
        screen.station.outage = StationOutage(text)
        screen.station.offer(snapshot())
        await until(lambda: text in screen.text and "station lost" in screen.text)
        assert screen.station.of(SetKeyGate)[-1].reason == "the station does not respond"
        assert Stop("the station does not respond") in screen.station.intents
        screen.station.outage = StationOutage()
        screen.station.offer(snapshot())
        await until(lambda: text not in screen.text)
        assert screen.station.of(SetKeyGate)[-1].open


async def test_a_beat_after_the_screens_are_gone_is_no_fault() -> None:
    # Textual takes the screens down before it stops the timers.
    async with console() as screen:
        app = screen.app
    assert not app.screen_stack
    app._tick()


LEAVES = snapshot(left_armed=("Rover 1 is left ARMED in MANUAL",))


@pytest.mark.parametrize("key", ["ctrl+q", "ctrl+c"])
async def test_quitting_disarms_first_and_a_second_key_leaves_it_armed(key: str) -> None:
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
