"""How long a key counts as held after its last event, on a terminal that does not report key releases.

A held key sends a press, a pause (the repeat delay, 0.25 to 1 s), then repeats every 25 to 92 ms. So there are two
windows: a long one after the press and a short one once the key repeats. Both are learned from this keyboard.
"""

from __future__ import annotations

from collections import deque

import msgspec

PRESS_WINDOW = 0.75
"""Window after a press, s: longer than X11's repeat delay of 0.66 s. Also the longest time that a tap drives, unless
this keyboard has proved that it begins to repeat later."""

PRESS_WINDOW_MAX = 1.1
"""The same for such a keyboard, s: Windows' longest repeat delay (1 s) and JITTER. PRESS_WINDOW would interrupt every
hold once."""

PRESS_WINDOW_MIN = 0.35
"""Least learned window after a press, s: the shortest repeat delay (0.25 s) and 0.1 s of network jitter."""

REPEAT_WINDOW = 0.20
"""Window once a key repeats, s: two gaps of the slowest console (kbdrate, 92 ms)."""

REPEAT_WINDOW_MIN, REPEAT_WINDOW_MAX = 0.12, 0.25
"""Clamps of the learned window, s: three gaps of 40 ms; and what ssh needs, half of the vehicle's own 0.5 s."""

REPEAT_GAP = 0.12
"""Events of a key closer than this are repeats and not taps, s: a person does not tap 9 times a second."""

JITTER = 0.10
"""Added to a learned delay, s; 60 ms of network jitter was measured to need it."""


SHORTEST_DELAY, LONGEST_DELAY = 0.2, 1.1
"""Repeat delays that exist, s (Linux console 0.25, Windows up to 1.0). Two taps may look like one: a third event within
REPEAT_GAP decides."""

PROOF = 5
"""Repeats in a row that prove a delay above PRESS_WINDOW: a longer window means a longer drive after a tap, and three
quick taps must not cause it."""

GAPS_TO_LEARN = 20
"""Repeats seen before the short window is changed: one second of holding."""


class KeyTrace(msgspec.Struct):
    """Times of the events of one key, from its press on."""

    pressed: float
    seen: float
    """Time of the newest event."""
    delay: float | None = None
    """From the press to the second event, s."""
    repeats: int = 0
    """Consecutive events with the timing of repeats."""

    @property
    def repeating(self) -> bool:
        """The key is certainly held."""
        return self.repeats > 0


class RepeatWindows(msgspec.Struct):
    """The two windows, learned in this session from the newest events: a user may change keyboards."""

    _delays: deque[float] = msgspec.field(default_factory=lambda: deque(maxlen=5))
    _gaps: deque[float] = msgspec.field(default_factory=lambda: deque(maxlen=GAPS_TO_LEARN))

    @property
    def press_window(self) -> float:
        """Window after a press, s."""
        if not self._delays:
            return PRESS_WINDOW
        longest = max(self._delays)
        limit = PRESS_WINDOW if longest <= PRESS_WINDOW else PRESS_WINDOW_MAX
        return min(max(1.15 * longest + JITTER, PRESS_WINDOW_MIN), limit)

    @property
    def repeat_window(self) -> float:
        """Window once a key repeats, s."""
        if len(self._gaps) < GAPS_TO_LEARN:
            return REPEAT_WINDOW
        return min(max(2.5 * max(self._gaps), REPEAT_WINDOW_MIN), REPEAT_WINDOW_MAX)

    @staticmethod
    def start_press(earlier: KeyTrace | None, now: float) -> KeyTrace:
        """Begin a press. `earlier` is the key's previous one, which may have timed out before its first repeat."""
        if earlier is not None and earlier.delay is None and now - earlier.pressed < LONGEST_DELAY:
            return KeyTrace(pressed=earlier.pressed, seen=now, delay=now - earlier.pressed)
        return KeyTrace(pressed=now, seen=now)

    def record_repeat(self, trace: KeyTrace, now: float) -> float:
        """Record a further event of a held key. Returns the window for which it now counts as held, s."""
        gap, trace.seen = now - trace.seen, now
        if trace.delay is None or not (trace.repeating or gap <= REPEAT_GAP):
            trace.delay = gap  # what was taken for the first repeat was a separate press
            return self.repeat_window
        trace.repeats += 1
        if (
            trace.repeats == (1 if trace.delay <= PRESS_WINDOW else PROOF)
            and SHORTEST_DELAY <= trace.delay <= LONGEST_DELAY
        ):
            self._delays.append(trace.delay)
        self._gaps.append(gap)
        return self.repeat_window
