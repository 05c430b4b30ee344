"""ASCII in place of boxes, bars and braille; and a real terminal that gets nothing else."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from groundstation.ui.look.appearance import Look
from groundstation.ui.look.ascii import to_ascii
from tests.groundstation.ui.ptys import app_on_a_pty
from tests.waits import until


@given(st.text())
def test_every_text_becomes_ascii_of_the_same_width(text: str) -> None:
    made = to_ascii(text)
    assert made.isascii()
    assert len(made) == sum(1 if ord(each) < 0x80 else cell_len(each) for each in text)


@pytest.mark.parametrize(
    ("drawn", "shown"),
    [
        ("╭─╮│╰─╯", "+-+|+-+"),
        ("█▌░│", "##-|"),
        ("⠀⠁⠉⣿", " ..*"),
        ("key→motor ×3 · ok", "key>motor x3 . ok"),
        ("ü漢", "???"),
    ],
)
def test_what_stands_for_what(drawn: str, shown: str) -> None:
    assert to_ascii(drawn) == shown


@pytest.mark.parametrize("ascii_only", [True, False])
async def test_a_terminal_gets_no_other_byte(ascii_only: bool) -> None:
    async with app_on_a_pty(look=Look(ascii=ascii_only)) as (app, _, terminal):
        terminal.type("\x1b[17~")
        await until(lambda: app.screen is not app.drive)
        terminal.type("\x1b")
        await until(lambda: app.screen is app.drive)
        terminal.type("\x10")
        await until(lambda: app.screen is not app.drive)
        await until(lambda: terminal.drawn.count(b"\x1b[5n") > 2)
    assert bytes(terminal.drawn).isascii() is ascii_only
