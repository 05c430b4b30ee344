"""The driver on a real pseudo-terminal, with the real app."""

from __future__ import annotations

import array
import asyncio
import fcntl
import os
import termios
import tty

from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from groundstation.ui.keys.key_gate import GateClosure
from groundstation.ui.terminal.console_driver import PING, ConsoleDriver
from groundstation.ui.terminal.tty_ping import TerminalPing
from tests.groundstation.ui.ptys import PRESS_W, RELEASE_W, REPEAT_W, app_on_a_pty
from tests.waits import until


async def test_a_key_and_its_release_arrive_as_intents() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type(PRESS_W)
        await until(lambda: station.of(DriveKeyDown))
        terminal.type(REPEAT_W + RELEASE_W)
        await until(lambda: station.of(DriveKeyUp))
        assert app.gate.closure is None
        assert [push.repeat for push in station.of(DriveKeyDown)] == [False, True]
        assert station.of(ReportKeyReleases) == [ReportKeyReleases()]


async def test_the_terminal_is_asked_for_releases() -> None:
    async with app_on_a_pty() as (_, _, terminal):
        await until(lambda: b"\x1b[=31;1u\x1b[?u" in terminal.drawn)


async def test_a_stop_in_the_same_read_wins() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        before = len(station.wishes)
        terminal.type("ik")
        await until(lambda: station.of(Stop))
        assert station.wishes[before:] == [Stop()]


async def test_keys_in_one_read_leave_the_help_once_and_no_screen() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("?")
        await until(lambda: app.screen is not app.drive)
        terminal.type("xyzxyz")
        await until(lambda: app.screen is app.drive)
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        assert app.screen is app.drive


async def test_no_key_of_a_thousand_is_lost_at_5_ms_gaps() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        keys = "ij" * 500  # a late machine reads several at once, and three different ones drive nothing
        await terminal.type_each(keys, 0.005)
        await until(lambda: len(station.of(DriveKeyDown)) >= len(keys))
        assert [push.key for push in station.of(DriveKeyDown)] == list(keys)


async def test_no_key_of_a_heap_is_lost() -> None:
    """Of two keys: three different ones in one read are a burst, which drives nothing."""
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type("ij" * 500)
        await until(lambda: len(station.of(DriveKeyDown)) == 1000)


async def test_lost_focus_closes_the_gate_and_stops() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("i\x1b[O")
        await until(lambda: any("focus" in stop.reason for stop in station.of(Stop)))
        await until(lambda: not app.app_focus)  # until then a beat of the loop may open it again
        await until(lambda: station.of(SetKeyGate)[-1].open is False)
        terminal.type("\x1b[I")
        await until(lambda: app.gate.closure is None)


async def test_terminal_without_answers_closes_gate_until_it_answers() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        await until(lambda: app.gate.ping.round_trip is not None)
        terminal.answers = False
        await until(lambda: app.gate.closure == GateClosure("the terminal does not answer"))
        assert station.of(Stop)
        terminal.answers = True
        await until(lambda: app.gate.closure is None)


async def test_a_terminal_that_never_answers_may_drive() -> None:
    async with app_on_a_pty(answers=False) as (app, _, _):
        begun = asyncio.get_running_loop().time()
        await until(lambda: asyncio.get_running_loop().time() > begun + 1.2)
        assert app.gate.closure is None


async def test_the_end_of_the_terminal_is_the_end_of_the_app() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        terminal.hang_up()
        await until(lambda: not app.is_running)
        assert station.of(Stop)
        assert app.return_value == 129


async def test_the_emergency_stop_works_in_the_palette() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("\x10")  # ctrl+p
        await until(lambda: app.screen is not app.drive)
        terminal.type("!")
        await until(lambda: station.of(EmergencyStop))


async def test_the_answer_to_the_last_ping_is_not_left_to_the_shell() -> None:
    async with app_on_a_pty() as (app, _, terminal):
        await until(lambda: app.gate.ping.round_trip is not None)
        terminal.answers = False
        drawn = len(terminal.drawn)
        await until(lambda: PING.encode() in terminal.drawn[drawn:])
        driver = app._driver
        assert isinstance(driver, ConsoleDriver)
        awaits, asked = driver.awaits_answer, list[bool]()

        def answer_at_the_end() -> bool:
            asked.append(awaits())
            if len(asked) == 1:
                terminal.type(b"\x1b[0n")
            return asked[-1]

        driver.awaits_answer = answer_at_the_end
        keyboard = os.dup(driver.fileno)
        app.end()
        await until(lambda: bool(asked))  # within disable_input, which has returned then
        assert asked[0], "it waits for the answer"
        assert unread_bytes(keyboard) == 0
        os.close(keyboard)
        drawn, app.gate.ping = len(terminal.drawn), TerminalPing()
        app._ping()  # timers go on until the app has unmounted
        await until(lambda: b"\x1b[?25h" in terminal.drawn)
        assert PING.encode() not in terminal.drawn[drawn:]


def unread_bytes(descriptor: int) -> int:
    """Return how many bytes the next reader of a terminal gets, line ends or not."""
    tty.setcbreak(descriptor, termios.TCSANOW)
    count = array.array("i", [0])
    fcntl.ioctl(descriptor, termios.FIONREAD, count)
    return count[0]
