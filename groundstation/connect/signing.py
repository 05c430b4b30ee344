"""Signing of this user's ground station: its keys, and what it makes of frames that are not signed."""

from __future__ import annotations

import math

from link.key_watch import KeyWatch
from link.link_signing import LinkSigning
from link.protocol.signing_guard import SigningPolicy
from link.signing.key_file import KeyFileError, load_keys, station_key_file
from link.signing.keys import KeyRing
from link.signing.memory_file import FILE, MemoryFileError
from link.signing.role import SigningRole


class SigningError(Exception):
    """The keys cannot be used; the text is one line."""


def open_signing(now: float, *, key: str | None = None, required: bool = False) -> LinkSigning | None:
    """Return what signs and verifies for a verb; None without keys. Raises SigningError.

    `key`: name of the key that signs, None for the chosen one. `required`: unsigned frames are dropped. Otherwise they
    are taken from systems that have not signed in this run.
    """
    try:
        ring = _choose(load_keys(station_key_file()), key, required)
    except KeyFileError as error:
        raise SigningError(str(error)) from None
    return LinkSigning(ring, None, now, policy=_policy(required)) if ring.keys else None


class StationSigning:
    """The keys of a station while it runs: it takes over what `mavhelm sign` changes."""

    def __init__(self, now: float, *, key: str | None = None, required: bool = False) -> None:
        """Read the keys, and what the last run remembers. `key` and `required`: as above. Raises SigningError."""
        self._key = key
        self._required = required
        self.version = 0
        """How often the keys have changed."""
        try:
            self._watch = KeyWatch(station_key_file())
            ring = _choose(self._watch.ring, key, required)
            self.link_signing = LinkSigning(ring, self._watch.path.with_name(FILE), now, policy=_policy(required))
        except (KeyFileError, MemoryFileError) as error:
            raise SigningError(str(error)) from None

    def poll(self, now: float) -> str | None:
        """Take over changed keys; return what to write to the log, or None. Never blocks."""
        try:
            found = self._watch.poll(now)
        except KeyFileError as error:
            return f"{error}; the keys of before stay in force"
        if found is None:
            return None
        missing = self._key is not None and found.find(self._key) is None
        self._take(found if self._key is None or missing else found.choose(self._key))
        return self._describe(missing=missing)

    def reload(self) -> None:
        """Read the file now, in the process that goes on in the place of the station. Keys that cannot be read stay."""
        self._watch.look()
        self.poll(-math.inf)

    def close(self) -> None:
        """End the thread that looks at the file."""
        self._watch.close()

    def _take(self, ring: KeyRing) -> None:
        self.version += 1
        self.link_signing.signing.set_ring(ring)

    def _describe(self, *, missing: bool) -> str:
        ring = self.link_signing.signing.ring
        if not ring.keys:
            drops = "and nothing unsigned is taken" if self._required else "and nothing is verified"
            return f"keys changed: there is none; nothing is signed, {drops}"
        gone = f"; --sign-key {self._key} is gone" if missing else ""
        signs = ring.signing_key
        known = ", ".join(f"{each.name} ({each.fingerprint})" for each in ring.keys)
        return f"keys changed: {known}; {signs.name if signs else 'none'} signs{gone}"


def _policy(required: bool) -> SigningPolicy:
    unsigned = None if required else SigningRole.SET_UP
    return SigningPolicy(unsigned, pinned_for=math.inf, greets_late=True, announces=True)


def _choose(ring: KeyRing, key: str | None, required: bool) -> KeyRing:
    """Return the ring with the key that signs. Raises SigningError."""
    path = station_key_file()
    if key is not None:
        if ring.find(key) is None:
            known = ", ".join(each.name for each in ring.keys) or "none"
            raise SigningError(f"--sign-key {key}: there is no such key in {path}; there are: {known}")
        ring = ring.choose(key)
    if required and not ring.keys:
        raise SigningError(f"require_signing: there is no key in {path}; `mavhelm sign new NAME` makes one")
    return ring
