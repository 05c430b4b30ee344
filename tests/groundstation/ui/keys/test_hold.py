"""A key that is held to confirm, through a real pseudo-terminal; and text, which never confirms."""

from __future__ import annotations

import pytest

from groundstation.intents.vehicle import Arm, Disarm
from groundstation.ui.keys.key_gate import KeyGate
from groundstation.ui.terminal.key_parser import KeyEventParser
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import STANDARD, app_on_a_pty
from tests.groundstation.ui.sinks import Clock
from tests.groundstation.ui.typing_monkey import PAIRS, corpus, rampage
from tests.waits import until

PRESS_R, REPEAT_R, RELEASE_R = "\x1b[114;1:1;114u", "\x1b[114;1:2;114u", "\x1b[114;1:3u"
"""The key R as a terminal with the kitty keyboard protocol sends it."""


async def test_a_held_key_arms_by_its_auto_repeat() -> None:
    async with app_on_a_pty() as (_, station, terminal):

        async def press() -> None:
            terminal.type("r")

        await hold_until(press, lambda: station.of(Arm))
        await terminal.type_each("r" * 60, 0.03)
        assert len(station.of(Arm)) == 1 or station.of(Arm)[1].held >= 1.0  # a late machine is a release
        assert not station.of(Disarm)


async def test_a_held_key_arms_where_releases_are_reported() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        keys = iter([PRESS_R])

        async def press() -> None:
            terminal.type(next(keys, REPEAT_R))

        await hold_until(press, lambda: station.of(Arm) or app.gate.hold is None)
        while not station.of(Arm):  # a late machine: release it and hold it again
            terminal.type(RELEASE_R)
            keys = iter([PRESS_R])
            await hold_until(press, lambda: station.of(Arm) or app.gate.hold is None)
        await terminal.type_each([REPEAT_R] * 30 + [RELEASE_R], 0.03)
        assert len(station.of(Arm)) == 1
        assert not station.of(Disarm)


async def test_a_reported_release_cancels() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type(PRESS_R)
        await until(lambda: app.gate.hold is not None)
        terminal.type(RELEASE_R)
        await until(lambda: app.gate.hold is None)
        await terminal.type_each([REPEAT_R] * 50, 0.03)
        assert not station.of(Arm)


@pytest.mark.parametrize("text", [PAIRS, "r" * 500, "\x1b[200~" + "r" * 500 + "\x1b[201~"])
async def test_text_in_one_write_does_not_arm(text: str) -> None:
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type(text)
        await terminal.type_each(["y", "-"], 0.3)
        assert not station.of(Arm)


async def test_a_mouse_report_ends_the_hold() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("r")
        await until(lambda: app.gate.hold is not None)
        terminal.type("\x1b[<64;11;12M")
        await until(lambda: app.gate.hold is None)
        assert not station.of(Arm)


async def test_typing_and_pasting_in_the_real_console_does_not_arm() -> None:
    """Twelve seconds of what `python -m tests.groundstation.ui.typing_monkey` does for ten minutes."""
    assert await rampage(12.0, seed=7) == 0


@pytest.mark.parametrize("gap", [0.0, 0.002, 0.02, 0.05, 0.12, 0.3])
def test_documents_and_source_typed_at_any_speed_arm_nothing(gap: float) -> None:
    """In virtual time, through the key parser and the key gate."""
    for size in (1, 2, 7, 100):
        type_documents(gap, size)


def type_documents(gap: float, size: int) -> None:
    """Type the start of the documents and the end of the source, so many characters at a time and so many s apart."""
    station, clock = Recorder(), Clock()
    try:
        gate = KeyGate(station, STANDARD, clock)
        gate.set_closure(None)
        gate.update(armed=False, driving=False)
        parser, text = KeyEventParser(gate, clock=clock), corpus()
        text = text[:3_000] + text[-3_000:]
        for start in range(0, len(text), size):
            clock.now += gap
            parser.feed(text[start : start + size])
        assert not station.of(Arm), size
    finally:
        station.close()
