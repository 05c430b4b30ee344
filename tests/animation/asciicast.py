"""Recordings of a terminal as asciicast v2: what was written to it, and when.

Format: https://docs.asciinema.org/manual/asciicast/v2/. `asciinema play` shows these files.
"""

from __future__ import annotations

from pathlib import Path

import msgspec


class Output(msgspec.Struct, frozen=True):
    """What a program wrote at once."""

    at: float
    """s since the recording began."""
    text: str


class Cast(msgspec.Struct, frozen=True):
    """A recording of a terminal of constant size."""

    width: int
    """Columns."""
    height: int
    """Lines."""
    outputs: tuple[Output, ...]


class _Header(msgspec.Struct):
    version: int
    width: int
    height: int


def write_cast(cast: Cast, file: Path) -> None:
    """Write a recording: a header and a line for each output."""
    rows = [_Header(2, cast.width, cast.height), *([round(each.at, 6), "o", each.text] for each in cast.outputs)]
    file.write_bytes(b"".join(msgspec.json.encode(row) + b"\n" for row in rows))


def read_cast(file: Path) -> Cast:
    """Read a recording. Keys, markers and sizes in it are left out.

    Raises ValueError with file, line and reason if it is not an asciicast v2.
    """
    header: _Header | None = None
    outputs: list[Output] = []
    for number, line in enumerate(file.read_bytes().splitlines(), start=1):
        try:
            if header is None:
                header = _read_header(line)
                continue
            at, kind, text = msgspec.json.decode(line, type=tuple[float, str, str])
        except (msgspec.MsgspecError, ValueError) as error:
            raise ValueError(f"{file}:{number}: not an asciicast v2: {error}") from error
        if kind == "o":
            outputs.append(Output(at, text))
    if header is None:
        raise ValueError(f"{file}: not an asciicast v2: empty")
    return Cast(header.width, header.height, tuple(outputs))


def _read_header(line: bytes) -> _Header:
    header = msgspec.json.decode(line, type=_Header)
    if header.version != 2:
        raise ValueError(f"version {header.version}")
    return header
