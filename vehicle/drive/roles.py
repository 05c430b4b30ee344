"""What the role of a sender's key allows (link/signing/keys.py), and how a denial reads."""

from __future__ import annotations

from typing import Protocol

from link.signing.role import SigningRole

UNSIGNED = "not signed; use a key, see docs/security.md"
_MAY_ONLY = {SigningRole.WATCH: "its key may only watch", SigningRole.DRIVE: "its key may drive but not set up"}


class RoleHolder(Protocol):
    """The sender of a message or a command: `link.core.Received` and `CommandRequest` are two."""

    @property
    def role(self) -> SigningRole:
        """What the sender may do."""

    @property
    def signed(self) -> bool:
        """Whether it has signed."""


def role_denial(sender: RoleHolder, needed: SigningRole) -> str | None:
    """Return why the role of a sender does not suffice, or None."""
    if sender.role >= needed:
        return None
    return _MAY_ONLY[sender.role] if sender.signed else UNSIGNED
