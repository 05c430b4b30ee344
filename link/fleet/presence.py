"""Presence: who is connected, by the tokens of the router, and who sends with which system id. Sans-IO."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import msgspec

MAX_PRESENT = 256
"""Programs at once; further ones are not told, and are heard all the same."""
MAX_RUNS = 32
"""Of them, ground stations of one operator: the tokens of one must not keep the others out."""
GRACE = 3.0
"""s without its token after which a program has gone. A router that restarts has all tokens back within 1 s, and the
conversations go on."""


def has_room(address: str, others: Collection[str]) -> bool:
    """Return whether one more program may be remembered beside `others`: MAX_PRESENT, and MAX_RUNS of one operator.

    The address of a ground station is "alice/3f2a", that of a vehicle its name.
    """
    owner = address.partition("/")[0]
    return len(others) < MAX_PRESENT and sum(each.partition("/")[0] == owner for each in others) < MAX_RUNS


class Presence(msgspec.Struct):
    """The programs at the other end of one endpoint."""

    present: set[str] = msgspec.field(default_factory=set)
    """Addresses with a token, or without one for less than GRACE."""
    _missing: dict[str, float] = msgspec.field(default_factory=dict)
    _owners: dict[int, str] = msgspec.field(default_factory=dict)
    """System id -> the vehicle that was the first to send with it."""

    def add(self, address: str) -> bool:
        """Record a token; return whether the program is new."""
        self._missing.pop(address, None)
        is_new = address not in self.present and has_room(address, self.present)
        if is_new:
            self.present.add(address)
        return is_new

    def remove(self, address: str, now: float) -> None:
        """Record that a token has gone."""
        if address in self.present:
            self._missing.setdefault(address, now)

    def expire(self, now: float) -> list[str]:
        """Return the programs that have gone for good, and forget them."""
        gone = [address for address, since in self._missing.items() if now - since >= GRACE]
        for address in gone:
            del self._missing[address]
            self.present.discard(address)
            self._owners = {system: owner for system, owner in self._owners.items() if owner != address}
        return gone

    def find_owners(self, systems: Iterable[int]) -> set[str]:
        """Return the vehicles that these system ids belong to."""
        return {self._owners[system] for system in systems if system in self._owners}

    def owner(self, system: int, address: str) -> str:
        """Return the vehicle that a system id belongs to: the first one that sends with it, while it is there."""
        return self._owners.setdefault(system, address)
