"""The way to an armed vehicle, step by step; each step waits for the answer of the one before. Not the refusal texts.

NEUTRAL --frames sent--> MODE --accepted--> ARM --accepted--> CONFIRM --heartbeat says armed--> DONE
   |                       |                 |                   |
   |  already drivable     |  refused        |  refused          |  3 s without it
   +---------------------->ARM               +-> DONE            +-> DONE
                           +-> DONE
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from dialects.enums import Autopilot, Command, ModeFlag, Result
from dialects.modes import Mode, custom_mode
from groundstation.vehicles.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

NEUTRAL_FIRST = 0.12
"""s of neutral demands before the commands: three frames. ArduPilot refuses to arm with the throttle off neutral."""

CONFIRM_WITHIN = 3.0
"""s for the heartbeat to say what the acknowledgement said: three heartbeats."""


class ArmStep(Enum):
    """Where the arming stands."""

    NEUTRAL = auto()
    """Neutral demands are being sent."""
    MODE = auto()
    """Waiting for the answer to DO_SET_MODE."""
    ARM = auto()
    """Waiting for the answer to COMPONENT_ARM_DISARM."""
    CONFIRM = auto()
    """Acknowledged; the heartbeat has to say so too."""
    DONE = auto()


@dataclass(slots=True)
class ArmSequence:
    """One try to arm one vehicle."""

    vehicle: VehicleState
    due: float
    """When the step of now ends by itself."""
    step: ArmStep = ArmStep.NEUTRAL
    failure: str | None = None
    """What went wrong besides a refusal."""

    @classmethod
    def start(cls, vehicle: VehicleState, now: float) -> ArmSequence:
        """Start with neutral demands, where it takes any before arming (driver 0: it obeys nobody yet)."""
        return cls(vehicle, now if vehicle.driver == 0 else now + NEUTRAL_FIRST)

    def tick(self, client: CommandClient, now: float) -> None:
        """Go on when it is time."""
        if self.step is ArmStep.NEUTRAL and now >= self.due:
            self._mode_or_arm(client, now)
        elif self.step is ArmStep.CONFIRM and self.vehicle.armed:
            self.step = ArmStep.DONE
        elif self.step is ArmStep.CONFIRM and now >= self.due:
            self.step, self.failure = ArmStep.DONE, "the vehicle acknowledged arming, but its heartbeat says disarmed"

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, now: float) -> None:
        """An answer of this vehicle came."""
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
        send_mode(client, self.vehicle, Mode.MANUAL, now)

    def _arm(self, client: CommandClient, now: float) -> None:
        self.step = ArmStep.ARM
        client.send(
            Command.COMPONENT_ARM_DISARM,
            1,
            target_system=self.vehicle.system,
            target_component=self.vehicle.component,
            now=now,
        )


def _needs_manual(vehicle: VehicleState) -> bool:
    """A driver who arms wants to drive. Modes that drive by themselves are left as the operator chose them."""
    if vehicle.autopilot == Autopilot.PX4:
        return vehicle.mode != "MANUAL"
    return vehicle.mode in (Mode.HOLD.name, Mode.INITIALISING.name)


def send_mode(client: CommandClient, vehicle: VehicleState, mode: Mode, now: float) -> None:
    """Ask for a mode. Raises ValueError where the autopilot has none of the kind."""
    main, sub = custom_mode(mode, vehicle.autopilot)
    client.send(
        Command.DO_SET_MODE,
        ModeFlag.CUSTOM,
        main,
        sub,
        target_system=vehicle.system,
        target_component=vehicle.component,
        now=now,
    )
