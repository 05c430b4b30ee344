"""SessionProofs: ROVER_OPERATOR_PRESENCE of one session, for screens and verbs. Time is an argument.

Our vehicle obeys a session that was proven in the last second (docs/safety.md, "Who the driver is"). All that operates
vehicles in the name of one session proves it by one clock: our vehicle takes no proof that is not newer than the last.
"""

from __future__ import annotations

from typing import Protocol

import msgspec

from dialects.enums import OperatorFlag
from dialects.messages import INVALID_AXIS, ManualControl, RoverOperatorPresence, boot_ms
from groundstation.vehicles.state.vehicle_state import VehicleState

IDLE_PROOF_PERIOD = 0.25
"""s between proofs of this session to the selected vehicle of our dialect while it gets no demand: arming, and every
other command, counts only of a session that was proven in the last second, and two proofs in a row may get lost."""

OLDEST_AGE = 0xFFFF
"""Largest last_input_age_ms: older, or no input yet."""


class InputRecord(msgspec.Struct):
    """The inputs of an operator: keys and sticks, or what begins a demand of a verb."""

    count: int = 0
    at: float | None = None
    """When the last one came; None without any."""

    def add(self, now: float) -> None:
        """Count an input."""
        self.count += 1
        self.at = now

    def age(self, now: float) -> float | None:
        """Return the time since the last input, s; None without any."""
        return None if self.at is None else now - self.at


class ProvenOperator(Protocol):
    """Who operates."""

    inputs: InputRecord

    def flags(self, now: float) -> OperatorFlag:
        """Return what a proof tells of the operator."""


class SessionProofs:
    """The proofs of one session. `session` is a random number that distinguishes it from others."""

    def __init__(self, session: int) -> None:
        self.session = session
        self._clock = 0

    def build(
        self, state: VehicleState, operator: ProvenOperator, now: float, demand: ManualControl | None = None
    ) -> RoverOperatorPresence:
        """Build a demand with its proof, or the proof alone: an echo of the newest time_boot_ms of the vehicle.

        Our vehicle obeys the axes in it and ignores the MANUAL_CONTROL that follows, which may be a copy or late.
        """
        self._clock = max(self._clock + 1, boot_ms(now))  # larger than the one before, also within the same ms
        age = operator.inputs.age(now)
        return RoverOperatorPresence(
            target_system=state.system,
            target_component=state.component,
            time_boot_ms=self._clock & 0xFFFFFFFF,
            echo_time_boot_ms=state.boot_time or 0,
            session_id=self.session,
            input_count=operator.inputs.count & 0xFFFFFFFF,
            last_input_age_ms=OLDEST_AGE if age is None else min(OLDEST_AGE, int(age * 1000)),
            flags=operator.flags(now) | OperatorFlag.AXES,
            x=demand.x if demand else INVALID_AXIS,
            y=INVALID_AXIS,
            z=INVALID_AXIS,
            r=demand.r if demand else INVALID_AXIS,
        )
