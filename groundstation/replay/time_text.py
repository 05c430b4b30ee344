"""Times in a log as people write them: `12:04:10` by its clock, `+30` and `-30` from here, `1:23` from its start."""

from __future__ import annotations

import math
import re
from datetime import datetime

from groundstation.replay.log_clock import LogClock

FORMS = "use 12:04:10 (the clock of the log), +30 or -30 (s from here), or 1:23 (from the start)"
DAY = 86_400.0

_NUMBER = re.compile(r"\d+(?:\.\d+)?", re.ASCII)


class TimeError(ValueError):
    """Not a time; the message is one line for the user."""


def parse_time(text: str, clock: LogClock, here: float) -> float:
    """Return the time of the log that `text` means. `here`: the present one, s. Raises TimeError."""
    text = text.strip().removeprefix(":")
    sign = -1 if text.startswith("-") else 1
    parts = text.lstrip("+-").split(":")
    if not text or len(parts) > 3 or not all(_NUMBER.fullmatch(part) for part in parts):
        raise TimeError(f"{text!r} is not a time: {FORMS}")
    seconds = 0.0
    for part in parts:
        seconds = seconds * 60 + float(part)
    if not math.isfinite(seconds):
        raise TimeError(f"{text!r} is not a time: {FORMS}")
    if text[0] in "+-":
        return here + sign * seconds
    return _by_clock(seconds, clock) if len(parts) == 3 else seconds


def _by_clock(seconds: float, clock: LogClock) -> float:
    """Return when the recorded clock showed this time of day, on the first day on which the log has it."""
    first = clock.wall(0.0)
    began = datetime.fromtimestamp(first)
    midnight = first - (began.hour * 3600 + began.minute * 60 + began.second + began.microsecond / 1e6)
    wall = midnight + seconds
    return clock.find_wall(wall if wall >= first - 1 or clock.wall(clock.now) < wall + DAY else wall + DAY)
