"""The moments of a recording that become frames of a picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import TypeVar

import msgspec

from tests.animation.asciicast import Output

BEGIN, END = "\x1b[?2026h", "\x1b[?2026l"
"""Around an update that a terminal shows at once: https://github.com/contour-terminal/vt-extensions"""

Picture = TypeVar("Picture")


class Moment(msgspec.Struct, frozen=True):
    """A frame: what is written before it is shown, and for how long it is shown."""

    text: str
    duration: float
    """s."""


def whole_updates(outputs: Iterable[Output]) -> Iterator[Output]:
    """Join what belongs to one update of the screen, so that no frame shows half of it.

    An update that never ends is left out.
    """
    text = ""
    for output in outputs:
        text += output.text
        begin, end = text.rfind(BEGIN), text.rfind(END)
        if begin <= end:
            yield Output(output.at, text)
            text = ""
        elif end >= 0:
            whole = end + len(END)
            yield Output(output.at, text[:whole])
            text = text[whole:]


def choose_moments(outputs: Iterable[Output], step: float, longest: float, last: float) -> list[Moment]:
    """Return at most one frame in `step` s. None is shown for more than `longest` s, the last one for `last` s."""
    ticks: dict[int, str] = {}
    for output in whole_updates(outputs):
        tick = int(output.at / step)
        ticks[tick] = ticks.get(tick, "") + output.text
    durations = [min((later - tick) * step, longest) for tick, later in pairwise(ticks)]
    return [Moment(text, duration) for text, duration in zip(ticks.values(), [*durations, last], strict=False)]


def merge_equal(frames: Sequence[tuple[Picture, float]]) -> list[tuple[Picture, float]]:
    """Return pictures with their durations, s, without those that are as the one before: that is shown for longer."""
    merged: list[tuple[Picture, float]] = []
    for picture, duration in frames:
        if merged and merged[-1][0] == picture:
            merged[-1] = (picture, merged[-1][1] + duration)
        else:
            merged.append((picture, duration))
    return merged
