"""Emergency stop of one vehicle: requested until acknowledged AND the heartbeat reports disarmed.

Two commands, because vehicles differ: the safety switch (locks our rover) and a forced disarm (ArduPilot, PX4).
"""

from __future__ import annotations

import math

import msgspec

from dialects.enums import Command, Result
from groundstation.snapshot import EmergencyProgress
from groundstation.vehicles.demand.stop_commands import DANGEROUS, FORCED, LOCK, SAFE, send_stop
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

RETRY_PERIOD = 0.5
"""s between rounds of requests; within a round the command client repeats each command (0.35 s)."""

ACK_TIMEOUT = 1.0
"""s without an acknowledgement after which the request counts as not acknowledged: three repeats of each command."""


class EmergencyLock(msgspec.Struct):
    """One emergency stop, from the key until it is cleared."""

    vehicle: VehicleState
    since: float
    """When the stop was requested."""
    due: float = -math.inf
    rounds: int = 0
    switch_answered: bool = False
    """The safety switch command was acknowledged, with whatever result."""
    disarm_answered: bool = False
    """The forced disarm was acknowledged, with whatever result."""
    accepted: bool = False
    """The vehicle has accepted one of the two."""
    switched: bool = False
    """It has accepted the safety switch command, so that it is locked until the release."""
    clearing: bool = False
    """The operator has requested the release; requesting the stop meanwhile would race with that."""

    def tick(self, client: CommandClient, now: float) -> None:
        """Repeat what is not acknowledged, or acknowledged but not done."""
        if self.clearing or now < self.due:
            return
        self.due = now + RETRY_PERIOD
        if not self.switch_answered:
            send_stop(client, self.vehicle, LOCK, now, attempt=self.rounds)
        if not self.disarm_answered or self.doubt(now):
            send_stop(client, self.vehicle, FORCED, now, attempt=self.rounds)
        self.rounds += 1

    def clear(self, client: CommandClient, now: float) -> None:
        """Request the release of the lock."""
        self.clearing = True
        client.send(
            Command.DO_SET_SAFETY_SWITCH_STATE,
            DANGEROUS,
            target_system=self.vehicle.system,
            target_component=self.vehicle.component,
            now=now,
        )

    def doubt(self, now: float) -> str:
        """Return which sender of its id does not report that it is disarmed; "" if the last report of each does."""
        return self.vehicle.senders.find_doubt(now, since=self.since)

    def progress(self, now: float) -> EmergencyProgress:
        """Return how far the request is."""
        if self.accepted:
            return EmergencyProgress.ACCEPTED
        if self.switch_answered and self.disarm_answered:
            return EmergencyProgress.REFUSED
        return EmergencyProgress.SENT if now - self.since <= ACK_TIMEOUT else EmergencyProgress.UNANSWERED

    def handle_outcome(self, outcome: CommandOutcome) -> None:
        """Record the acknowledgement of a command of this vehicle, or that none came after all repeats."""
        if _requests_stop(outcome) and outcome.result is Result.ACCEPTED:
            self.accepted = True
            self.switched |= outcome.command == Command.DO_SET_SAFETY_SWITCH_STATE
        if outcome.command == Command.DO_SET_SAFETY_SWITCH_STATE:
            if outcome.params[0] == DANGEROUS:
                self.clearing = False
            elif outcome.result is not None:
                self.switch_answered = True
        elif outcome.command == Command.COMPONENT_ARM_DISARM and outcome.result is not None:
            self.disarm_answered = True


def _requests_stop(outcome: CommandOutcome) -> bool:
    """Return whether this is one of the two commands of the stop, and not its release."""
    if outcome.command == Command.DO_SET_SAFETY_SWITCH_STATE:
        return outcome.params[0] == SAFE
    return outcome.command == Command.COMPONENT_ARM_DISARM and outcome.params[0] == 0
