"""What the operator wants: the values that travel from the keys to the station, and nothing else does.

They are msgspec structs because the keys live in the terminal's process and the station in another one (station_process.py).
"""

from __future__ import annotations

import msgspec

LEASE_TIMEOUT = 0.3
"""s without a renewal after which the screen counts as frozen: three renewals at its 10 Hz and longer than its longest
drawing (0.1 s); a frozen screen then means neutral well within 0.5 s."""


STOP_KEY = "stop key"
"""The reason of a Stop that an operator pressed; any other is a screen that cannot drive just now."""


class Intent(msgspec.Struct, frozen=True, tag=True):
    """Base of the union below."""


class DriveKeyDown(Intent, frozen=True):
    """A drive key went down, or repeats: "this way", -1, 0 or +1 an axis."""

    key: str
    throttle: int
    steering: int
    repeat: bool = False
    """The terminal says that this is an auto-repeat (only terminals that report key releases know)."""


class DriveKeyUp(Intent, frozen=True):
    """A drive key went up. Only some terminals tell; elsewhere the sticks fall back by themselves."""

    key: str


class Stop(Intent, frozen=True):
    """Neutral at once; also ends a latched drive. A stop key puts a vehicle that drives itself into HOLD, too."""

    reason: str = STOP_KEY


class EmergencyStop(Intent, frozen=True):
    """Motors off at once and locked, by command and repeated until acknowledged."""


class ClearEmergencyStop(Intent, frozen=True):
    """Release the emergency stop; arming is a further step."""


class ScaleLimits(Intent, frozen=True):
    """Scale the limits of the sticks; never moves the vehicle. Factors above 0, e.g. 1.1."""

    throttle: float = 1.0
    steering: float = 1.0


class SetStyle(Intent, frozen=True):
    """How keys drive: "hold", "latch" or "step"; "next" is the one after the present one."""

    style: str


class ReportKeyReleases(Intent, frozen=True):
    """The terminal has proved that it reports key releases: no timers are needed any more."""


class SetKeyGate(Intent, frozen=True):
    """May keys drive now? Closed when another screen is on top, the focus is lost or the terminal is gone."""

    open: bool
    reason: str = ""


class RenewLease(Intent, frozen=True):
    """ "The screen lives": renewed by the UI's own loop. Without it the station goes neutral and then silent."""


class Arm(Intent, frozen=True):
    """Arm the vehicle, after putting it into MANUAL where it is in HOLD."""


class Disarm(Intent, frozen=True):
    """Disarm the vehicle."""


class SetMode(Intent, frozen=True):
    """Change the mode; `mode` is a name of dialects.modes.Mode."""

    mode: str


class RequestControl(Intent, frozen=True):
    """Ask to be the ground station in control."""


class SelectVehicle(Intent, frozen=True):
    """Drive the vehicle with this system id from now on."""

    system: int


class SelectNextVehicle(Intent, frozen=True):
    """Drive the vehicle after this one from now on, by system id; after the last comes the first."""


class StartSimulator(Intent, frozen=True):
    """Start a simulated rover as a child of the station and let it connect to us."""


class Quit(Intent, frozen=True):
    """Send neutral several times and end."""


AnyIntent = (
    DriveKeyDown | DriveKeyUp | Stop | EmergencyStop | ClearEmergencyStop | ScaleLimits | SetStyle | ReportKeyReleases | SetKeyGate | RenewLease | Arm
    | Disarm | SetMode | RequestControl | SelectVehicle | SelectNextVehicle | StartSimulator | Quit
)  # fmt: skip
