"""Every escape sequence that terminals are known to send."""

from __future__ import annotations

from collections.abc import Iterator

from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual.keys import Keys

KITTY_KEYS = {"1": 49, "2": 50, "i": 105, "m": 109, "comma": 44, "tab": 9, "enter": 13, "bracket": 91, "F6": 57369}
"""Codes of keys that mean something on the Drive screen."""

STOPS = {
    "F9": "\x1b[20~",
    "F9 with modifier": "\x1b[20;1:1~",
    "kitty space": "\x1b[32;1:1;32u",
    "kitty !": "\x1b[33;2:1;33u",
    "kitty k": "\x1b[107;1:1;107u",
    "kitty ^k": "\x1b[107;5u",
}
"""Sequences of stop keys."""

ANSWERS = {
    "pong": "\x1b[0n",
    "flags of the keyboard": "\x1b[?31u",
    "mode": "\x1b[?2026;2$y",
    "mode, echoed": "\x1b[?2048$p",
    "device attributes": "\x1b[?62;1;4;22c",
    "secondary device attributes": "\x1b[>1;5802;0c",
    "cursor position": "\x1b[12;41R",
    "size of the window": "\x1b[48;24;80;480;800t",
    "size of a cell": "\x1b[6;20;10t",
    "colour of the background": "\x1b]11;rgb:1111/2222/3333\x1b\\",
    "colour, with BEL": "\x1b]11;rgb:1111/2222/3333\x07",
    "name of the terminal": "\x1bP>|XTerm(370)\x1b\\",
    "kitty graphics": "\x1b_Gi=31;OK\x1b\\",
}

MOUSE = {
    "wheel up": "\x1b[<64;11;12M",
    "release": "\x1b[<0;111;2m",
    "negative column": "\x1b[<0;-1;2M",
    "X10": "\x1b[M`ir",
    "urxvt": "\x1b[96;11;12M",
}

FOCUS = {"focus in": "\x1b[I", "focus out": "\x1b[O"}

PASTE = {"paste": "\x1b[200~1i[\x1b[201~", "paste with a colour": "\x1b[200~a\x1b[31m1m,i[ ir tab 1 2 3 iiii\x1b[201~"}

OTHERS = {
    "Alt 1": "\x1b1",
    "Alt i": "\x1bi",
    "Alt comma": "\x1b,",
    "unknown": "\x1b[99;7Z",
    "F20": "\x1b[34~",
    "keypad": "\x1bOj",
}


def every_sequence() -> dict[str, str]:
    """Return name -> sequence. Those of the stock parser have their own text as the name."""
    table = {repr(each): each for each in ANSI_SEQUENCES_KEYS if each[0] == "\x1b" and each[1:2] not in ("", "\x1b")}
    return table | dict(_kitty()) | STOPS | ANSWERS | MOUSE | FOCUS | PASTE | OTHERS


def is_stop(sequence: str) -> bool:
    """Return whether it is the sequence of a key that stops."""
    return sequence in STOPS.values() or ANSI_SEQUENCES_KEYS.get(sequence) == (Keys.F9,)


def _kitty() -> Iterator[tuple[str, str]]:
    for name, code in KITTY_KEYS.items():
        for kind in (1, 2, 3):
            text = f";{code}" if kind < 3 and 32 <= code < 127 else ""
            yield f"kitty {name}, event {kind}", f"\x1b[{code};1:{kind}{text}u"
    yield "kitty Cyrillic", "\x1b[1096::105;1:1;1096u"
    yield "kitty up", "\x1b[1;1:1A"
    yield "kitty Alt 1", "\x1b[49;3u"
