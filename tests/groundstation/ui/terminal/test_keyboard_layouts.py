"""Keyboards with a Cyrillic or Greek layout, and Caps Lock, through a real pseudo-terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress

import pytest

from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.vehicle import Arm
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.terminal.key_parser import find_latin_sequence
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui import frames
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.ptys import Terminal, app_on_a_pty
from tests.waits import PATIENCE, until

TRY = 3.0
"""s for a hint to show, which takes milliseconds."""
PRESS_KA, REPEAT_KA, RELEASE_KA = "\x1b[1082::114;1:1;1082u", "\x1b[1082::114;1:2;1082u", "\x1b[1082::114;1:3u"
"""The key R of a Cyrillic layout in the kitty keyboard protocol."""


async def type_until_shown(app: ConsoleApp, terminal: Terminal, typed: str, wanted: str) -> None:
    """Type it again where it is not shown: while a late machine has closed the gate, a key has no hint."""
    await until(lambda: "hold i to drive" in frames.text(app))
    for _ in range(round(PATIENCE / TRY)):
        terminal.type(typed)
        with suppress(TimeoutError):
            await until(lambda: wanted in frames.text(app), TRY)
            return
    raise TimeoutError(f"not shown: {wanted}\n{frames.text(app)}")


async def test_a_cyrillic_layout_arms_drives_opens_help_and_quits() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        station.offer(snapshot(vehicle=vehicle(armed=False)))
        await _arm(app, terminal, lambda: station.of(Arm))
        terminal.type("\x1b[1096::105;1:1;1096u\x1b[1096::105;1:3u")
        await until(lambda: [push.key for push in station.of(DriveKeyDown)] == ["i"])
        terminal.type("\x1b[1081::113;5:1u")
        await until(lambda: not app.is_running)


async def _arm(app: ConsoleApp, terminal: Terminal, armed: Callable[[], object]) -> None:
    """Hold the key; on a machine that is late release it and hold it again."""
    while not armed():
        keys = iter([PRESS_KA])

        async def press(keys: Iterator[str] = keys) -> None:
            terminal.type(next(keys, REPEAT_KA))

        await hold_until(press, lambda: armed() or app.gate.hold is None)
        terminal.type(RELEASE_KA)


async def test_caps_lock_does_not_matter_where_the_terminal_reports_it() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type("\x1b[119:87;65:1;87u")
        await until(lambda: [push.key for push in station.of(DriveKeyDown)] == ["w"])


@pytest.mark.parametrize(
    ("typed", "hint"),
    [
        ("W", "W is not bound, w is Forward: is Caps Lock on?"),
        ("R", "R is not bound, r is Arm: is Caps Lock on?"),
        ("ц", "ц is not bound: switch to a Latin keyboard layout"),
        ("\x1b[1094;1:1;1094u", "ц is not bound: switch to a Latin keyboard layout"),
    ],
)
async def test_a_letter_without_effect_is_explained_until_the_next_key(typed: str, hint: str) -> None:
    async with app_on_a_pty() as (app, station, terminal):
        station.offer(snapshot())
        await type_until_shown(app, terminal, typed, hint)
        terminal.type("1")
        await until(lambda: hint not in frames.text(app))
        assert not station.of(DriveKeyDown)


@pytest.mark.parametrize("typed", ["Z", "5", "\x1b[15~"])
async def test_other_keys_have_no_hint(typed: str) -> None:
    async with app_on_a_pty() as (app, station, terminal):
        station.offer(snapshot())
        await type_until_shown(app, terminal, "W", "Caps Lock")
        terminal.type(typed)
        await until(lambda: "Caps Lock" not in frames.text(app))
        assert " is not bound" not in frames.text(app)


@pytest.mark.parametrize(
    ("arguments", "sequence"),
    [
        (("1082", "::114", "", "u"), "\x1b[114;1;114u"),
        (("1050", ":1050:114", "2", "u"), "\x1b[114;2;82u"),
        (("1081", "::113", "5", "u"), "\x1b[113;5u"),
        (("1081", "::113", "69", "u"), "\x1b[113;5u"),
        (("1081", "::113", "0", "u"), "\x1b[113;1;113u"),
        (("119", ":87", "65", "u"), "\x1b[119;1;119u"),
        (("119", ":87", "66", "u"), "\x1b[119;2;87u"),
        (("97", "::113", "", "u"), None),  # AZERTY: a is printed on the key in Q's place
        (("49", ":33", "65", "u"), None),
        (("1082", "", "", "u"), None),
        (("1082", "::1082", "", "u"), None),
        (("1082", "::7", "", "u"), None),
        (("1082", "::99999999999999", "", "u"), None),
        (("99999999", "::114", "", "u"), None),
        (("1", "", "65", "A"), None),
    ],
)
def test_the_same_key_of_a_latin_keyboard(arguments: tuple[str, str, str, str], sequence: str | None) -> None:
    assert find_latin_sequence(*arguments) == sequence
