"""Coded pictures for tests without ffmpeg: RTP packets of units, and a recording of them beside a log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from groundstation.stream.rtp import START
from groundstation.stream.video_file import encode_unit
from link.services.video_stream import PAYLOAD_TYPE

SPS, PPS, IDR, SLICE = b"\x67\x42\x00\x1e", b"\x68\xce\x38\x80", b"\x65", b"\x41"
PAYLOAD = 900


def unit_of(number: int, *, key: bool, size: int = 50) -> list[bytes]:
    """Return the NAL units of a picture, which tell its number."""
    body = bytes([number % 120 + 8]) * size
    return [SPS, PPS, IDR + body] if key else [SLICE + body]


def annex_b(nals: Sequence[bytes]) -> bytes:
    return b"".join(START + nal for nal in nals)


def packets(nals: Sequence[bytes], number: int, time: int, *, source: int = 7) -> Iterator[bytes]:
    """Yield the packets of a picture: parameter sets together in STAP-A, large units in FU-A."""
    parts: list[bytes] = []
    small = [nal for nal in nals if len(nal) < 8]
    if small:
        parts.append(b"\x78" + b"".join(len(nal).to_bytes(2, "big") + nal for nal in small))
    for nal in nals[len(small) :]:
        if len(nal) <= PAYLOAD:
            parts.append(nal)
            continue
        pieces = [nal[at : at + PAYLOAD] for at in range(1, len(nal), PAYLOAD)]
        for index, piece in enumerate(pieces):
            bits = (index == 0) << 7 | (index == len(pieces) - 1) << 6
            parts.append(bytes([nal[0] & 0xE0 | 28, bits | nal[0] & 0x1F]) + piece)
    for index, part in enumerate(parts):
        marker = (index == len(parts) - 1) << 7
        head = bytes([0x80, marker | PAYLOAD_TYPE]) + ((number + index) & 0xFFFF).to_bytes(2, "big")
        yield head + time.to_bytes(4, "big") + source.to_bytes(4, "big") + part


def write_video(path: Path, begin: int, count: int, *, period: int = 66_667, key_each: int = 15) -> list[bytes]:
    """Write a recording of pictures from a Unix time on, us. Returns the units."""
    units = [annex_b(unit_of(number, key=number % key_each == 0)) for number in range(count)]
    data = [
        encode_unit(begin + number * period, unit, key=number % key_each == 0, stamped=False)
        for number, unit in enumerate(units)
    ]
    path.write_bytes(b"".join(data))
    return units
