"""A verb as the operator of a vehicle: the proofs of its session, and the demands that it sends. Time is an argument.

Our vehicle obeys a session that was proven in the last second (docs/safety.md, "Who the driver is"). So a verb that
takes or needs control proves a session of its own while it runs, once the vehicle is known to have our dialect.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects import messages as m
from dialects.axes import NEUTRAL, Axes, build_manual_control
from dialects.enums import OperatorFlag
from groundstation.station.driving.proofs import IDLE_PROOF_PERIOD, InputRecord, SessionProofs
from groundstation.station.verbs.running_verbs import Purpose, VerbMessage
from groundstation.vehicles.demand.demand_stream import DemandStream
from groundstation.vehicles.fleet import Contact

PROOFS_FIRST, FIRST_PERIOD = 5, 0.008
"""Proofs before the first command, and s between them: four of five may get lost."""
PROVEN_FOR = 0.5
"""s after these proofs for which commands follow without such proofs again. Our vehicle lets a session take or succeed
control that was proven in the last second (PROOF_VALID), and where frames get lost four single proofs may be."""
FRESH_TIME = 0.3
"""s since a time of the vehicle has arrived with which these proofs are sent: one that is older than OPR_ECHO_MAX when
it is back proves nothing, and where frames get lost the newest may be that old. Our vehicle sends four a second."""


class VerbOperator:
    """This program as the operator of one vehicle. Nothing is sent before `begin`."""

    def __init__(self, contact: Contact, proofs: SessionProofs, outbox: list[VerbMessage]) -> None:
        self._contact, self._state = contact, contact.state
        self._proofs = proofs
        self.inputs = InputRecord()
        """Keys of a script, and the beginnings of demands."""
        self._moves = False
        """The newest demand is not neutral."""
        self.takes_part = False
        """`begin` was called."""
        self._first_left = PROOFS_FIRST
        self._settled_at = -math.inf
        self._proven_at = -math.inf
        self._stream = DemandStream()
        self._outbox = outbox
        self.demanding = False
        """Demands are sent, those of `demand`. When it ends, final neutral ones follow."""
        self.demand: Callable[[float], Axes] = lambda _: NEUTRAL
        """Takes the time; returns what to demand while `demanding`."""
        self.may_prove: Callable[[float], bool] = lambda _: True
        """Takes the time; returns whether this program may prove the session, which another verb may use."""

    def begin(self, now: float) -> None:
        """Begin to take part."""
        if not self.takes_part:
            self.takes_part = True
            self.inputs.add(now)

    def flags(self, now: float) -> OperatorFlag:
        """Return what a proof tells of this operator."""
        return OperatorFlag.SCRIPT | (OperatorFlag.DEADMAN if self._moves else OperatorFlag(0))

    def prove_again(self, now: float) -> None:
        """Begin the first proofs again, if the session was proven and they are older than PROVEN_FOR."""
        if self.proven and self.proves and now - self._settled_at > PROVEN_FOR and self.may_prove(now):
            self._first_left = PROOFS_FIRST

    @property
    def proven(self) -> bool:
        """Whether the first proofs were sent."""
        return not self._first_left

    @property
    def proves(self) -> bool:
        """Whether the vehicle takes its demands from proofs of the session."""
        return self._proven_at > -math.inf

    @property
    def finished(self) -> bool:
        """Whether no final neutral is left to send."""
        return self._stream.finished and not self._outbox

    def tick(self, now: float) -> None:
        """Prove the session, send demands."""
        if not self.takes_part:
            return
        axes = self._stream.next_due(self.demand(now) if self.demanding else NEUTRAL, self.demanding, now)
        if axes is not None:
            demand = build_manual_control(axes, self._state.system, self._contact.choose_axes(axes))
            self.send_demand(demand, now, moves=not axes.neutral)
        self._prove(now)

    def send_demand(self, demand: m.ManualControl, now: float, *, moves: bool) -> None:
        """Send a demand, as the station does: our vehicle takes it from the proof, others from MANUAL_CONTROL.

        `moves`: it is not neutral.
        """
        self._moves, purpose = moves, Purpose.MOTION if moves else Purpose.NEUTRAL
        if self.proves or self._state.has_rover_dialect:
            self._add_proof(demand, now, purpose)
        self._outbox.append(VerbMessage(demand, purpose))

    def _prove(self, now: float) -> None:
        """Prove the session once a time of the vehicle is known: without it a proof proves nothing."""
        period, age = (FIRST_PERIOD, FRESH_TIME) if self._first_left else (IDLE_PROOF_PERIOD, math.inf)
        known = self._state.has_rover_dialect and self._state.boot_time is not None
        if known and now - self._state.boot_time_at <= age and now - self._proven_at >= period and self.may_prove(now):
            self._add_proof(None, now, Purpose.PROOF)

    def _add_proof(self, demand: m.ManualControl | None, now: float, purpose: Purpose) -> None:
        proof = self._proofs.build(self._state, self, now, demand)
        self._proven_at = now
        if self._first_left:
            self._first_left -= 1
            self._settled_at = now
        self._outbox.append(VerbMessage(proof, purpose))
