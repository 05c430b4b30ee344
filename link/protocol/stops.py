"""Stops of senders for whom a channel has no place: stopping a vehicle needs no place, no HEARTBEAT and no control."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dialects import codec
from dialects.messages import Message
from dialects.traits import COMMANDS, is_stop
from link.protocol.frame import Frame


def find_stops(
    frames: Iterable[Frame], own_ids: tuple[int, int], wanted: frozenset[int] | None
) -> Iterator[tuple[Frame, Message]]:
    """Yield the frames that hold a command that only stops, decoded. `wanted`: ids that are handled; None: all."""
    for frame in frames:
        number, system, component, _, raw = frame
        if number not in COMMANDS or not system or (system, component) == own_ids:
            continue
        if wanted is not None and number not in wanted:
            continue
        message = codec.decode_frame(number, raw)
        if is_stop(message):
            yield frame, message
