"""Exit codes of PREFLIGHT_REBOOT_SHUTDOWN: what must happen after the daemon has ended.

The daemon may not restart the computer and runs no other program: the systemd unit (vehicle/cli/systemd_unit.py) acts
on the exit code. Any other supervisor can do the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum

from link.services.command.request import value_or_default

REBOOT_DELAY = 0.5
"""s between the acknowledgement and the end: a client repeats the command if the acknowledgement was lost."""


OWN_COMPONENTS = (0, 1)
"""Component ids in parameter 4 that mean this program: all components, and the autopilot."""


class RebootRequest(IntEnum):
    """Exit codes, between those of sysexits.h and those of systemd."""

    RESTART = 80
    """Start the daemon again."""
    REBOOT = 81
    """Reboot the computer."""
    POWER_OFF = 82
    """Shut the computer down."""

    @property
    def label(self) -> str:
        """Words for the driver."""
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
"""REBOOT_SHUTDOWN_ACTION of parameters 1 and 2 -> request; other pairs are denied.

Shutting down the autopilot shuts down the computer: a program that has only ended could not be started remotely."""


def parse_reboot_request(params: Sequence[float]) -> RebootRequest | None:
    """Return the request in parameters 1..4 of PREFLIGHT_REBOOT_SHUTDOWN; None if it is not offered.

    Parameters 3 and 4 are an action and its component. An action for another component is ignored, because this vehicle
    has no other (MAVSDK 4 sends NaN for all but the first, older ones 1, 1, 1, 1 and 2, 2, 2, 2).
    """
    program, computer, action, component = map(value_or_default, params[:4])
    if action and component in OWN_COMPONENTS:
        if program not in (0, action):
            return None
        program = action
    return REBOOT_REQUESTS.get((program, computer))
