"""The operator at a screen: its lease, key gate and sticks.

The station process keeps running when the screen's process freezes, so a frozen screen alone would not stop the
vehicle. The lease does: the screen's own event loop renews it, and without it keys drive nothing and the station
stops sending heartbeats.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import msgspec

from dialects.axes import NEUTRAL, Axes
from dialects.enums import OperatorFlag as Flag
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents.driving import DriveByPicture, DriveKeyDown, DrivePad
from groundstation.intents.session import LEASE_TIMEOUT, QUITTING, REST_LEASE_TIMEOUT, SUSPENDED, SetKeyGate
from groundstation.snapshot import OperatorView
from groundstation.station.driving.picture_lock import PictureLock
from groundstation.station.driving.proofs import InputRecord
from groundstation.station.driving.stall import StallMonitor
from link.protocol.heartbeat import HeartbeatMonitor
from link.protocol.rate import RateMeter

THAW = 0.5
"""s for which a screen that was frozen must renew before keys drive: keys typed meanwhile arrive all at once."""

NEUTRAL_LEAD = 0.15
"""s of neutral demands (three frames or four) before keys drive: the vehicle requires neutral after arming, a new mode
or a new driver, and a key pressed in that moment would otherwise have to be released and pressed again."""

LATER = 0.001
"""s after the end of a period at which it is over by any rounding."""

IGNORED_SHOWN = 3.0
"""s for which the reason is shown after the last event of a key that does not count."""


class _Ignored(msgspec.Struct):
    """Why a drive key does not count, and its newest event."""

    reason: str = ""
    at: float = -math.inf

    def record(self, reason: str, now: float) -> None:
        self.reason, self.at = reason, now

    def shown(self, now: float) -> str:
        return self.reason if now - self.at <= IGNORED_SHOWN else ""


class Lapse(NamedTuple):
    """The lease has run out, or the station stood still."""

    text: str
    """What did not respond, and for how long."""
    drove: bool
    """A key was down, and has been released."""
    left: bool
    """The operator quits, or has suspended the screen."""


class OperatorSession:
    """One operator at one screen."""

    def __init__(self, style: Style, speed: float) -> None:
        self.sticks = Sticks(style, speed)
        self.demand_rate = RateMeter()
        """Demands sent."""
        self.stall = StallMonitor()
        self._ignored = _Ignored()
        self._sent_demand = NEUTRAL
        """The last demand sent to the selected vehicle."""
        self.inputs = InputRecord()
        self._lease = HeartbeatMonitor(LEASE_TIMEOUT)
        self._rest_ended_at = -math.inf
        self._live = False
        self._unreported_lapse: Lapse | None = None
        self._drove_at_renewal = False
        """A key was down, or the demand not neutral, when the screen renewed its lease."""
        self._renewed_at = -math.inf
        self._thawed_at = 0.0
        self._gate = SetKeyGate(open=False, reason="starting")
        self._picture = PictureLock()
        self._driving_allowed = False
        self._allowed_at = -math.inf

    # ---- the screen ----

    def renew_lease(self, now: float) -> None:
        """Extend the lease: the screen's event loop runs. A lease that has run out releases all keys first."""
        self._check_lease(now)
        if not self._live:
            self._thawed_at = now + THAW if self._lease.ever_heard else now
        self._live = True
        self._lease.update(now)
        self._renewed_at, self._drove_at_renewal = now, self._drives(now)

    def set_resting(self, rests: bool, now: float) -> None:
        """Let the screen renew less often while the station rests. When that ends it has LEASE_TIMEOUT to renew."""
        self._check_lease(now)
        self._lease.timeout = REST_LEASE_TIMEOUT if rests else LEASE_TIMEOUT
        self._rest_ended_at = -math.inf if rests else now

    @property
    def rests(self) -> bool:
        """The station rests."""
        return self._lease.timeout == REST_LEASE_TIMEOUT

    def expire_lease(self, now: float) -> Lapse | None:
        """Release all keys when the lease has run out. Returns what happened, once each time."""
        self._check_lease(now)
        lapse, self._unreported_lapse = self._unreported_lapse, None
        return lapse

    def change_screen(self, gate: SetKeyGate, now: float, *, reports_releases: bool) -> None:
        """Take the keys from one screen and give them to another, or to none. Nothing drives before it renews."""
        self._live = False
        self._gate, self._picture = gate, PictureLock()
        self.sticks.change_keyboard(now, reports_releases=reports_releases)

    @property
    def live(self) -> bool:
        """The screen renews its lease."""
        return self._live

    def set_gate(self, gate: SetKeyGate, now: float) -> None:
        """Open or close the gate between keys and sticks."""
        self._gate = gate
        if not gate.open:
            self.sticks.block(now)
            self.sticks.require_quiet()

    def watch_picture(self, intent: DriveByPicture, now: float) -> None:
        """Note whether the driver drives by the picture, and when the newest one was taken."""
        self._picture.handle(intent, now)

    def prolong_picture(self, intent: DriveByPicture, now: float) -> bool:
        """Let keys drive by a newer picture. Returns False if it is more than that."""
        return self._picture.prolong(intent, now)

    def blocked_reason(self, now: float) -> str | None:
        """Return why the screen keeps keys from driving; None when it does not."""
        shut = None if self._gate.open else self._gate_reason
        return self._find_freeze(now) or shut or self._picture.refusal(now)

    def permission_blocked_reason(self, now: float) -> str | None:
        """Return why the screen keeps its key from permitting what agents propose; None when it does not."""
        shut = None if self._gate.open or self._gate.permits else self._gate_reason
        return self._find_freeze(now) or shut or self._picture.refusal(now)

    @property
    def _gate_reason(self) -> str:
        return self._gate.reason or "Drive screen not in front"

    def _find_freeze(self, now: float) -> str | None:
        if not self._live:
            return "screen not responding"
        return "screen was frozen" if now < self._thawed_at else None

    # ---- the keys ----

    def press(self, push: DriveKeyDown, reason: str | None, now: float) -> None:
        """Handle a drive key. One pressed while the screen blocks driving must not drive later either.

        `reason`: why the screen blocks it, or None.
        """
        if reason is not None:
            self.sticks.reject(push, now)
            self._ignored.record(reason, now)
        elif self.sticks.press(push, now):
            self._ignored = _Ignored()
        else:
            self._ignored.record(self._ignored.shown(now) or "it was held before", now)

    def prolong(self, push: DriveKeyDown, now: float) -> bool:
        """Handle a drive key that drives already and repeats. Returns False for any other event, without effect."""
        counts = self._driving_allowed and self.blocked_reason(now) is None and self.sticks.prolong(push, now)
        if counts:
            self.inputs.add(now)
            self._ignored = _Ignored()
        return counts

    def push_pad(self, push: DrivePad, reason: str | None, now: float) -> None:
        """Handle a demand of the gamepad, by the rules of a drive key."""
        if reason is not None:
            self.sticks.pad.release()
            self._ignored.record(reason, now)
        elif self.sticks.push_pad(push, now):
            self._ignored = _Ignored()
        else:
            self._ignored.record(self._ignored.shown(now) or "the gamepad's button was held before", now)

    def ignored(self, now: float) -> str:
        """Return why the newest drive key does not count; "" if it does, or some time after it."""
        return self._ignored.shown(now)

    def reset_demand(self, now: float) -> None:
        """Go neutral for another vehicle; the demand of the previous vehicle is not that of the new one."""
        self.sticks.block(now)
        self._sent_demand = NEUTRAL

    def set_driving_allowed(self, allowed: bool, now: float) -> bool:
        """Set whether keys may drive. Returns True when they begin to; keys held now must be pressed again."""
        begins = allowed and not self._driving_allowed
        if begins:
            self.sticks.block(now)
            self._allowed_at = now
        self._driving_allowed = allowed
        return begins

    def demand(self, now: float) -> Axes:
        """Return the demand of the keys, or neutral while they may not drive."""
        if not self._driving_allowed or now - self._allowed_at < NEUTRAL_LEAD:
            return NEUTRAL
        return self.sticks.axes(now)

    def changes_at(self, now: float) -> float | None:
        """Return when a timer changes `demand`, or ends the lease, if nothing happens before; None: none does."""
        ends = (
            self.sticks.changes_at(now),
            self._allowed_at + NEUTRAL_LEAD + LATER,
            self._thawed_at + LATER,
            self._lease_end(now) + LATER,
            self._picture.ends_at,
        )
        return min((at for at in ends if at is not None and at > now), default=None)

    @property
    def sent_demand(self) -> Axes:
        """The last demand sent to the selected vehicle."""
        return self._sent_demand

    def record_demand(self, axes: Axes) -> bool:
        """Record the demand sent to the selected vehicle. Returns whether it differs from the one before."""
        changed, self._sent_demand = axes != self._sent_demand, axes
        return changed

    @property
    def moves(self) -> bool:
        """The last demand sent requests motion."""
        return not self._sent_demand.neutral

    def _check_lease(self, now: float) -> None:
        """Release all keys when the lease has run out, whichever event of a thawed process comes first.

        A station that stood still counts as one whose lease has run out, even if a renewal came just before.
        """
        stalled = self.stall.pop_stall(now)
        if not self._live or (stalled is None and now <= self._lease_end(now)):
            return
        self._live = False
        drove = self._gate.open and (self._drove_at_renewal or self._drives(now) or self._input_since_renewal)
        self.sticks.block(now)
        if stalled is None:
            text = f"display not responding for {self._lease.silence(now):.1f} s"
        else:
            text = f"station stopped for {stalled:.1f} s"
        left = not self._gate.open and self._gate.reason.startswith((QUITTING, SUSPENDED))
        self._unreported_lapse = Lapse(text, drove, left)

    def _drives(self, now: float) -> bool:
        return bool(self.sticks.held_keys(now)) or self.moves

    @property
    def _input_since_renewal(self) -> bool:
        """A key may go down while the screen no longer draws: the thread that reads it does not wait for that."""
        return self.inputs.at is not None and self.inputs.at > self._renewed_at

    def _lease_end(self, now: float) -> float:
        return max(now - self._lease.silence(now), self._rest_ended_at) + self._lease.timeout

    # ---- what others see ----

    def flags(self, now: float) -> Flag:
        """Return what a proof tells of this operator."""
        flags = Flag(0)
        if self.sticks.held_keys(now) or not self._sent_demand.neutral:
            flags |= Flag.DEADMAN
        if self._gate.open:
            flags |= Flag.FOCUSED
        if not self._live:
            flags |= Flag.INPUT_LOST
        if self._overrides(now):
            flags |= Flag.OVERRIDE
        return flags

    def build_view(self, reason: str | None, sending: bool, now: float) -> OperatorView:
        """Build the operator's part of the snapshot. `reason`: why keys do not drive, or None."""
        sticks = self.sticks
        return OperatorView(
            style=sticks.style.value,
            reports_releases=sticks.reports_releases,
            stop_bound=sticks.stop_bound,
            held=sticks.held_keys(now),
            overrides=reason is None and self._overrides(now),
            held_over=reason is None and sticks.held_over(now),
            throttle=self._sent_demand.throttle,
            steering=self._sent_demand.steering,
            side=self._sent_demand.side,
            climb=self._sent_demand.climb,
            throttle_limit=sticks.throttle_limit,
            steering_limit=sticks.steering_limit,
            gate_open=reason is None,
            gate_reason=reason or "",
            ignored=self.ignored(now),
            sending=sending,
            rate=self.demand_rate.rate(now),
        )

    def _overrides(self, now: float) -> bool:
        return self._live and self._driving_allowed and self.sticks.overrides(now)
