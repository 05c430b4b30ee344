"""How pictures are drawn, by what terminals answer: bytes of real ones."""

from __future__ import annotations

import pytest

from groundstation.pictures.protocol import DEFAULT_CELL, Protocol, TerminalAnswers, choose_protocol

KITTY = ("\x1b_Gi=31;OK\x1b\\", "\x1b[6;18;9t", "\x1b[?62;c")
FOOT = ("\x1b[6;17;8t", "\x1b[?62;4;22;29c")
XTERM = ("\x1b[?64;1;2;6;9;15;16;17;18;21;22;28c",)
XTERM_340 = ("\x1b[6;13;6t", "\x1b[?63;1;2;4;6;9;15;16;17;18;21;22;28c")
TMUX = ("\x1b[?1;2c",)
KONSOLE_REFUSES = ("\x1b_Gi=31;ENOTSUPPORTED:no\x1b\\", "\x1b[?62;1;22c")


@pytest.mark.parametrize(
    ("answers", "environment", "ascii_only", "chosen"),
    [
        (KITTY, {"TERM": "xterm-kitty"}, False, Protocol.KITTY),
        (KITTY, {"TERM": "xterm-kitty", "SSH_CONNECTION": "x"}, False, Protocol.KITTY),
        (KITTY, {"TERM": "xterm-kitty"}, True, Protocol.ASCII),
        (KITTY, {"TERM": "tmux-256color", "TMUX": "x", "COLORTERM": "truecolor"}, False, Protocol.BLOCKS),
        (FOOT, {"TERM": "foot"}, False, Protocol.SIXEL),
        (XTERM_340, {"TERM": "xterm-256color"}, False, Protocol.SIXEL),
        (XTERM, {"TERM": "xterm-256color"}, False, Protocol.BLOCKS_256),
        (XTERM, {"TERM": "xterm-256color", "COLORTERM": "truecolor"}, False, Protocol.BLOCKS),
        (TMUX, {"TERM": "tmux-256color", "TMUX": "x"}, False, Protocol.BLOCKS_256),
        (KONSOLE_REFUSES, {"TERM": "xterm"}, False, Protocol.BLOCKS_16),
        ((), {"TERM": "alacritty"}, False, Protocol.BLOCKS),
        ((), {"TERM": "dumb"}, False, Protocol.ASCII),
        (KITTY, {"TERM": "xterm-kitty", "NO_COLOR": "1"}, False, Protocol.ASCII),
        ((), {}, False, Protocol.BLOCKS_16),
    ],
)
def test_the_best_way_that_a_terminal_has(
    answers: tuple[str, ...], environment: dict[str, str], ascii_only: bool, chosen: Protocol
) -> None:
    found = TerminalAnswers()
    for answer in answers:
        found.handle(answer)
    assert found.complete is bool(answers)
    assert choose_protocol(found, environment, ascii_only=ascii_only) is chosen


def test_the_size_of_a_cell_is_believed_within_bounds() -> None:
    answers = TerminalAnswers()
    for odd in ("\x1b[6;0;9t", "\x1b[6;9999;9t", "\x1b[6;-1;9t", "\x1b[6;18t", "\x1b[4;600;800t"):
        answers.handle(odd)
        assert answers.cell == DEFAULT_CELL
    answers.handle("\x1b[6;18;9t")
    assert answers.cell == (9, 18)
