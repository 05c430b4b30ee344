"""The file with what one run keeps for the next: the time of the signing clock and the streams. It holds no secret."""

from __future__ import annotations

from pathlib import Path

import msgspec

from link.runtime.whole_file import PRIVATE, replace_file
from link.signing.signature import STAMP_MAX
from link.signing.signing import SigningMemory
from link.signing.streams import MAX_SPANS, MAX_STREAMS, SignedStream, Span

FILE = "signing.json"
"""Name of the file, beside the key file."""
MAX_SIZE = 64 * 1024
"""Bytes of a file that is read: ten times what the most streams need."""


class MemoryFileError(Exception):
    """The file cannot be used. The text is one line: file, error, remedy."""


class _Content(msgspec.Struct, forbid_unknown_fields=True):
    stamp: int
    streams: list[tuple[str, int, int, int, int]]
    """Fingerprint, system, component, link id, newest timestamp."""
    floors: dict[str, int]
    ended: bool = False
    spans: list[tuple[str, int, int]] = []
    """Fingerprint, and the timestamps after and until which nothing is accepted. Files of older programs have none."""


def load_memory(path: Path) -> SigningMemory:
    """Return what the last run kept; nothing if there is no file. Raises MemoryFileError."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_SIZE)
    except FileNotFoundError:
        return SigningMemory()
    except OSError as error:
        raise MemoryFileError(f"{path}: {error.strerror}; run this as the user whose file this is") from error
    try:
        content = msgspec.json.decode(data, type=_Content)
    except (msgspec.DecodeError, UnicodeDecodeError):
        raise MemoryFileError(f"{path}: damaged; remove it, once the computer's clock is right") from None
    stamps = [content.stamp, *content.floors.values(), *(row[4] for row in content.streams)]
    stamps += [stamp for row in content.spans for stamp in row[1:]]
    if not all(0 <= stamp <= STAMP_MAX for stamp in stamps) or not _fits(content):
        raise MemoryFileError(f"{path}: damaged; remove it, once the computer's clock is right")
    newest, spans = (
        {SignedStream(*row[:4]): row[4] for row in content.streams},
        tuple(Span(*row) for row in content.spans),
    )
    return SigningMemory(content.stamp, newest, content.floors, spans, content.ended)


def save_memory(path: Path, memory: SigningMemory) -> None:
    """Write the file, whole and for its user only. Raises OSError."""
    rows = [(*stream, stamp) for stream, stamp in memory.newest.items()]
    content = _Content(memory.stamp, rows, dict(memory.floors), memory.ended, list(memory.spans))
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    replace_file(path, msgspec.json.encode(content), mode=PRIVATE, durable=True, folders_owner=True)


def _fits(content: _Content) -> bool:
    return len(content.streams) <= MAX_STREAMS and len(content.spans) <= MAX_SPANS
