"""What a shell asks a running station for to complete a word: one request, one answer, and the connection ends."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable

import msgspec

from groundstation.station_socket.connect import NoStationError, connect
from groundstation.station_socket.folder import FolderError, list_sockets
from groundstation.station_socket.hello import NAMES, Hello, encode

VERSION = 1
"""Of the answer below."""

PARAMS, MODES, VEHICLES = "params", "modes", "vehicles"
KINDS = (PARAMS, MODES, VEHICLES)
"""What names there are; a Hello has one as its name."""

ANSWER_WITHIN = 0.05
"""s for all stations to answer: a key in a shell waits for it, and the start of Python takes as long again."""

MAX_ANSWER = 1 << 17
"""Bytes of the largest answer: 5000 parameters have 90 kB."""


PLAIN_NAME = "[A-Za-z0-9][A-Za-z0-9_.:-]*"
"""The names that are proposed, as a regular expression that all three shells read alike. Vehicles choose their names,
also hostile ones: what a shell puts into the command line could be expanded, executed or taken for an option there. Who
wants another name types it, in quotes."""

_is_plain = re.compile(PLAIN_NAME, re.ASCII).fullmatch


class Names(msgspec.Struct, frozen=True, tag=True):
    """From the station, first and last."""

    names: tuple[str, ...]


encode_names = encode
_decode = msgspec.msgpack.Decoder(Names).decode


def plain_names(names: Iterable[str]) -> list[str]:
    """Return the names that may be proposed to complete a word, in their order."""
    return [name for name in names if _is_plain(name)]


def find_names(kind: str, within: float = ANSWER_WITHIN) -> list[str]:
    """Return the plain names that the running stations of this user know; none if no station answers in `within` s."""
    deadline = time.monotonic() + within
    try:
        pids = [pid for pid, _ in list_sockets()]
    except FolderError:
        return []
    return sorted({name for pid in pids for name in plain_names(_ask(pid, kind, deadline - time.monotonic()))})


def _ask(pid: int, kind: str, within: float) -> tuple[str, ...]:
    """Return the names that one station knows."""
    if within <= 0:
        return ()
    try:
        with connect(pid, Hello(NAMES, VERSION, kind), within) as sock:
            return _decode(sock.recv(MAX_ANSWER)).names
    except (NoStationError, FolderError, OSError, msgspec.DecodeError):
        return ()
