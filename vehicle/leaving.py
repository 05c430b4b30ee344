"""How the daemon ends when a ground station asked for it: exit codes that say what is to happen next.

The daemon has no rights to restart a computer and runs no other program: the unit (vehicle/unit.py) does what the code
says. Any other supervisor can do the same.
"""

from __future__ import annotations

from enum import IntEnum

DELAY = 0.5
"""s between the answer and the end: a client whose answer was lost repeats, and is answered again."""


class Leave(IntEnum):
    """Exit codes; free ones between those of sysexits.h and systemd's own."""

    RESTART = 80
    """Start me again."""
    REBOOT = 81
    """Start the computer again."""
    POWER_OFF = 82
    """Turn the computer off."""

    @property
    def words(self) -> str:
        """As the driver reads it."""
        return {Leave.RESTART: "restarting", Leave.REBOOT: "rebooting the computer",
                Leave.POWER_OFF: "shutting the computer down"}[self]  # fmt: skip
