"""The person at the keys: is the screen alive, do keys drive, what do they ask for, and the proof of life we send.

The station runs apart from the screen, so that the dead-man of "no program, no demand" is gone. The lease replaces it:
the screen's own loop renews it, and without it keys drive nothing and the station stops claiming control.
"""

from __future__ import annotations

import math

from dialects.axes import NEUTRAL, Axes
from dialects.enums import OperatorFlag as Flag
from dialects.messages import RoverOperatorPresence, boot_ms
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents import LEASE_TIMEOUT, DriveKeyDown, SetKeyGate
from groundstation.snapshot import OperatorView
from link.protocol.heartbeat import HeartbeatMonitor
from link.protocol.rate import RateMeter

THAW = 0.5
"""s for which a screen that came back must renew before keys drive: what was typed while it froze comes in a heap."""

NEUTRAL_LEAD = 0.15
"""s of neutral demands (three frames or four) before keys drive: the vehicle wants to see neutral after arming, a new
mode or driver, and a key pressed in that very moment would otherwise have to be let go and pressed again."""

OLDEST_AGE = 0xFFFF
"""last_input_age_ms: older, or none."""


class OperatorSession:
    """One person at one screen. `session` is a random number that tells this session from others."""

    def __init__(self, style: Style, speed: float, session: int) -> None:
        self.sticks = Sticks(style, speed)
        self.sent_demand = NEUTRAL
        """The demand that went out last to the selected vehicle."""
        self.demand_rate = RateMeter()
        """Demands sent."""
        self.input_count = 0
        """Real input events so far."""
        self._session = session
        self._lease = HeartbeatMonitor(LEASE_TIMEOUT)
        self._live = False
        self._thawed_at = 0.0
        self._gate = SetKeyGate(open=False, reason="starting")
        self._driving_allowed = False
        self._allowed_at = -math.inf
        self._last_input_at: float | None = None

    # ---- the screen ----

    def renew_lease(self, now: float) -> None:
        """The screen lives."""
        if not self._live:
            self._thawed_at = now + THAW if self._lease.ever_heard else now
        self._live = True
        self._lease.update(now)

    def expire_lease(self, now: float) -> bool:
        """True once when the screen has stopped renewing; keys are let go then."""
        if not self._live or self._lease.is_alive(now):
            return False
        self._live = False
        self.sticks.block(now)
        return True

    @property
    def live(self) -> bool:
        """The screen renews its lease."""
        return self._live

    def set_gate(self, gate: SetKeyGate, now: float) -> None:
        """The screen opens or closes the way from keys to sticks."""
        self._gate = gate
        if not gate.open:
            self.sticks.block(now)

    def blocked_reason(self, now: float) -> str | None:
        """Why keys cannot drive, as far as the screen goes; None when they can."""
        if not self._live:
            return "the screen does not answer"
        if now < self._thawed_at:
            return "the screen was frozen"
        return None if self._gate.open else self._gate.reason or "the drive screen is not in front"

    # ---- the keys ----

    def record_input(self, now: float) -> None:
        """A real input event came."""
        self.input_count += 1
        self._last_input_at = now

    def press(self, push: DriveKeyDown, now: float) -> None:
        """A drive key; with the screen in the way it must not drive later either."""
        if self.blocked_reason(now) is None:
            self.sticks.press(push, now)
        else:
            self.sticks.reject(push, now)

    def reset_demand(self, now: float) -> None:
        """Another vehicle is looked at: what the old one was told is not what this one is told."""
        self.sticks.block(now)
        self.sent_demand = NEUTRAL

    def set_driving_allowed(self, allowed: bool, now: float) -> bool:
        """May keys drive from now on? True when they begin to; those that are held must be pressed anew."""
        begins = allowed and not self._driving_allowed
        if begins:
            self.sticks.block(now)
            self._allowed_at = now
        self._driving_allowed = allowed
        return begins

    def demand(self, now: float) -> Axes:
        """What the keys ask for, where they may."""
        if not self._driving_allowed or now - self._allowed_at < NEUTRAL_LEAD:
            return NEUTRAL
        return self.sticks.axes(now)

    # ---- what is told ----

    def build_presence(self, target: tuple[int, int], echo: int | None, now: float) -> RoverOperatorPresence:
        """The message that goes before a demand. `echo` is the newest time_boot_ms of the vehicle."""
        return RoverOperatorPresence(
            target_system=target[0],
            target_component=target[1],
            time_boot_ms=boot_ms(now),
            echo_time_boot_ms=echo or 0,
            session_id=self._session,
            input_count=self.input_count & 0xFFFFFFFF,
            last_input_age_ms=self._age_ms(now),
            flags=self._flags(now),
        )

    def build_view(self, reason: str | None, sending: bool, now: float) -> OperatorView:
        """For the screen. `reason`: why keys do not drive, or None."""
        sticks = self.sticks
        return OperatorView(
            style=sticks.style.value,
            reports_releases=sticks.reports_releases,
            stop_bound=sticks.stop_bound,
            held=sticks.held_keys(now),
            throttle=self.sent_demand.throttle,
            steering=self.sent_demand.steering,
            throttle_limit=sticks.throttle_limit,
            steering_limit=sticks.steering_limit,
            gate_open=reason is None,
            gate_reason=reason or "",
            sending=sending,
            rate=self.demand_rate.rate(now),
        )

    def _age_ms(self, now: float) -> int:
        return OLDEST_AGE if self._last_input_at is None else min(OLDEST_AGE, int((now - self._last_input_at) * 1000))

    def _flags(self, now: float) -> Flag:
        flags = Flag(0)
        if self.sticks.held_keys(now) or not self.sent_demand.neutral:
            flags |= Flag.DEADMAN
        if self._gate.open:
            flags |= Flag.FOCUSED
        if not self._live:
            flags |= Flag.INPUT_LOST
        return flags
