"""Which ground station is in control, its demand and the age of it, and the neutral-first interlock.

Neutral first: after arming, a mode change, a failsafe, a lost demand, a change of control or an emergency stop, a
demand counts only once the ground station in control has sent a neutral one. A stick that was held all the while, or a
ground station that repeats an old demand, moves nothing. The last gate (vehicle/drive/gate.py) decides about motion.
"""

from __future__ import annotations

from dialects import axes
from dialects.enums import DriveType, Severity
from dialects.messages import INVALID_AXIS, ManualControl, RcChannelsOverride, RoverOperatorPresence
from link.core import Received
from vehicle.drive.demand import Demand, RcOverride, from_manual_control
from vehicle.drive.mixer import MIXERS
from vehicle.drive.operator_presence import OperatorPresence
from vehicle.drive.operator_session import DemandOrder, DrivingSession, Proof, RecentProofs, Source, parse_proof
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue


class Control:
    """The ground station in control ("owner", by system id; 0 if there is none) and its demand."""

    def __init__(self, params: Params, texts: StatusTextQueue, *, system: int, boot: float) -> None:
        self.owner = 0
        self.takeover_allowed = False
        """Other ground stations may take control without the consent of the owner."""
        self.demand: Demand | None = None
        """The newest demand since the owner took control or chose a mode, of any age."""
        self.neutral_seen = False
        self.not_in_control_count = 0
        """Number of demands from ground stations that are not in control."""
        self.presence = OperatorPresence()
        self.override = RcOverride()
        self.session: DrivingSession | None = None
        """The session of the owner; None for a ground station whose demands carry no proof of their age."""
        self._proofs = RecentProofs()
        self._succeeded = False
        self._params = params
        self._sideways = MIXERS[DriveType(int(params["DRIVE_TYPE"]))].sideways
        self._texts = texts
        self.system = system
        self._boot = boot
        self._last_heard = boot

    # Ownership

    def set_owner(self, system: int, now: float, source: Source | None = None) -> None:
        """Give control to `system`; to the session that `source`, the sender of the request, has proven.

        Without a proof in the last second it counts as a ground station without sessions, until it takes control again:
        a proof that comes later may be that of another program with the same system id.
        """
        self._last_heard = now
        if system == self.owner:
            self.session = self.session or self._proofs.session_of(source, now)
            return
        self.owner = system
        self.session = self._proofs.session_of(source, now)
        self.takeover_allowed = False
        self.presence = OperatorPresence()
        self.reset()
        self._texts.reset_once("demand")
        self._texts.send_event(Severity.NOTICE, f"GCS {system} is in control", now)

    def release(self, why: str, now: float) -> None:
        """Release control; `why` completes the STATUSTEXT."""
        self._texts.send_event(Severity.NOTICE, f"No GCS is in control: GCS {self.owner} {why}", now)
        self._texts.reset_once("demand")
        self.owner = 0
        self.session = None
        self.reset()

    def allow_takeover(self, allowed: bool) -> None:
        """Let others take control without asking the owner, or not."""
        self.takeover_allowed = allowed

    def takeover_denial_reason(self, system: int, now: float) -> str | None:
        """Return why `system` may not take control, or None if it may."""
        reason = self.denial_reason(system)
        if self._fixed_other(system) or not (self.takeover_allowed or self.is_owner_lost(now)):
            return reason
        return None

    def denial_reason(self, system: int) -> str | None:
        """Return why `system` may not command, or None if it is in control or no station is."""
        if self._fixed_other(system):
            return f"only GCS {self._params['MAV_GCS_SYSID']:g} may control (MAV_GCS_SYSID)"
        return None if self.owner in (0, system) else f"GCS {self.owner} is in control"

    def _fixed_other(self, system: int) -> bool:
        return self._params["MAV_GCS_SYSID"] not in (0, system)

    def update_liveness(self, received: Received, now: float) -> None:
        """Note a message of the owner as a sign of life: heartbeats alone gave false alarms on lossy links.

        Of a session only proofs count (`_handle_proof`): any program may send heartbeats with its system id.
        """
        if received.introduced and received.system == self.owner and self.session is None:
            self._last_heard = now

    def silence_duration(self, now: float) -> float:
        """Return the s since the last message of the owner, or since there was one."""
        return now - self._last_heard

    def is_owner_lost(self, now: float) -> bool:
        """Return True if the owner has sent nothing for FS_GCS_TIMEOUT."""
        return self.silence_duration(now) > self._params["FS_GCS_TIMEOUT"]

    # Demand

    def handle_manual_control(self, received: Received, message: ManualControl, now: float) -> bool:
        """Handle a MANUAL_CONTROL; return True if it is the demand now."""
        if not self._accepts(received, message.target, now) or not self._accepts_without_proof(now):
            return False
        if self.demand and self.demand.sequence == received.sequence:
            return False  # a replay of the same packet
        demand = from_manual_control(message, received.system, received.sequence, now, sideways=self._sideways)
        if any(abs(axis) > axes.FULL_DEFLECTION and axis != INVALID_AXIS for axis in (message.x, message.r)):
            self._report_invalid(received, "axes outside -1000..1000 count as neutral", now)
        if demand is None:
            return False
        return self._use_old(demand, now) if self._echo_is_stale() else self._use(demand, now)

    def handle_rc_override(self, received: Received, message: RcChannelsOverride, now: float) -> bool:
        """Handle an RC_CHANNELS_OVERRIDE; return True if it is the demand now."""
        if not self._accepts(received, message.target_system, now) or not self._accepts_without_proof(now):
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
        if message.target_system != self.system or not received.introduced:
            return False
        proof = parse_proof(message, now - self._boot)
        good = proof is not None and proof.age <= self._params["OPR_ECHO_MAX"]
        if proof is not None and good:
            self._proofs.add(Source.of(received), proof, now)
        if received.system != self.owner:
            return False
        if self.session is not None:
            return proof is not None and self._handle_proof(received, message, proof, now, good=good)
        if self.presence.handle(message, now - self._boot, now):
            self.require_neutral()
        return False

    def pop_succession(self) -> bool:
        """Return True once after another session has taken over without having been granted control."""
        succeeded, self._succeeded = self._succeeded, False
        return succeeded

    def _handle_proof(
        self, received: Received, message: RoverOperatorPresence, proof: Proof, now: float, *, good: bool
    ) -> bool:
        """Handle a proof with the owner's system id while a session is in control."""
        demand = from_manual_control(message, received.system, received.sequence, now, sideways=self._sideways)
        session = self.session
        if session is None or proof.session != session.id:
            session = self._succeed(proof, now) if good and demand else None
        if session is None:
            return False
        if good:
            session.proven_at = self._last_heard = now
            self.presence.handle(message, now - self._boot, now)
        if demand is None or session.order(proof) is not DemandOrder.NEWEST:
            return False
        if good:
            used = self._use(demand._replace(lifetime=self._params["OPR_ECHO_MAX"] - proof.age), now)
        else:
            used = self._use_old(demand, now)
        if used:
            session.clock = proof.clock
        return used

    def _succeed(self, proof: Proof, now: float) -> DrivingSession | None:
        """Return another session with the owner's system id as successor if the owner's is silent; else report it."""
        if self.session is not None and not self.session.may_be_succeeded(now):
            text = f"Another program uses system id {self.owner}: it cannot drive"
            self._texts.send_once("demand session", Severity.WARNING, text, now)  # one: session ids are free to invent
            return None
        successor = DrivingSession(proof.session, now)
        self._replace_session(successor, now)
        return successor

    def _accepts_without_proof(self, now: float) -> bool:
        """Return whether a demand without a proof counts: not while the owner's session lives.

        A ground station without sessions may follow one with its system id that is lost.
        """
        if self.session is None:
            return True
        if not self.is_owner_lost(now):
            return False
        self._replace_session(None, now)
        return True

    def _replace_session(self, session: DrivingSession | None, now: float) -> None:
        self.session = session
        self.presence = OperatorPresence()
        self.reset()
        self._last_heard = now
        self._succeeded = True
        text = f"GCS {self.owner} drives from another program now: release the keys first"
        self._texts.send(Severity.NOTICE, text, now)

    def demand_age(self, now: float) -> float | None:
        """Return the s since the demand arrived; None without one."""
        return None if self.demand is None else now - self.demand.time

    def is_demand_stale(self, now: float) -> bool:
        """Return True if the demand is older than `demand_timeout`; False without one."""
        age = self.demand_age(now)
        return age is not None and age > self.demand_timeout

    @property
    def demand_timeout(self) -> float:
        """Age in s from which on the demand in use is stale: MAN_TIMEOUT, or sooner if its proof ends."""
        timeout: float = self._params["MAN_TIMEOUT"]
        return timeout if self.demand is None else min(timeout, self.demand.lifetime)

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
        if target != self.system or not received.introduced:
            return False
        if received.system == self.owner:
            return True
        self.not_in_control_count += 1
        reason = f"GCS {self.owner} is in control" if self.owner else "no GCS is in control, arm to take it"
        text = f"Demand from GCS {received.system} ignored: {reason}"
        self._texts.reply_once(f"demand {received.system}", received, Severity.WARNING, text, now)
        return False

    def _report_invalid(self, received: Received, problem: str, now: float) -> None:
        """Report an invalid message once: a wrong joystick program sends it all the time."""
        text = f"GCS {received.system}: {problem}"
        self._texts.reply_once(f"demand invalid {received.system}", received, Severity.WARNING, text, now)

    def _echo_is_stale(self) -> bool:
        return self.presence.known and self.presence.echo_age > self._params["OPR_ECHO_MAX"]
