"""What a station must be given so that it shows the state at the start of an interval."""

from __future__ import annotations

import heapq
from bisect import bisect_left
from collections.abc import Iterable, Iterator

from dialects import messages as m
from groundstation.replay.log_index import LogIndex
from link.tlog.scan import LogFrame, id_of

TRACK = 200
"""Positions from before, one of each interval: the track on the map."""

TEXTS = 150
"""Texts from before."""

MAX_FRAMES = 4000
"""Frames in all; a station reads them in 0.2 s."""

_TRACKED = {m.GlobalPositionInt.id, m.LocalPositionNed.id, m.VfrHud.id}


def state_before(index: LogIndex, number: int) -> Iterator[tuple[float, LogFrame]]:
    """Yield times and frames from before an interval, in the order of the file.

    HEARTBEATs go first, at time 0: without them a station does not know the vehicles that the others are from.
    """
    start = index.starts[number]
    places: set[int] = set()
    first: list[int] = []
    for key, offsets in index.places.items():
        if at := bisect_left(offsets, start):
            count = TRACK if id_of(key) in _TRACKED else 1
            places.update(offsets[max(0, at - count) : at])
            if id_of(key) == m.Heartbeat.id:
                first.append(offsets[at - 1])
    places.update(index.findings.kept_before(start, TEXTS))
    places.update(index.findings.params_before(start))
    yield from ((0.0, frame) for frame in _read(index, first))
    latest = index.times[number]
    for frame in _read(index, heapq.nlargest(MAX_FRAMES, places)):
        yield min(latest, index.clock.elapsed(frame.at, frame.stamp)), frame


def _read(index: LogIndex, offsets: Iterable[int]) -> Iterator[LogFrame]:
    for offset in sorted(offsets):
        frame = index.read_frame(offset)
        if frame is not None:
            yield frame
