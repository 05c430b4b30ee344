"""Keys and the gamepad as two sticks: intents and time in, axes out. Timers return them to neutral.

Operations wanted: the axes at any moment (`axes`), and the moment at which a timer changes them next (`changes_at`).

Worst case: a terminal that reports no releases. A held key sends a press, a pause of up to 1 s, then repeats, and
nothing when it goes up. So a press counts for a window and each repeat extends it (key_repeat.py); `stop_bound` is the
longest. Of several held keys only the newest repeats: the others last as long as it does. A key that was held while
driving was not allowed goes on repeating afterwards, which looks like a press: `block`, `reject` and `require_quiet`
ignore it.

Why not simpler: one fixed window would either interrupt each hold once on a keyboard that repeats late, or let each
tap drive for longer on all others.
"""

from __future__ import annotations

import math

import msgspec

from dialects.axes import NEUTRAL, Axes
from groundstation.input.key_repeat import PRESS_WINDOW, REPEAT_GAP, KeyTrace, RepeatWindows
from groundstation.input.pad_stick import PadStick
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from groundstation.intents.driving import PAD, DriveKeyDown, DrivePad, StepLimits

STEP = 0.1
"""What one press adds in the style "step", as a fraction of full deflection."""


class _Held(msgspec.Struct):
    """A key that counts as held."""

    directions: tuple[int, int, int, int]
    """Throttle, steering, side and climb."""
    until: float
    """inf where the terminal reports the release."""
    trace: KeyTrace
    override: bool = False


