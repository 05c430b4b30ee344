"""Whose demand counts, how old it is, and whether a stick at rest was seen first; not what it may do (gate.py).

Neutral first: after arming, choosing a mode, a failsafe, a lost demand, a change of driver or an emergency stop, a
demand counts only once the driver in control has sent a neutral one. A stick that was held all the while, or a ground
station that repeats an old demand, moves nothing.
"""

from __future__ import annotations

from dialects import axes
from dialects.enums import DriveType, Severity
from dialects.messages import INVALID_AXIS, ManualControl, RcChannelsOverride, RoverOperatorPresence
from link.core import Received
from vehicle.drive.demand import Demand, RcOverride, from_manual_control
from vehicle.drive.mixer import MIXERS
from vehicle.drive.operator_presence import OperatorPresence
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue


class Control:
    """The ground station in control ("owner", by system id; 0 is nobody) and its demand."""

    def __init__(self, params: Params, texts: StatusTextQueue, *, system: int, boot: float) -> None:
        self.owner = 0
        self.takeover_allowed = False
        """Others may take control without asking the owner."""
        self.demand: Demand | None = None
        """The owner's newest since it took control or chose a mode, however old."""
        self.neutral_seen = False
        self.not_in_control_count = 0
        """Demands of ground stations that are not in control."""
        self.presence = OperatorPresence()
        self.override = RcOverride()
        self._params = params
        self._sideways = MIXERS[DriveType(int(params["DRIVE_TYPE"]))].sideways
        self._texts = texts
        self.system = system
        self._boot = boot
        self._heard = boot

    # Who is in control

    def set_owner(self, system: int, now: float) -> None:
        """`system` is in control from now on."""
        self._heard = now
        if system == self.owner:
            return
        self.owner = system
        self.takeover_allowed = False
        self.presence = OperatorPresence()
        self.reset()
        self._texts.reset_once("demand")
        self._texts.send(Severity.NOTICE, f"GCS {system} is in control", now)

    def release(self, why: str, now: float) -> None:
        """Nobody is in control."""
        self._texts.send(Severity.NOTICE, f"Nobody is in control: GCS {self.owner} {why}", now)
        self._texts.reset_once("demand")
        self.owner = 0
        self.reset()

    def allow_takeover(self, allowed: bool) -> None:
        """Let others take control without asking the owner, or not."""
        self.takeover_allowed = allowed

    def takeover_denial_reason(self, system: int, now: float) -> str | None:
        """Why `system` may not take control, or None where it may."""
        reason = self.denial_reason(system)
        if self._fixed_other(system) or not (self.takeover_allowed or self.is_owner_lost(now)):
            return reason
        return None

    def denial_reason(self, system: int) -> str | None:
        """Why `system` may not command as it stands, or None: it is in control, or nobody is."""
        if self._fixed_other(system):
            return f"only GCS {self._params['MAV_GCS_SYSID']:g} may (MAV_GCS_SYSID)"
        return None if self.owner in (0, system) else f"GCS {self.owner} is in control"

    def _fixed_other(self, system: int) -> bool:
        return self._params["MAV_GCS_SYSID"] not in (0, system)

    def update_liveness(self, received: Received, now: float) -> None:
        """Anything of the owner is a sign of its life: counting heartbeats alone gave false alarms on lossy links."""
        if received.introduced and received.system == self.owner:
            self._heard = now

    def silence_duration(self, now: float) -> float:
        """s since the owner was heard, or since somebody last was the owner."""
        return now - self._heard

    def is_owner_lost(self, now: float) -> bool:
        """The owner is silent for too long."""
        return self.silence_duration(now) > self._params["FS_GCS_TIMEOUT"]

    # Its demand

    def handle_manual_control(self, received: Received, message: ManualControl, now: float) -> bool:
        """Take a MANUAL_CONTROL; True where it is the demand now."""
        if not self._listens(received, message.target, now):
            return False
        if self.demand and self.demand.sequence == received.sequence:
            return False  # the same packet again: a replay
        demand = from_manual_control(message, received.system, received.sequence, now, sideways=self._sideways)
        if any(abs(axis) > axes.FULL_DEFLECTION and axis != INVALID_AXIS for axis in (message.x, message.r)):
            self._tell_nonsense(received.system, "axes out of -1000..1000 count as neutral", now)
        if demand is None:
            return False
        if not self._echo_is_stale():
            return self._use(demand, now)
        # An old wish to stop is still a wish to stop; it is no proof of a stick at rest now.
        return self._refuse_old(now) if demand.requests_motion(self.deadband) else self._use(demand, now, proof=False)

    def handle_rc_override(self, received: Received, message: RcChannelsOverride, now: float) -> bool:
        """Take an RC_CHANNELS_OVERRIDE; True where it is the demand now."""
        if not self._listens(received, message.target_system, now):
            return False
        spoken = self.override.update(message, now)
        if self.override.has_invalid_value:
            self._tell_nonsense(received.system, "channels out of 800..2200 us are ignored", now)
        if not spoken:
            return False
        timeout = self._params["MAN_TIMEOUT"]
        return self._use(self.override.build_demand(received.system, received.sequence, now, timeout), now)

    def handle_operator_presence(self, received: Received, message: RoverOperatorPresence, now: float) -> None:
        """Take the word on the operator that goes before a demand. It needs no text where it is ignored."""
        if message.target_system != self.system or not received.introduced or received.system != self.owner:
            return
        if self.presence.handle(message, now - self._boot, now):
            self.require_neutral()

    def demand_age(self, now: float) -> float | None:
        """s since the demand came; None without one."""
        return None if self.demand is None else now - self.demand.time

    def is_demand_stale(self, now: float) -> bool:
        """The demand is too old to count. False where there has been none."""
        age = self.demand_age(now)
        return age is not None and age > self._params["MAN_TIMEOUT"]

    def requests_motion(self) -> bool:
        """The demand, however old, asks for motion."""
        return self.demand is not None and self.demand.requests_motion(self.deadband)

    def expire_stale_demand(self, now: float) -> None:
        """A demand for motion that went stale is over: what comes back must begin with neutral.

        A stale neutral does not close the interlock before its failsafe does: a driver at rest sends at 5 Hz, and two
        lost frames must not swallow the next key.
        """
        if self.is_demand_stale(now) and self.requests_motion():
            self.require_neutral()

    def require_neutral(self) -> None:
        """Neutral first, again."""
        self.neutral_seen = False

    def reset(self) -> None:
        """Forget the demand: neutral first, and no age."""
        self.require_neutral()
        self.demand = None
        self.override.channels.clear()

    @property
    def deadband(self) -> float:
        """Demands up to this are neutral."""
        return self._params["MAN_DEADBAND"] / 100

    def _use(self, demand: Demand, now: float, *, proof: bool = True) -> bool:
        self.expire_stale_demand(now)
        self.demand = demand
        if proof and demand.is_neutral(self.deadband):
            self.neutral_seen = True
        return True

    def _listens(self, received: Received, target: int, now: float) -> bool:
        if target != self.system or not received.introduced:
            return False
        if received.system == self.owner:
            return True
        self.not_in_control_count += 1
        reason = f"GCS {self.owner} is in control" if self.owner else "nobody is in control, arm to take it"
        text = f"Demand of GCS {received.system} ignored: {reason}"
        self._texts.send_once(f"demand {received.system}", Severity.WARNING, text, now)
        return False

    def _tell_nonsense(self, system: int, what: str, now: float) -> None:
        """Once: a wrong joystick program sends it all the time, and its driver wonders why nothing moves."""
        self._texts.send_once(f"demand nonsense {system}", Severity.WARNING, f"GCS {system}: {what}", now)

    def _echo_is_stale(self) -> bool:
        return self.presence.known and self.presence.echo_age > self._params["OPR_ECHO_MAX"]

    def _refuse_old(self, now: float) -> bool:
        text = "Demands refused: they are old when they arrive (OPR_ECHO_MAX)"
        self._texts.send_once("demand stale", Severity.WARNING, text, now)
        return False
