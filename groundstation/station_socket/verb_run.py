"""What a shell and the station that runs its verb say to each other: the words of the verb, and what it prints.

The verb runs in the process of the station, with the code, the links and the session of the station. The shell reads
the command line, prints, reads and writes the files of the user, and says ten times a second that it is there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec

from groundstation.station_socket.hello import StationFailed

VERSION = 8
"""Of the packets below."""

MAX_PRINTED = 1 << 18
"""Bytes of the largest packet, each way."""

PIECE = 1 << 17
"""Bytes of a file in one packet."""

ALIVE_PERIOD = 0.1
"""s between packets of a verb at least, as of a screen."""

ALIVE_WITHIN = 0.3
"""s without a packet after which a verb that demands motion counts as dead."""

KEEP = 30.0
"""s after the end of a verb for which the next one has its session: our vehicle disarms when nobody has driven it for
that time (FS_DISARM_T)."""

STILL_WITHIN = 1.0
"""s without a packet after which a shell counts as standing still, as after Ctrl-Z. Its verb
stands still, too, so that the vehicle misses its ground station as if the verb ran in the shell."""


class VerbReady(msgspec.Struct, frozen=True, tag=True):
    """From the station, first."""

    endpoints: tuple[str, ...]


class Alive(msgspec.Struct, frozen=True, tag=True):
    """From the station: the answer to a packet that only asks. A station that hangs does not send it."""


class Printed(msgspec.Struct, frozen=True, array_like=True):
    """One call of a method of Output (verbs/common/output.py)."""

    method: str
    arguments: tuple[Any, ...] = ()
    fields: dict[str, Any] = {}


class VerbOutput(msgspec.Struct, frozen=True, tag=True):
    """From the station: what the verb prints."""

    printed: tuple[Printed, ...]


class VerbEnded(msgspec.Struct, frozen=True, tag=True):
    """From the station, last: the verb has ended."""

    code: int
    """Its exit code."""
    vehicle: str = ""
    """Name of the vehicle that was found."""


class AskedGroup(msgspec.Struct, frozen=True, array_like=True):
    """The vehicles of --all or --group, as the config file of the shell names them (config/groups.py)."""

    listed: frozenset[int]
    others: frozenset[int]
    patterns: tuple[str, ...]


class RunVerb(msgspec.Struct, frozen=True, tag=True):
    """From the shell, first: the command line."""

    words: tuple[str, ...]
    group: AskedGroup | None = None
    given: Any = None
    """What the verb's `prepare` returned."""
    dialect: str = ""
    """Fingerprint of the file of --dialect, which the station must have, too; "": none."""


class StillHere(msgspec.Struct, frozen=True, tag=True):
    """From the shell: its process runs. The station answers with Alive."""


class CancelVerb(msgspec.Struct, frozen=True, tag=True):
    """From the shell: its user has interrupted the verb, which ends in order. So does the end of the connection."""


class FileAsked(msgspec.Struct, frozen=True, tag=True):
    """From the station: work on a file of the user. The shell answers each with FileAnswered."""

    number: int
    """The same for all pieces of one file."""
    work: str = ""
    """A value of FileWork (verbs/common/files.py); "": the next piece of what was read."""
    path: str = ""
    """As the user has typed it."""
    data: bytes = b""
    """What to write, or a piece of it."""
    whole: bool = True
    """No piece of it follows."""
    overwrite: bool = False


class FileAnswered(msgspec.Struct, frozen=True, tag=True):
    """From the shell: the work is done, or the piece has arrived."""

    number: int
    data: bytes = b""
    """What was read, or a piece of it."""
    whole: bool = True
    """No piece of it follows."""
    error: str = ""
    """One line for the user: why it was not done."""


class ToCompanion(msgspec.Struct, frozen=True, tag=True):
    """From the station: a value of the verb for its companion (verbs/common/channel.py), or a piece of it."""

    data: bytes
    """msgpack."""
    whole: bool = True
    """No piece of it follows."""


class FromCompanion(msgspec.Struct, frozen=True, tag=True):
    """From the shell: a value of the companion for its verb, likewise."""

    data: bytes
    whole: bool = True


class CompanionEnded(msgspec.Struct, frozen=True, tag=True):
    """From the shell: the companion has ended before its verb."""

    code: int = 0
    line: str = ""
    """How it has failed; "": in order."""


ToShell = VerbReady | VerbOutput | VerbEnded | Alive | StationFailed | FileAsked | ToCompanion
FromShell = RunVerb | StillHere | CancelVerb | FileAnswered | FromCompanion | CompanionEnded

encode = msgspec.msgpack.Encoder().encode
decode_from_station = msgspec.msgpack.Decoder(ToShell).decode
decode_from_shell = msgspec.msgpack.Decoder(FromShell).decode


def split(value: Any) -> Iterator[tuple[bytes, bool]]:
    """Yield a value as the pieces of packets, and whether each is the last one."""
    data = encode(value)
    for at in range(0, len(data), PIECE):
        yield data[at : at + PIECE], at + PIECE >= len(data)
