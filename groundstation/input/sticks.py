"""Intents and time -> axes: what the held keys ask for now. It falls back to neutral by itself and knows no vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dialects.axes import NEUTRAL, Axes
from groundstation.input.key_repeat import REPEAT_GAP, KeyTrace, RepeatWindows
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from groundstation.intents import DriveKeyDown, ScaleLimits

STEP = 0.1
"""What one press adds in the style "step", of full deflection."""


@dataclass(slots=True)
class _Held:
    """A key that counts as held."""

    throttle: int
    steering: int
    until: float
    """inf where the terminal will tell the release."""
    trace: KeyTrace


class Sticks:
    """The keys as two sticks. Times are of one monotonic clock, s."""

    def __init__(self, style: Style = Style.HOLD, limit: float = 0.6) -> None:
        self.style = style
        self.reports_releases = False
        """The terminal reports releases. Believed from proof only: ExactKeys, a repeat or a release."""
        self.throttle_limit = self.steering_limit = _limit(limit)
        self._windows = RepeatWindows()
        self._last_event = -math.inf
        self._held: dict[str, _Held] = {}
        self._traces: dict[str, KeyTrace] = {}
        self._blocked_until: dict[str, float] = {}
        """Keys that were held when the drive was blocked -> until when their events are still that old press."""
        self._set = NEUTRAL
        """What latch and step stand at; in latch a direction, in step a level."""

    def press(self, push: DriveKeyDown, now: float) -> None:
        """A drive key went down or repeats."""
        if push.repeat:
            self.reports_releases = True
        if not push.throttle and not push.steering:
            return
        if self._is_blocked(push, now):
            return
        if self.style is Style.HOLD:
            self._hold(push, now)
        elif self.style is Style.STEP:
            self._step(push, now)
        elif not push.repeat:
            self._set = Axes(float(push.throttle), float(push.steering))

    def release(self, key: str) -> None:
        """A drive key went up."""
        self.reports_releases = True
        self._held.pop(key, None)
        self._blocked_until.pop(key, None)

    def set_reports_releases(self) -> None:
        """The terminal has shown that it reports releases."""
        self.reports_releases = True

    def stop(self) -> None:
        """Neutral; the next press drives again."""
        self._held.clear()
        self._set = NEUTRAL

    def block(self, now: float) -> None:
        """Neutral, and the keys that are held now must be let go before they drive again."""
        for key, held in self._held.items():
            window = self._windows.repeat_window if held.trace.repeating else self._windows.press_window
            self._blocked_until[key] = now + window
        self.stop()

    def reject(self, push: DriveKeyDown, now: float) -> None:
        """A press while driving is not allowed: it must not drive later either."""
        self._blocked_until[push.key] = now + (
            self._windows.repeat_window if push.key in self._blocked_until else self._windows.press_window
        )

    def scale_limits(self, change: ScaleLimits) -> None:
        """Change the limits. Factors that are not a positive number change nothing."""
        self.throttle_limit = _scaled(self.throttle_limit, change.throttle)
        self.steering_limit = _scaled(self.steering_limit, change.steering)

    def set_style(self, name: str) -> bool:
        """Neutral, and drive in this style from now on. False for an unknown one, which changes no style."""
        self.stop()
        if name == "next":
            self.style = self.style.next
        elif name in set(Style):
            self.style = Style(name)
        else:
            return False
        return True

    def axes(self, now: float) -> Axes:
        """The demand now, within the limits."""
        if self.style is Style.HOLD:
            throttle, steering = self._directions(now)
        elif self.style is Style.LATCH:
            throttle, steering = self._set.throttle, self._set.steering
        else:
            return Axes(
                _within(self._set.throttle, self.throttle_limit), _within(self._set.steering, self.steering_limit)
            )
        return Axes(throttle * self.throttle_limit, steering * self.steering_limit)

    def held_keys(self, now: float) -> tuple[str, ...]:
        """Keys that count as held."""
        self._expire(now)
        return tuple(self._held)

    @property
    def stop_bound(self) -> float:
        """The longest that a demand stands after the key is let go, s: 0 exact, inf where only a key ends it."""
        if self.style is not Style.HOLD:
            return math.inf
        return 0.0 if self.reports_releases else self._windows.press_window

    def _hold(self, push: DriveKeyDown, now: float) -> None:
        self._expire(now)
        self._last_event = now
        held = self._held.get(push.key)
        if held is not None:
            self._extend_hold(held, now)
        elif not push.repeat:  # a repeat of a key that is not down: kitty sends some after a focus change
            self._press(push, now)

    def _press(self, push: DriveKeyDown, now: float) -> None:
        if not self.reports_releases:
            self._drop_rivals(push)
        trace = self._windows.start_press(self._traces.get(push.key), now)
        self._traces[push.key] = trace
        until = math.inf if self.reports_releases else now + self._windows.press_window
        self._held[push.key] = _Held(push.throttle, push.steering, until, trace)
        self._refresh_others(until)

    def _extend_hold(self, held: _Held, now: float) -> None:
        until = now + self._windows.record_repeat(held.trace, now)
        held.until = math.inf if self.reports_releases else until
        self._refresh_others(until)

    def _drop_rivals(self, push: DriveKeyDown) -> None:
        """Without releases a new key on the same stick is the driver's new word: the old one is let go."""
        for key, held in list(self._held.items()):
            if (held.throttle and push.throttle) or (held.steering and push.steering):
                del self._held[key]

    def _refresh_others(self, until: float) -> None:
        """Only the newest key repeats, so its life is all that a timer knows of the keys held with it."""
        for held in self._held.values() if not self.reports_releases else ():
            held.until = max(held.until, until)

    def _expire(self, now: float) -> None:
        # A window that was just learned to be shorter holds for every key: stop_bound is a promise.
        everything = not self.reports_releases and now >= self._last_event + self._windows.press_window
        for key in [key for key, held in self._held.items() if everything or now >= held.until]:
            del self._held[key]

    def _directions(self, now: float) -> tuple[float, float]:
        """Of keys that disagree the newest wins."""
        self._expire(now)
        throttle = steering = 0
        for held in self._held.values():
            throttle = held.throttle or throttle
            steering = held.steering or steering
        return throttle, steering

    def _step(self, push: DriveKeyDown, now: float) -> None:
        earlier = self._traces.get(push.key)
        self._traces[push.key] = KeyTrace(pressed=now, seen=now)
        if push.repeat or (earlier is not None and now - earlier.seen <= REPEAT_GAP):
            return  # a held key is one press
        self._set = Axes(
            _stepped(self._set.throttle, push.throttle, self.throttle_limit),
            _stepped(self._set.steering, push.steering, self.steering_limit),
        )

    def _is_blocked(self, push: DriveKeyDown, now: float) -> bool:
        until = self._blocked_until.pop(push.key, None)
        if until is None or (not push.repeat and (self.reports_releases or now >= until)):
            return False
        self._blocked_until[push.key] = now + self._windows.repeat_window
        return True


def _limit(value: float) -> float:
    return max(LOWEST_LIMIT, min(HIGHEST_LIMIT, value))


def _scaled(limit: float, factor: float) -> float:
    return _limit(limit * factor) if math.isfinite(factor) and factor > 0 else limit


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _stepped(level: float, direction: int, limit: float) -> float:
    return _within(round(level + direction * STEP, 2), limit)
