"""How a terminal can show pictures, found by asking it, and by its environment for colours.

Asked are kitty graphics (https://sw.kovidgoyal.net/kitty/graphics-protocol/, "Querying support"), the size of a cell
(XTWINOPS 16) and the primary device attributes (DA1), of which 4 is sixel. Every terminal answers DA1, and in order, so
its answer is the end of all answers.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import StrEnum


class Protocol(StrEnum):
    """A way to draw a picture."""

    KITTY = "kitty"
    SIXEL = "sixel"
    BLOCKS = "blocks"
    """Half blocks in true colour."""
    BLOCKS_256 = "256"
    BLOCKS_16 = "16"
    ASCII = "ascii"


QUERY = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[16t\x1b[c"
ANSWER_WITHIN = 1.0
"""s for the answers, over SSH as well; a terminal that answers nothing gets half blocks."""

TRUE_COLOUR_TERMS = ("kitty", "ghostty", "foot", "alacritty", "wezterm", "contour", "direct")
"""Parts of TERM of terminals with true colour; SSH passes TERM on, but not COLORTERM."""

DEFAULT_CELL = (8, 16)
"""Pixels of a cell of a terminal that does not tell."""
MAX_CELL = 200
"""Pixels; a terminal that claims more is not believed."""

_KITTY = re.compile(r"\x1b_G[^;]*;OK\x1b\\")
_ATTRIBUTES = re.compile(r"\x1b\[\?([\d;]*)c")
_CELL = re.compile(r"\x1b\[6;(\d{1,4});(\d{1,4})t")
_SIXEL = "4"


class TerminalAnswers:
    """What a terminal has answered to QUERY."""

    def __init__(self) -> None:
        self.kitty = self.sixel = False
        self.complete = False
        """The answer to the last question has come."""
        self.cell = DEFAULT_CELL
        """Width and height in pixels."""

    def handle(self, answer: str) -> None:
        """Handle one whole sequence; what is no answer to QUERY changes nothing."""
        if _KITTY.fullmatch(answer):
            self.kitty = True
        elif found := _ATTRIBUTES.fullmatch(answer):
            self.sixel, self.complete = _SIXEL in found[1].split(";"), True
        elif (found := _CELL.fullmatch(answer)) and 0 < int(found[1]) <= MAX_CELL and 0 < int(found[2]) <= MAX_CELL:
            self.cell = (int(found[2]), int(found[1]))


def choose_protocol(
    answers: TerminalAnswers, environment: Mapping[str, str], *, ascii_only: bool, sixel: bool = True
) -> Protocol:
    """Return the best way. `ascii_only`: the terminal or the locale has no half blocks. `sixel`: it may be used.

    tmux passes no kitty graphics on, even where the terminal around it has them; sixel it draws itself, if it says so.
    """
    term = environment.get("TERM", "")
    if ascii_only or environment.get("NO_COLOR") or term == "dumb":
        return Protocol.ASCII
    if answers.kitty and not environment.get("TMUX"):
        return Protocol.KITTY
    if answers.sixel and sixel:
        return Protocol.SIXEL
    if environment.get("COLORTERM") in ("truecolor", "24bit") or any(each in term for each in TRUE_COLOUR_TERMS):
        return Protocol.BLOCKS
    return Protocol.BLOCKS_256 if "256" in term else Protocol.BLOCKS_16
