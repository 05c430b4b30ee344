"""What the holder of a key may do. A module of its own, because every message that arrives has a role."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum


class SigningRole(IntEnum):
    """What the holder of a key may do. Each role includes those before it."""

    WATCH = 1
    """Receive telemetry, read parameters, plans and files. Stops are open to all roles."""
    DRIVE = 2
    """Also take control, arm, drive, change modes and start missions."""
    SET_UP = 3
    """Also write parameters, plans and files, test motors, calibrate and change keys."""

    @property
    def word(self) -> str:
        """The role in files, on command lines and on screens."""
        return ROLE_WORDS[self]


ROLE_WORDS: Mapping[SigningRole, str] = {
    SigningRole.WATCH: "watch",
    SigningRole.DRIVE: "drive",
    SigningRole.SET_UP: "setup",
}
ROLES: Mapping[str, SigningRole] = {word: role for role, word in ROLE_WORDS.items()}