class Sticks:
    """The keys, or the gamepad, as two sticks: the one that begins last drives. Times are of one monotonic clock, s."""

    def __init__(self, style: Style = Style.HOLD, limit: float = 0.6) -> None:
        self.style = style
        self.reports_releases = False
        """The terminal reports releases. Set only by proof: ReportKeyReleases, a repeat or a release."""
        self.throttle_limit = self.steering_limit = _limit(limit)
        self._windows = RepeatWindows()
        self._last_event = -math.inf
        self._held: dict[str, _Held] = {}
        self._traces: dict[str, KeyTrace] = {}
        self._blocked_until: dict[str, float] = {}
        """Keys held when driving was blocked -> until when their events still belong to that old press."""
        self._waits_for_quiet = False
        """Drive keys do not count until none was seen for `_quiet`: see require_quiet."""
        self._seen_at = -math.inf
        """When the newest drive key was seen, also one that did not count."""
        self._latched = NEUTRAL
        """State of the styles latch (a direction) and step (a level)."""
        self.pad = PadStick()

    def press(self, push: DriveKeyDown, now: float) -> bool:
        """Handle a drive key that went down or repeats. Returns False if it must be released first."""
        if push.repeat:
            self.reports_releases = True
        if not any(push.directions) and not push.override:
            return True
        if self._is_held_over(now) or self._is_blocked(push, now):
            return False
        self.pad.release()
        if self.style is Style.HOLD or push.override:
            self._hold(push, now)
        elif self.style is Style.STEP:
            self._step(push, now)
        elif not push.repeat:
            self._latched = Axes(*map(float, push.directions))
        return True

    def prolong(self, push: DriveKeyDown, now: float) -> bool:
        """Handle a drive key that is held and repeats, which changes no axis. Returns False for any other event."""
        self._expire(now)
        held = self._held.get(push.key)
        proves = push.repeat and not self.reports_releases
        ignored = self._waits_for_quiet or push.key in self._blocked_until
        if held is None or proves or ignored or push.directions != held.directions:
            return False
        self._seen_at = self._last_event = now
        self._extend_hold(held, now)
        return True

    def push_pad(self, push: DrivePad, now: float) -> bool:
        """Handle a demand of the gamepad; keys that are held no longer count. Returns False as PadStick.push."""
        counts = self.pad.push(push, now)
        if counts:
            self._block_keys(now)
        return counts

    def release(self, key: str) -> None:
        """Handle a drive key that went up."""
        self.reports_releases = True
        self._held.pop(key, None)

    def set_reports_releases(self, reports: bool = True) -> None:
        """Stop using timers: the terminal has shown that it reports releases. False: of this key it does not."""
        self.reports_releases = reports

    def change_keyboard(self, now: float, *, reports_releases: bool) -> None:
        """Go neutral and forget the keys: others follow, of another terminal. One that is held there does not count."""
        self.stop()
        self.reports_releases = reports_releases
        self._windows = RepeatWindows()
        self._traces.clear()
        self._blocked_until.clear()
        self.require_quiet()
        self._seen_at = now

    def stop(self) -> None:
        """Go neutral; the next press drives again."""
        self._held.clear()
        self._latched = NEUTRAL
        self.pad.release()

    def block(self, now: float) -> None:
        """Go neutral; what is held now must be released before it drives again."""
        self._block_keys(now)
        self.pad.release()

    def _block_keys(self, now: float) -> None:
        for key, held in self._held.items():
            window = self._windows.repeat_window if held.trace.repeating else self._windows.press_window
            self._blocked_until[key] = now + window
        self._held.clear()
        self._latched = NEUTRAL

    def require_quiet(self) -> None:
        """Ignore drive keys until none was seen for a while: without reported releases a repeat looks like a press.

        Called when the key gate closes, e.g. for another screen: a key that was pressed there may still repeat here.
        """
        self._waits_for_quiet = True

    def held_over(self, now: float) -> bool:
        """Return whether drive keys are ignored because one repeats from before the key gate opened."""
        return self._waits_for_quiet and not self.reports_releases and now - self._seen_at < self._quiet

    def reject(self, push: DriveKeyDown, now: float) -> None:
        """Ignore a press while driving is not allowed: it must not drive later either."""
        self._seen_at = now
        self._blocked_until[push.key] = now + (
            self._windows.repeat_window if push.key in self._blocked_until else self._windows.press_window
        )

    def step_limits(self, change: StepLimits) -> None:
        """Change the limits. A change that is not a number changes nothing."""
        self.throttle_limit = _changed(self.throttle_limit, change.throttle)
        self.steering_limit = _changed(self.steering_limit, change.steering)

    def set_style(self, name: str) -> bool:
        """Go neutral and change the style. Returns False, without a change of style, for an unknown one."""
        self.stop()
        if name == "next":
            self.style = self.style.next
        elif name in set(Style):
            self.style = Style(name)
        else:
            return False
        return True

    def axes(self, now: float) -> Axes:
        """Return the demand now, within the limits."""
        if self.pad.held(now):
            pad = self.pad.axes
            return self._limited(pad.throttle, pad.steering, pad.side, pad.climb)
        if self.style is Style.HOLD:
            return self._limited(*self._directions(now))
        if self.style is not Style.LATCH:
            return Axes(
                _within(self._latched.throttle, self.throttle_limit),
                _within(self._latched.steering, self.steering_limit),
            )
        latched = self._latched
        return self._limited(latched.throttle, latched.steering, latched.side, latched.climb)

    def _limited(self, throttle: float, steering: float, side: float, climb: float) -> Axes:
        speed = self.throttle_limit
        return Axes(throttle * speed, steering * self.steering_limit, side * speed, climb * speed)

    def changes_at(self, now: float) -> float | None:
        """Return when a timer changes `axes` if nothing happens before; None: none does."""
        if self.pad.held(now):
            return self.pad.until
        if not self._held:
            return None
        latest = math.inf if self.reports_releases else self._last_event + self._windows.press_window
        ends = min(latest, *(held.until for held in self._held.values()))
        return None if math.isinf(ends) else ends

    def held_keys(self, now: float) -> tuple[str, ...]:
        """Return the keys that count as held; the gamepad is one of them while it drives."""
        self._expire(now)
        return (*self._held, *([PAD] if self.pad.held(now) else []))

    def overrides(self, now: float) -> bool:
        """Return whether the key is held that overrides the limits before obstacles."""
        self._expire(now)
        return any(held.override for held in self._held.values())

    @property
    def stop_bound(self) -> float:
        """Longest time for which a demand stays after the key is released, s: inf where only a key ends it."""
        if self.style is not Style.HOLD:
            return math.inf
        return 0.0 if self.reports_releases else self._windows.press_window

    def _hold(self, push: DriveKeyDown, now: float) -> None:
        self._expire(now)
        self._last_event = now
        held = self._held.get(push.key)
        if held is not None:
            self._extend_hold(held, now)
        elif not push.repeat:  # else a repeat of a key that is not down: kitty sends some after a focus change
            self._press(push, now)

    def _press(self, push: DriveKeyDown, now: float) -> None:
        if not self.reports_releases:
            self._release_same_stick(push)
        trace = self._windows.start_press(self._traces.get(push.key), now)
        self._traces[push.key] = trace
        until = math.inf if self.reports_releases else now + self._windows.press_window
        self._held[push.key] = _Held(push.directions, until, trace, push.override)
        self._refresh_others(until)

    def _extend_hold(self, held: _Held, now: float) -> None:
        until = now + self._windows.record_repeat(held.trace, now)
        held.until = math.inf if self.reports_releases else until
        self._refresh_others(until)

    def _release_same_stick(self, push: DriveKeyDown) -> None:
        """Release the keys of the same stick: without reported releases a new key replaces them."""
        for key, held in list(self._held.items()):
            if any(one and other for one, other in zip(held.directions, push.directions, strict=True)):
                del self._held[key]

    def _refresh_others(self, until: float) -> None:
        """Hold the other keys as long as the newest: only the newest repeats, so theirs cannot be timed."""
        for held in self._held.values() if not self.reports_releases else ():
            held.until = max(held.until, until)

    def _expire(self, now: float) -> None:
        # A window that was just learned to be shorter applies to every key, as stop_bound guarantees.
        everything = not self.reports_releases and now >= self._last_event + self._windows.press_window
        for key, held in tuple(self._held.items()):
            if everything or now >= held.until:
                del self._held[key]

    def _directions(self, now: float) -> tuple[int, int, int, int]:
        """Return the directions of the held keys; of keys that disagree the newest wins."""
        self._expire(now)
        throttle = steering = side = climb = 0
        for held in self._held.values():
            ahead, turn, right, up = held.directions
            throttle, steering, side, climb = ahead or throttle, turn or steering, right or side, up or climb
        return throttle, steering, side, climb

    def _step(self, push: DriveKeyDown, now: float) -> None:
        earlier = self._traces.get(push.key)
        self._traces[push.key] = KeyTrace(pressed=now, seen=now)
        if push.repeat or (earlier is not None and now - earlier.seen <= REPEAT_GAP):
            return  # a held key is one press
        self._latched = Axes(
            _stepped(self._latched.throttle, push.throttle, self.throttle_limit),
            _stepped(self._latched.steering, push.steering, self.steering_limit),
        )

    @property
    def _quiet(self) -> float:
        """Time without drive keys that shows that none is held, s: longer than the delay before the first repeat."""
        return max(PRESS_WINDOW, self._windows.press_window)

    def _is_held_over(self, now: float) -> bool:
        self._waits_for_quiet, self._seen_at = self.held_over(now), now
        return self._waits_for_quiet

    def _is_blocked(self, push: DriveKeyDown, now: float) -> bool:
        until = self._blocked_until.pop(push.key, None)
        if until is None or (not push.repeat and (self.reports_releases or now >= until)):
            return False
        self._blocked_until[push.key] = now + self._windows.repeat_window
        return True


def _limit(value: float) -> float:
    return max(LOWEST_LIMIT, min(HIGHEST_LIMIT, value))


def _changed(limit: float, change: float) -> float:
    return _limit(round(limit + change, 2)) if math.isfinite(change) else limit


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _stepped(level: float, direction: int, limit: float) -> float:
    return _within(round(level + direction * STEP, 2), limit)
