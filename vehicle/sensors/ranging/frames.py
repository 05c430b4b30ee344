"""Frames of fixed length in the bytes of a serial port, each with a head and a check."""

from __future__ import annotations

from collections.abc import Callable


def split_frames(
    buffer: bytes, head: bytes, length: int, is_valid: Callable[[bytes], bool]
) -> tuple[list[bytes], bytes]:
    """Return the valid frames in order, and the bytes that may be the begin of the next one.

    Behind a frame whose check is wrong the search goes on one byte later: its head may have been data.
    """
    frames = []
    while (at := buffer.find(head)) >= 0 and len(buffer) >= at + length:
        frame = buffer[at : at + length]
        if is_valid(frame):
            frames.append(frame)
            buffer = buffer[at + length :]
        else:
            buffer = buffer[at + 1 :]
    return frames, buffer[-length:]
