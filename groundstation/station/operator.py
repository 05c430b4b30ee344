"""The person at the keys: is the screen alive, do keys drive, what do they ask for, and the proof of life we send.

The station runs apart from the screen, so that the dead-man of "no program, no demand" is gone. The lease replaces it:
the screen's own loop renews it, and without it keys drive nothing and the station stops claiming control.
"""

from __future__ import annotations

import math

from dialects.axes import NEUTRAL, Axes
from dialects.enums import Operator as Flag
from dialects.messages import RoverOperatorPresence, boot_ms
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents import LEASE, Gate, Push
from groundstation.snapshot import HelmView
from link.protocol.heartbeat import HeartbeatMonitor
from link.protocol.rate import RateMeter

THAW = 0.5
"""s for which a screen that came back must renew before keys drive: what was typed while it froze comes in a heap."""

NEUTRAL_LEAD = 0.15
"""s of neutral demands (three frames or four) before keys drive: the vehicle wants to see neutral after arming, a new
mode or driver, and a key pressed in that very moment would otherwise have to be let go and pressed again."""

OLDEST_AGE = 0xFFFF
"""last_input_age_ms: older, or none."""


class Operator:
    """One person at one screen. `session` is a random number that tells this session from others."""

    def __init__(self, style: Style, speed: float, session: int) -> None:
        self.sticks = Sticks(style, speed)
        self.sent = NEUTRAL
        """The demand that went out last to the selected vehicle."""
        self.meter = RateMeter()
        """Demands sent."""
        self.inputs = 0
        """Real input events so far."""
        self._session = session
        self._lease = HeartbeatMonitor(LEASE)
        self._live = False
        self._thawed_at = 0.0
        self._gate = Gate(open=False, reason="starting")
        self._driving_allowed = False
        self._allowed_at = -math.inf
        self._touched: float | None = None

    # ---- the screen ----

    def renew(self, now: float) -> None:
        """The screen lives."""
        if not self._live:
            self._thawed_at = now + THAW if self._lease.ever else now
        self._live = True
        self._lease.heard(now)

    def lapsed(self, now: float) -> bool:
        """True once when the screen has stopped renewing; keys are let go then."""
        if not self._live or self._lease.alive(now):
            return False
        self._live = False
        self.sticks.block(now)
        return True

    @property
    def live(self) -> bool:
        """The screen renews its lease."""
        return self._live

    def set_gate(self, gate: Gate, now: float) -> None:
        """The screen opens or closes the way from keys to sticks."""
        self._gate = gate
        if not gate.open:
            self.sticks.block(now)

    def obstacle(self, now: float) -> str | None:
        """Why keys cannot drive, as far as the screen goes; None when they can."""
        if not self._live:
            return "the screen does not answer"
        if now < self._thawed_at:
            return "the screen was frozen"
        return None if self._gate.open else self._gate.reason or "the drive screen is not in front"

    # ---- the keys ----

    def touch(self, now: float) -> None:
        """A real input event came."""
        self.inputs += 1
        self._touched = now

    def push(self, push: Push, now: float) -> None:
        """A drive key; with the screen in the way it must not drive later either."""
        if self.obstacle(now) is None:
            self.sticks.push(push, now)
        else:
            self.sticks.swallow(push, now)

    def let_go(self, now: float) -> None:
        """Another vehicle is looked at: what the old one was told is not what this one is told."""
        self.sticks.block(now)
        self.sent = NEUTRAL

    def allow(self, allowed: bool, now: float) -> bool:
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

    def presence(self, target: tuple[int, int], echo: int | None, now: float) -> RoverOperatorPresence:
        """The message that goes before a demand. `echo` is the newest time_boot_ms of the vehicle."""
        return RoverOperatorPresence(
            target_system=target[0],
            target_component=target[1],
            time_boot_ms=boot_ms(now),
            echo_time_boot_ms=echo or 0,
            session_id=self._session,
            input_count=self.inputs & 0xFFFFFFFF,
            last_input_age_ms=self._age_ms(now),
            flags=self._flags(now),
        )

    def view(self, reason: str | None, sending: bool, now: float) -> HelmView:
        """For the screen. `reason`: why keys do not drive, or None."""
        sticks = self.sticks
        return HelmView(
            style=sticks.style.value,
            exact=sticks.exact,
            stop_bound=sticks.stop_bound,
            held=sticks.held(now),
            throttle=self.sent.throttle,
            steering=self.sent.steering,
            throttle_limit=sticks.throttle_limit,
            steering_limit=sticks.steering_limit,
            gate_open=reason is None,
            gate_reason=reason or "",
            sending=sending,
            rate=self.meter.rate(now),
        )

    def _age_ms(self, now: float) -> int:
        return OLDEST_AGE if self._touched is None else min(OLDEST_AGE, int((now - self._touched) * 1000))

    def _flags(self, now: float) -> Flag:
        flags = Flag(0)
        if self.sticks.held(now) or not self.sent.neutral:
            flags |= Flag.DEADMAN
        if self._gate.open:
            flags |= Flag.FOCUSED
        if not self._live:
            flags |= Flag.INPUT_LOST
        return flags
