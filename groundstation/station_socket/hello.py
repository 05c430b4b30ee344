"""The first packets on a connection to a running station: what a program is, and what the station answers."""

from __future__ import annotations

import msgspec

SCREEN, VERB, NAMES, ABOUT = "screen", "verb", "names", "about"
"""Kinds of programs."""

MAX_HELLO = 4096
"""Bytes of the largest first packet."""

HELLO_WITHIN = 2.0
"""s for the first packet of a program, and for the answer of the station."""


class Hello(msgspec.Struct, frozen=True):
    """From the program, first."""

    kind: str
    version: int
    """Of what this kind of program says and understands afterwards."""
    name: str = ""
    """What the other programs call it, e.g. "screen on pts/4"."""
    watches: bool = False
    """Of a screen: it does not drive unless its operator asks to, also where no other screen does."""
    follows: bool = False
    """Of a verb that looks: it keeps the session going that a verb has used just before."""


class StationFailed(msgspec.Struct, frozen=True, tag=True):
    """From the station, first and last: it could not start, or does not take this program; one line for the user."""

    line: str


encode = msgspec.msgpack.Encoder().encode
decode_hello = msgspec.msgpack.Decoder(Hello).decode
