"""How the daemon ends when a ground station asked for it: exit codes that say what is to happen next.

The daemon has no rights to restart a computer and runs no other program: the unit (vehicle/cli/systemd_unit.py) does what the code
says. Any other supervisor can do the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum

from link.services.command.server import value_or_default

REBOOT_DELAY = 0.5
"""s between the answer and the end: a client whose answer was lost repeats, and is answered again."""


OWN_COMPONENTS = (0, 1)
"""Component ids in parameter 4 of PREFLIGHT_REBOOT_SHUTDOWN that mean this program: all, and the autopilot."""


class RebootRequest(IntEnum):
    """Exit codes; free ones between those of sysexits.h and systemd's own."""

    RESTART = 80
    """Start me again."""
    REBOOT = 81
    """Start the computer again."""
    POWER_OFF = 82
    """Turn the computer off."""

    @property
    def label(self) -> str:
        """As the driver reads it."""
        return {RebootRequest.RESTART: "restarting", RebootRequest.REBOOT: "rebooting the computer",
                RebootRequest.POWER_OFF: "shutting the computer down"}[self]  # fmt: skip


REBOOT_REQUESTS: dict[tuple[float, float], RebootRequest] = {
    (1, 0): RebootRequest.RESTART,
    (0, 1): RebootRequest.REBOOT,
    (1, 1): RebootRequest.REBOOT,
    (0, 2): RebootRequest.POWER_OFF,
    (1, 2): RebootRequest.POWER_OFF,
    (2, 0): RebootRequest.POWER_OFF,
    (2, 2): RebootRequest.POWER_OFF,
}
"""REBOOT_SHUTDOWN_ACTION for the autopilot, for the computer on board -> what happens. The rest is not offered.

The autopilot shut down is the computer turned off: a program that has only ended could not be begun again from afar."""


def parse_reboot_request(params: Sequence[float]) -> RebootRequest | None:
    """What parameters 1..4 of PREFLIGHT_REBOOT_SHUTDOWN ask for; None for what is not offered.

    3 and 4 are an action and the component it is for. Other components are no part of this vehicle: what is asked of
    them is passed over where we are asked for something, too (MAVSDK 4 sends NaN for all but the first, older ones
    1, 1, 1, 1 and 2, 2, 2, 2).
    """
    program, computer, action, of = map(value_or_default, params[:4])
    if action and of in OWN_COMPONENTS:
        if program not in (0, action):
            return None
        program = action
    return REBOOT_REQUESTS.get((program, computer))
