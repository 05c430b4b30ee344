"""Arming sequence of one vehicle: neutral demands, mode MANUAL, arm, confirmation by the heartbeat.

NEUTRAL --frames sent--> MODE --accepted--> ARM --accepted--> CONFIRM --heartbeat: armed--> DONE
   |                       |                 |                   |
   |  mode is drivable     |  refused        |  refused          |  3 s without it
   +---------------------->ARM               +-> DONE            +-> DONE
                           +-> DONE

The texts of refusals are made in commander.py.
"""

from __future__ import annotations

from enum import Enum, auto

import msgspec

from dialects.enums import Command, Result
from dialects.kinds import MANUAL
from dialects.modes import set_mode_params
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

NEUTRAL_FIRST = 0.12
"""s of neutral demands before the commands: three frames. ArduPilot refuses to arm with the throttle off neutral."""

CONFIRM_WITHIN = 3.0
"""s for the heartbeat to report what was acknowledged: three heartbeats."""


class ArmStep(Enum):
    """Step of the arming sequence."""

    NEUTRAL = auto()
    """Sending neutral demands."""
    MODE = auto()
    """Waiting for the acknowledgement of DO_SET_MODE."""
    ARM = auto()
    """Waiting for the acknowledgement of COMPONENT_ARM_DISARM."""
    CONFIRM = auto()
    """Acknowledged; waiting for a heartbeat that reports armed."""
    DONE = auto()


class ArmSequence(msgspec.Struct):
    """One attempt to arm one vehicle."""

    vehicle: VehicleState
    due: float
    """When the current step ends."""
    step: ArmStep = ArmStep.NEUTRAL
    failure: str | None = None
    """Why arming failed, other than a refusal."""

    @classmethod
    def start(cls, vehicle: VehicleState, now: float) -> ArmSequence:
        """Start with neutral demands, unless the vehicle takes none before arming (driver 0: nobody in control)."""
        return cls(vehicle, now if vehicle.driver == 0 else now + NEUTRAL_FIRST)

    def tick(self, client: CommandClient, now: float) -> None:
        """Take the next step when it is due."""
        if self.step is ArmStep.NEUTRAL and now >= self.due:
            self._mode_or_arm(client, now)
        elif self.step is ArmStep.CONFIRM and not (doubt := find_arming_doubt(self.vehicle, now)):
            self.step = ArmStep.DONE
        elif self.step is ArmStep.CONFIRM and now >= self.due:
            self.step, self.failure = ArmStep.DONE, f"arming acknowledged, but {doubt}"

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, now: float) -> None:
        """Take the next step after the acknowledgement of a command, or end the sequence."""
        waited_for = {ArmStep.MODE: Command.DO_SET_MODE, ArmStep.ARM: Command.COMPONENT_ARM_DISARM}.get(self.step)
        if outcome.command != waited_for:
            return
        if outcome.result is not Result.ACCEPTED:
            self.step = ArmStep.DONE
        elif self.step is ArmStep.MODE:
            self._arm(client, now)
        else:
            self.step, self.due = ArmStep.CONFIRM, now + CONFIRM_WITHIN

    def _mode_or_arm(self, client: CommandClient, now: float) -> None:
        if not _needs_manual(self.vehicle):
            self._arm(client, now)
            return
        self.step = ArmStep.MODE
        mode = self.vehicle.model.drive_mode
        if not send_mode(client, self.vehicle, mode, now):
            self.step, self.failure = ArmStep.DONE, f"arm: {self.vehicle.name} has no mode {mode}"

    def _arm(self, client: CommandClient, now: float) -> None:
        self.step = ArmStep.ARM
        client.send(
            Command.COMPONENT_ARM_DISARM,
            1,
            target_system=self.vehicle.system,
            target_component=self.vehicle.component,
            now=now,
        )


def find_arming_doubt(vehicle: VehicleState, now: float) -> str:
    """Return which sender of its id does not report armed, in words; "" if the last report of each does.

    A script on board that claims to be the autopilot does not arm.
    """
    return vehicle.senders.find_doubt(now, lambda sender: sender.armed or sender.component != vehicle.component)


def _needs_manual(vehicle: VehicleState) -> bool:
    """Return whether to change to MANUAL before arming. An autonomous mode was chosen on purpose and is kept."""
    if vehicle.model.flies:
        return vehicle.mode not in vehicle.model.keys
    if vehicle.model.arms_only_in_manual:
        return vehicle.mode != MANUAL
    return vehicle.mode in vehicle.model.standing


def send_mode(client: CommandClient, vehicle: VehicleState, name: str, now: float) -> bool:
    """Send DO_SET_MODE, and return True; False, without a command, if a vehicle of this kind has no such mode."""
    number = vehicle.model.number_of(name) if vehicle.model.is_driven else None
    if number is None:
        return False
    client.send(
        Command.DO_SET_MODE,
        *set_mode_params(number, vehicle.autopilot),
        target_system=vehicle.system,
        target_component=vehicle.component,
        now=now,
    )
    return True
