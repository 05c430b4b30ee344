"""The demand of the ground station in control, its age, and the neutral-first interlock.

Neutral first: after arming, a mode change, a failsafe, a lost demand, a change of control or an emergency stop, a
demand counts only once the ground station in control has sent a neutral one. A stick that was held all the while, or a
ground station that repeats an old demand, moves nothing. The last gate (vehicle/drive/gate.py) decides about motion.
"""

from __future__ import annotations

import math

from dialects.axes import FULL_DEFLECTION
from dialects.enums import DriveType, OperatorFlag, Severity
from dialects.messages import INVALID_AXIS, ManualControl, RcChannelsOverride, RoverOperatorPresence
from link.core import Received
from link.signing.role import SigningRole
from vehicle.drive.conversation import Conversation
from vehicle.drive.demand import Demand, RcOverride, from_manual_control
from vehicle.drive.mixer import MIXERS
from vehicle.drive.operator_presence import OperatorPresence
from vehicle.drive.operator_session import DemandOrder, DrivingSession, Proof, parse_proof
from vehicle.drive.ownership import Ownership
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue


class Control:
    """The demand of the driver (`ownership`: who that is), and its age."""

    def __init__(self, params: Params, texts: StatusTextQueue, *, system: int, boot: float) -> None:
        self.ownership = Ownership(params, texts, boot)
        self.demand: Demand | None = None
        """The newest demand since the owner took control or chose a mode, of any age."""
        self.neutral_seen = False
        self.not_in_control_count = 0
        """Number of demands from ground stations that are not in control."""
        self.presence = OperatorPresence()
        self.override = RcOverride()
        self._succeeded = False
        self._params = params
        self._sideways = MIXERS[DriveType(int(params["DRIVE_TYPE"]))].sideways
        self._texts = texts
        self.system = system
        self._boot = boot

    # Ownership

    def take(self, conversation: Conversation, now: float) -> None:
        """Give control to a conversation; of another driver nothing is left."""
        if self.ownership.take(conversation, now):
            self._begin(now)

    def release(self, why: str, now: float) -> None:
        """Release control; `why` completes the STATUSTEXT."""
        self.ownership.release(why, now)
        self.reset()

    def hear(self, received: Received, now: float) -> None:
        """Note a message of anybody, before it is handled; those whose key may not drive are not successors."""
        if not received.introduced or received.role < SigningRole.DRIVE:
            return
        if self.ownership.hear(received, now):
            self._begin_succession(now)
        driver = self.ownership.driver
        if driver is not None and driver.is_barred(now):
            self.reset()

    def pop_succession(self) -> bool:
        """Return True once after another program has taken over without having been granted control."""
        succeeded, self._succeeded = self._succeeded, False
        return succeeded

    def _begin_succession(self, now: float) -> None:
        self._begin(now)
        self._succeeded = True

    def _begin(self, now: float) -> None:
        """Forget the last driver; the next one must send another proof before its demands count, if it sends any."""
        self.presence = OperatorPresence(echoes=self.ownership.driver_proves(now))
        self.reset()

    # Demand

    def handle_manual_control(self, received: Received, message: ManualControl, now: float) -> bool:
        """Handle a MANUAL_CONTROL; return True if it is the demand now."""
        if not self._accepts(received, message.target, now):
            return False
        if self.demand and self.demand.sequence == received.sequence:
            return False  # a replay of the same packet
        lifetime = self._params["OPR_ECHO_MAX"] - self.presence.echo_age(now)
        demand = self._parse(received, message, now, lifetime)
        if _is_out_of_range(message.x) or _is_out_of_range(message.r):
            self._report_invalid(received, "axes outside -1000..1000 count as neutral", now)
        if demand is None:
            return False
        return self._use_old(demand, now) if lifetime < 0.0 else self._use(demand, now)

    def handle_rc_override(self, received: Received, message: RcChannelsOverride, now: float) -> bool:
        """Handle an RC_CHANNELS_OVERRIDE; return True if it is the demand now."""
        if not self._accepts(received, message.target_system, now):
            return False
        used = self.override.update(message, now)
        if self.override.has_invalid_value:
            self._report_invalid(received, "channels outside 800..2200 us are ignored", now)
        if not used:
            return False
        timeout = self._params["MAN_TIMEOUT"]
        return self._use(self.override.build_demand(received.system, received.sequence, now, timeout), now)

    def handle_operator_presence(self, received: Received, message: RoverOperatorPresence, now: float) -> bool:
        """Handle a ROVER_OPERATOR_PRESENCE; return True if it is the demand now. An ignored one is not reported."""
        if message.target_system != self.system or not received.introduced or received.role < SigningRole.DRIVE:
            return False
        ownership, conversation = self.ownership, Conversation.of(received)
        proof = parse_proof(message, now - self._boot)
        good = proof is not None and proof.age <= self._params["OPR_ECHO_MAX"]
        if proof is not None:
            ownership.add_proof(conversation, proof, now, good=good)
        if not ownership.has_driver_ids(received):
            return False
        session = ownership.session
        if proof is not None and good and (session is None or session.id != proof.session):
            self._handle_other_session(conversation, proof, message, now)
        if ownership.session is not None:
            return proof is not None and self._handle_proof(received, message, proof, now, good=good)
        if ownership.is_driver(received, now) and self.presence.handle(message, now - self._boot, now):
            self.require_neutral()
        return False

    def _handle_other_session(
        self, conversation: Conversation, proof: Proof, message: RoverOperatorPresence, now: float
    ) -> None:
        """Let another session with the driver's ids take over by a demand, if the driver is silent; else report it."""
        if message.x == message.r == INVALID_AXIS:
            return
        if self.ownership.succeed(conversation, DrivingSession.begin(conversation, proof, now), now):
            self._begin_succession(now)
        else:
            self.ownership.report_other_session(conversation, now)

    def _handle_proof(
        self, received: Received, message: RoverOperatorPresence, proof: Proof, now: float, *, good: bool
    ) -> bool:
        """Handle a proof with the driver's ids while a session is in control."""
        session = self.ownership.session
        if session is None or proof.session != session.id:
            return False
        if good:
            self.presence.handle(message, now - self._boot, now)
        demand = self._parse(received, message, now, self._params["OPR_ECHO_MAX"] - proof.age)
        if demand is not None and message.flags & OperatorFlag.OVERRIDE:
            demand = demand._replace(override=True)
        if demand is None or session.order(proof) is not DemandOrder.NEWEST:
            return False
        used = self._use(demand, now) if good else self._use_old(demand, now)
        if used:
            session.clock = proof.clock
        return used

    def demand_age(self, now: float) -> float | None:
        """Return the s since the demand arrived; None without one."""
        return None if self.demand is None else now - self.demand.time

    def is_demand_stale(self, now: float) -> bool:
        """Return True if the demand is older than `demand_timeout`; False without one."""
        demand = self.demand
        return demand is not None and now - demand.time > self.demand_timeout

    @property
    def demand_timeout(self) -> float:
        """Age in s from which on the demand in use is stale: MAN_TIMEOUT, or sooner if its proof ends."""
        timeout: float = self._params["MAN_TIMEOUT"]
        return timeout if self.demand is None or self.demand.lifetime >= timeout else self.demand.lifetime

    @property
    def sent_at(self) -> float | None:
        """The earliest time at which the demand can have been sent; None without one.

        Of a driver without proofs only its arrival is known.
        """
        return None if self.demand is None else self.demand.time - self.demand.age

    @property
    def longest_age(self) -> float:
        """S from sending a demand, at the earliest, until it is stale at the latest."""
        return max(self._params["MAN_TIMEOUT"], self._params["OPR_ECHO_MAX"])

    def requests_motion(self) -> bool:
        """Return True if the demand, of any age, requests motion."""
        return self.demand is not None and self.demand.requests_motion(self.deadband)

    def expire_stale_demand(self, now: float) -> None:
        """Require neutral after a demand for motion has become stale.

        A stale neutral demand does not close the interlock before its failsafe does: an idle operator sends at 5 Hz,
        and two lost frames must not swallow the next key press.
        """
        if self.is_demand_stale(now) and self.requests_motion():
            self.require_neutral()

    def require_neutral(self) -> None:
        """Close the neutral-first interlock."""
        self.neutral_seen = False

    def reset(self) -> None:
        """Forget the demand, and close the neutral-first interlock."""
        self.require_neutral()
        self.demand = None
        self.override.channels.clear()

    @property
    def deadband(self) -> float:
        """Axis values up to this count as neutral."""
        return self._params["MAN_DEADBAND"] / 100

    def _parse(
        self, received: Received, message: ManualControl | RoverOperatorPresence, now: float, lifetime: float
    ) -> Demand | None:
        """Return the demand of a message; one that is too old on arrival has no lifetime of its own (`_use_old`)."""
        lasting = math.inf if lifetime < 0.0 else lifetime
        age = max(0.0, self._params["OPR_ECHO_MAX"] - lifetime) if math.isfinite(lifetime) else 0.0
        return from_manual_control(
            message, received.system, received.sequence, now, sideways=self._sideways, lifetime=lasting, age=age
        )

    def _use(self, demand: Demand, now: float, *, proof: bool = True) -> bool:
        self.expire_stale_demand(now)
        self.demand = demand
        if proof and demand.is_neutral(self.deadband):
            self.neutral_seen = True
        return True

    def _use_old(self, demand: Demand, now: float) -> bool:
        """Use a demand older than OPR_ECHO_MAX if it requests no motion; else report it."""
        if not demand.requests_motion(self.deadband):
            return self._use(demand, now, proof=False)  # an old stop still stops, but proves no stick at rest
        text = "Demands rejected: older than OPR_ECHO_MAX on arrival"
        self._texts.send_once("demand stale", Severity.WARNING, text, now)
        return False

    def _accepts(self, received: Received, target: int, now: float) -> bool:
        """Return whether a demand without a proof counts: of a driver without sessions, and of no other.

        While it is barred, or repeats old frames, it moves nothing either.
        """
        if target != self.system or not received.introduced:
            return False
        if not self.ownership.is_driver(received, now):
            self._reject_demand(received, now)
            return False
        return self.ownership.accepts_unproven_demand(now)

    def _reject_demand(self, received: Received, now: float) -> None:
        """Report the demand of a ground station that is not in control, once."""
        self.not_in_control_count += 1
        if self.ownership.may_be_link(received, now):
            return
        reason = self.ownership.denial_reason(received, now) or "no GCS is in control, arm to take it"
        key = f"demand {received.system}/{received.component} {received.peer}"
        text = f"Demand from GCS {received.system} ignored: {reason}"
        self._texts.reply_once(key, received, Severity.WARNING, text, now)

    def _report_invalid(self, received: Received, problem: str, now: float) -> None:
        """Report an invalid message once: a wrong joystick program sends it all the time."""
        text = f"GCS {received.system}: {problem}"
        self._texts.reply_once(f"demand invalid {received.system}", received, Severity.WARNING, text, now)


def _is_out_of_range(axis: int) -> bool:
    return abs(axis) > FULL_DEFLECTION and axis != INVALID_AXIS
