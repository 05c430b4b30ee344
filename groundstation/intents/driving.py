"""Intents that drive, stop, and set how keys drive."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.intents.vehicle_intent import Commands, Vehicle, VehicleIntent

PAD = "gamepad"
"""What the held keys name while the gamepad drives."""

STOP_KEY = "stop key"
"""The reason of a Stop that the operator requested with a key; other reasons mean that the screen cannot drive now."""

PAD_WINDOW = 0.25
"""s after which a demand of the gamepad is neutral unless a newer one follows. Its reader sends 20 a second, so that a
reader that is killed or hangs is neutral within this time, and three late ones are not."""


class DriveKeyDown(Intent, frozen=True):
    """A drive key went down, or repeats; -1, 0 or +1 for each axis."""

    key: str
    throttle: int
    steering: int
    repeat: bool = False
    """The terminal reports an auto-repeat (only terminals that report key releases do)."""
    side: int = 0
    """To the right; of what flies, as climb."""
    climb: int = 0
    override: bool = False
    """Overrides the limits before obstacles while it is held; moves nothing by itself."""

    @property
    def directions(self) -> tuple[int, int, int, int]:
        """Throttle, steering, side and climb."""
        return self.throttle, self.steering, self.side, self.climb


class DriveKeyUp(Intent, frozen=True):
    """A drive key went up. Only some terminals report it; elsewhere the sticks return to neutral by a timer."""

    valid_when_late = True
    key: str


class DrivePad(Intent, frozen=True):
    """The dead-man button of the gamepad is held, and its sticks are there; sent again and again while it is held."""

    throttle: float
    """-1..1, as steering."""
    steering: float
    read_at: float
    """When the gamepad was read, CLOCK_MONOTONIC, s: what is older than PAD_WINDOW is neutral."""
    repeat: bool = False
    """The button was held in the reading before, too."""
    side: float = 0.0
    climb: float = 0.0


class ReleasePad(Intent, frozen=True):
    """The dead-man button of the gamepad was released, or there is no gamepad any more."""

    valid_when_late = True


OLDEST_PICTURE = 0.5
"""s: an older picture shows where the vehicle was; as long as MAN_TIMEOUT of our vehicle."""
CLOCK_ERROR = 0.2
"""s by which the time of a picture may be ahead of us: the error of both clocks. Farther ahead it is no time."""


class DriveByPicture(Intent, frozen=True):
    """The driver sees no more than the picture of a camera, or does again; sent with each new picture."""

    is_input = False
    valid_when_late = True
    drives: bool
    """By the picture: keys drive only while it is fresh."""
    taken_at: float = 0.0
    """When the newest picture was taken, CLOCK_MONOTONIC of this machine, s; 0: there is none."""


class Stop(Intent, frozen=True):
    """Neutral at once; also ends latched driving. A stop key puts a vehicle in an autonomous mode into HOLD as well."""

    valid_when_late = True
    reason: str = STOP_KEY

    def describe(self) -> str:
        return "stop" if self.reason == STOP_KEY else ""


class EmergencyStop(Intent, frozen=True):
    """Motors off at once and locked: a command, repeated until acknowledged."""

    log_text = "emergency stop"
    valid_when_late = open_to_all = True


class ClearEmergencyStop(VehicleIntent, frozen=True):
    """Release the emergency stop; arming is a separate step."""

    log_text = "release the emergency stop"
    confirmed = "release of the emergency stop"
    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Send the release."""
        commands.clear_emergency_stop(vehicle, now)


class StepLimits(Intent, frozen=True):
    """Change the limits of the sticks by a share of the full range, e.g. 0.1; never moves the vehicle."""

    throttle: float = 0.0
    steering: float = 0.0


class SetStyle(Intent, frozen=True):
    """Set the drive style: "hold", "latch" or "step"; "next" selects the one after the current style."""

    log_text = "change the drive style"
    style: str
    why: str = ""
    """For the log."""
