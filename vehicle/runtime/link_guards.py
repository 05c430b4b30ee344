"""LinkGuards: gives each link the guard that [signing] and the keys of now ask for, and says what follows from it."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from link.endpoint import parse_endpoint
from link.link_signing import LinkSigning
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.keys import KeyRing
from link.signing.role import SigningRole
from link.transport.reach import find_trust, missing_interfaces
from link.transport.transport import Link
from vehicle.config.run_settings import SettingsError
from vehicle.config.signing import SigningSettings, build_policy
from vehicle.runtime.vehicle_keys import VehicleKeys

log = logging.getLogger(__name__)

PERIOD = 1.0
"""s between two looks at the clock of the computer."""

NOBODY = "everybody in the network can send here, so nobody may drive: {}, or set allow_unsigned = true under [signing]"
"""What is said of a link that is open to a network, while there is neither a key nor a permission."""

MISSING = "signing.private: there is no interface {} now; when it has come, restart the vehicle to trust it"

NEW_KEY = "make a key with `mavhelm vehicle key new NAME --state {}`"
NO_STATE = "run the simulation with `--state FOLDER` and " + NEW_KEY.format("FOLDER")
"""What leads to a key. Keys are in the state folder, and a simulation has none unless it is told."""


class LinkGuards:
    """The guards of all links. Without keys, a link that is trusted has none, and costs nothing."""

    def __init__(
        self,
        settings: SigningSettings,
        endpoints: Sequence[str],
        keys: VehicleKeys | None,
        memory: Path | None,
        now: float,
    ) -> None:
        """Prepare. `memory`: file of the signing clock. Raises SettingsError, and MemoryFileError."""
        ring = keys.ring if keys is not None else KeyRing()
        self._new_key = NO_STATE if keys is None else NEW_KEY.format(keys.folder)
        if settings.required and not ring.keys:
            raise SettingsError(f"signing.required: there is no key; {self._new_key}")
        found = [find_trust(parse_endpoint(text), settings.private) for text in endpoints]
        self._policies = [build_policy(settings, private=each is not None) for each in found]
        self._trusts = {text: each for text, each in zip(endpoints, found, strict=True) if each is not None}
        self._open = [text for text in endpoints if text not in self._trusts and not settings.required]
        self._required = settings.required
        self._missing = missing_interfaces(settings.private)
        self._allowed = settings.allow_unsigned
        self._link_signing = LinkSigning(ring, memory, now)
        self._links: Sequence[Link] = ()
        self._due = now
        if keys is not None:
            keys.listeners.append(self._take_keys)

    @property
    def arming_note(self) -> str | None:
        """What is said at each arming, or None."""
        return "Unsigned links: anybody in the network may drive" if self._open and self._allowed else None

    @property
    def devices(self) -> Mapping[str, str]:
        """Endpoint -> the interface to which it must be bound, because it is trusted for that."""
        return {text: trust.device for text, trust in self._trusts.items() if trust.device}

    @property
    def notes(self) -> list[str]:
        """What is said at the start of each trusted endpoint, and of names in the file that are not there."""
        trusted = [] if self._required else [f"{text}: needs no key, {t.reason}" for text, t in self._trusts.items()]
        return [*trusted, *(MISSING.format(name) for name in self._missing)]

    @property
    def warning(self) -> str | None:
        """What is said at the start: what who may do, and what to do about it; None if nobody unsigned comes in."""
        if not self._open:
            return None
        place = ", ".join(self._open)
        known = bool(self._link_signing.signing.ring.keys)
        if self._allowed:
            first = "" if known else f"{self._new_key} and "
            return f"{place}: everybody in the network may drive; to close it, {first}remove allow_unsigned"
        if known:
            return None
        return f"{place}: {NOBODY.format(self._new_key)}"

    def attach(self, links: Sequence[Link]) -> None:
        """Guard these links, in the order of the endpoints."""
        self._links = links
        for link, policy in zip(links, self._policies, strict=False):
            link.channel.guard = self._guard(link, policy)

    def poll(self, now: float) -> None:
        """Follow the clock of the computer and store what is due. Call it in each control cycle."""
        if now >= self._due and self._link_signing.signing.ring.keys:
            self._due = now + PERIOD
            self._link_signing.update(now)

    def close(self, now: float) -> None:
        """Store for the last time."""
        if self._link_signing.signing.ring.keys:
            self._link_signing.close(now)

    def _guard(self, link: Link, policy: SigningPolicy) -> SigningGuard | None:
        if not self._link_signing.signing.ring.keys and policy.unsigned is SigningRole.SET_UP:
            return None
        return SigningGuard(self._link_signing.signing, policy, link.channel.index)

    def _take_keys(self, ring: KeyRing) -> None:
        """Use other keys from now on. The last one may be gone: then unsigned senders have what the file grants."""
        self._link_signing.signing.set_ring(ring)
        self.attach(self._links)
