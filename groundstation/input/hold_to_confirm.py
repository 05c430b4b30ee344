"""Confirmation by a held key: which reads of keys are one key held long enough. Time is an argument.

A held key sends its press, a pause (the repeat delay), then repeats. Only those repeats, in separate reads and spread
over its hold time, confirm an action. Typed or pasted text cannot: it is faster, slower, or contains other keys. A key
that has acted (armed, or disarmed) does nothing more until it was released. Terminals that report releases must send
repeats, too: on a bad line the release may be late or lost, and such a key must not arm.

A key that permits what an agent proposes goes on to confirm with each repeat; anything else that is read ends it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import msgspec

from groundstation.actions import OperatorAction
from groundstation.input.key_repeat import LONGEST_DELAY, REPEAT_GAP, REPEAT_WINDOW_MAX, REPEAT_WINDOW_MIN
from groundstation.input.keymap import KeyEvent, Keymap
from groundstation.intents.agents import EndPermission
from groundstation.intents.union import AnyIntent

MIN_REPEATS = 5
"""Repeats at most REPEAT_GAP apart that a hold needs, so that quick taps of a finger never count as one."""

MAX_EVENTS = 8
"""Events of one read above which it is pasted text: 0.25 s of repeats every 33 ms, when the machine was late."""


class HoldProgress(msgspec.Struct, frozen=True):
    """A hold that has begun."""

    action: OperatorAction
    key: str
    held: float
    """s since the press, at most the `hold_time` of the action."""


class HoldResult(msgspec.Struct, frozen=True):
    """What one read of keys means."""

    passing: list[KeyEvent]
    """The read without the repeats of a key that has acted already."""
    confirmed: AnyIntent | None = None
    """The intent of the action that this read has confirmed, or keeps going, or ends."""


class _Hold(msgspec.Struct):
    """The events of one key since its press."""

    key: str
    action: OperatorAction
    pressed: float
    seen: float
    """Time of the newest event."""
    followed: bool = False
    """An event has come after the press."""
    repeats: int = 0
    """Events at most REPEAT_GAP after the one before."""
    longest_gap: float = 0.0
    """Longest gap of those repeats, s."""
    spent: bool = False
    """The key has acted or was cancelled: it must be released first."""
    subject: int = 0
    """What the key was pressed for."""
    keeps: bool = False
    """It has confirmed, and each of its repeats does so again."""

    @property
    def window(self) -> float:
        """Return the time after the newest event for which the key counts as held, s."""
        if not self.followed:
            return LONGEST_DELAY
        if self.spent and self.repeats >= MIN_REPEATS:
            return min(max(2.5 * self.longest_gap, REPEAT_WINDOW_MIN), REPEAT_WINDOW_MAX)
        return REPEAT_WINDOW_MAX

    def extend(self, now: float) -> None:
        """Record a further event. Those of one read count once."""
        gap, self.seen = now - self.seen, now
        if gap <= 0:
            return
        self.followed = True
        if gap <= REPEAT_GAP:
            self.repeats += 1
            self.longest_gap = max(self.longest_gap, gap)


class HoldToConfirm:
    """Follows the key of an action that needs confirmation. Times are of one monotonic clock, s."""

    def __init__(self, keymap: Keymap) -> None:
        self.keymap = keymap
        self._hold: _Hold | None = None
        self._subject = 0

    def handle_read(
        self,
        batch: Sequence[KeyEvent],
        *,
        armed: bool,
        allowed: bool,
        now: float,
        subject: int = 0,
        also: Collection[str] = (),
    ) -> HoldResult:
        """Handle the keys of one read. `allowed`: a hold may begin or end; `subject`: the proposal that is shown.

        `also`: keys of which one may begin or end where the others may not.
        """
        text = len(batch) > MAX_EVENTS or len({press.key for press in batch}) > 1
        kept, self._subject = self._hold if self._hold is not None and self._hold.keeps else None, subject

        def may(key: str) -> bool:
            return not text and (allowed or key in also)

        passing = [press for press in batch if not self._swallow(press, armed, may(press.key), now)]
        if self._hold is not None and not may(self._hold.key):
            self.cancel()
        if kept is not None and batch and (self._hold is not kept or kept.spent):
            return HoldResult(passing, EndPermission())
        return HoldResult(passing, self._confirm(now) if batch else None)

    def cancel(self) -> None:
        """End a hold; its key must be released before it counts again."""
        if self._hold is not None:
            self._hold.spent, self._hold.keeps = True, False

    def progress(self, now: float) -> HoldProgress | None:
        """Return the hold that has begun, None if there is none or its key is no longer held."""
        hold = self._hold
        if hold is None or hold.spent or hold.keeps or now - hold.seen > hold.window:
            return None
        return HoldProgress(hold.action, hold.key, min(now - hold.pressed, hold.action.hold_time))

    def _swallow(self, press: KeyEvent, armed: bool, allowed: bool, now: float) -> bool:
        """Follow an event. Return whether it is a repeat of a key that has acted: it must not act again."""
        hold = self._hold
        if hold is None or press.key != hold.key or press.release or now - hold.seen > hold.window:
            self._hold = self._begin(press, armed, allowed, now)
            return False
        hold.extend(now)
        hold.spent |= armed and hold.action.when_armed is not None
        return hold.spent and hold.repeats > 0

    def _begin(self, press: KeyEvent, armed: bool, allowed: bool, now: float) -> _Hold | None:
        action = self.keymap.get_action(press.key)
        if action is None or not action.confirm or press.release or press.repeat:
            return None
        acts = armed and action.when_armed is not None
        if action.keeps:  # one that is held when a proposal comes, or when it begins to count, permits nothing
            spent = not (allowed and self._subject)
            return _Hold(press.key, action, now, now, spent=spent, subject=self._subject)
        return _Hold(press.key, action, now, now, spent=acts) if acts or allowed else None

    def _confirm(self, now: float) -> AnyIntent | None:
        hold = self._hold
        if hold is None or hold.spent or now - hold.pressed < hold.action.hold_time or hold.repeats < MIN_REPEATS:
            return None
        hold.keeps = hold.action.keeps
        hold.spent = not hold.keeps
        return None if hold.action.intent is None else _with_hold(hold.action.intent, hold, now)


def _with_hold(intent: AnyIntent, hold: _Hold, now: float) -> AnyIntent:
    """Return the intent with the time of its hold, which the station checks, and with what the key was pressed for."""
    known = {"held": now - hold.pressed, "number": hold.subject}
    return msgspec.structs.replace(intent, **{name: known[name] for name in known if name in intent.__struct_fields__})
