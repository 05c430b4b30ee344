"""Keys of MAVLink signing: a secret with a name and a role, and the keys that one program knows.

https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

import hashlib
import re
import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import NoReturn

import msgspec
from msgspec.structs import replace

from link.signing.role import SigningRole

SECRET_SIZE = 32
"""Bytes of a secret; the MAVLink specification."""
MAX_KEYS = 16
"""Keys that one program knows: a frame of an unknown stream is verified against each of them."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,23}")
"""A name of a key; it appears in STATUSTEXT, which has 50 characters."""
NAME_RULE = "1 to 24 letters, digits, dots, hyphens or underscores, beginning with a letter or digit"
FINGERPRINT_DOMAIN = b"mavhelm signing key fingerprint\0"
"""Hashed before the secret, so that a fingerprint is neither part of a signature nor the plain hash of a secret."""
PBKDF2_SALT = b"QGroundControl-MAVLink-Signing-v1"
PBKDF2_ROUNDS = 600_000


@dataclass(frozen=True, slots=True)
class SigningKey:
    """A key. Its text form and its pickle never contain the secret."""

    name: str
    role: SigningRole
    secret: bytes = field(repr=False)

    def __post_init__(self) -> None:
        """Raise ValueError for a name or secret that no key may have."""
        if not NAME.fullmatch(self.name):
            raise ValueError(f"a key's name is {NAME_RULE}")
        if problem := find_secret_problem(self.secret):
            raise ValueError(problem)

    @property
    def fingerprint(self) -> str:
        """Eight hex digits that name the secret and do not reveal it."""
        return hashlib.sha256(FINGERPRINT_DOMAIN + self.secret).hexdigest()[:8]

    def __str__(self) -> str:
        return f"{self.name} ({self.role.word}, {self.fingerprint})"

    def __reduce__(self) -> NoReturn:
        raise TypeError("a signing key is neither pickled nor copied")


def find_secret_problem(secret: bytes) -> str | None:
    """Return why these bytes are not a secret, None if they are. 32 zero bytes mean "no signing" in SETUP_SIGNING."""
    if len(secret) != SECRET_SIZE:
        return f"a key has {SECRET_SIZE} bytes, this one has {len(secret)}"
    return None if any(secret) else "32 zero bytes are not a key"


def new_key(name: str, role: SigningRole) -> SigningKey:
    """Return a key with 32 random bytes of the operating system."""
    return SigningKey(name, role, secrets.token_bytes(SECRET_SIZE))


class PassphraseKind(Enum):
    """How a program makes the 32 bytes of a key from a passphrase."""

    SHA256 = "sha256"
    """SHA-256 of the UTF-8 text: MAVProxy, Mission Planner and QGroundControl up to 5.0."""
    PBKDF2 = "pbkdf2"
    """QGroundControl after 5.0: PBKDF2-HMAC-SHA256 with a salt that is the same everywhere, 600 000 rounds."""


def key_from_passphrase(text: str, kind: PassphraseKind = PassphraseKind.SHA256) -> bytes:
    """Return the secret that other ground stations make from the same passphrase."""
    return _DERIVATIONS[kind](text.encode())


def _derive_pbkdf2(text: bytes) -> bytes:
    from _hashlib import pbkdf2_hmac  # hashlib may be without it: link/runtime/without_openssl.py

    return pbkdf2_hmac("sha256", text, PBKDF2_SALT, PBKDF2_ROUNDS, SECRET_SIZE)


_DERIVATIONS: Mapping[PassphraseKind, Callable[[bytes], bytes]] = {
    PassphraseKind.SHA256: lambda text: hashlib.sha256(text).digest(),
    PassphraseKind.PBKDF2: _derive_pbkdf2,
}


class KeyRing(msgspec.Struct, frozen=True):
    """The keys of one program. Each method returns the ring that it leads to."""

    keys: tuple[SigningKey, ...] = ()
    """In the order in which they were added; at most MAX_KEYS, no name and no secret twice."""
    sign_with: str | None = None
    """Name of the key that signs what this program sends to everybody; None only without keys."""

    @property
    def signing_key(self) -> SigningKey | None:
        """The key named by `sign_with`."""
        return None if self.sign_with is None else self.find(self.sign_with)

    def find(self, name: str) -> SigningKey | None:
        """Return the key with this name."""
        return next((key for key in self.keys if key.name == name), None)

    def find_fingerprint(self, fingerprint: str) -> SigningKey | None:
        """Return the key with this fingerprint."""
        return next((key for key in self.keys if key.fingerprint == fingerprint.lower()), None)

    def refuse(self, key: SigningKey) -> str | None:
        """Return why `key` cannot be added, None if it can."""
        if self.find(key.name) is not None:
            return f"there is a key {key.name} already; choose another name, or remove it first"
        if (same := self.find_fingerprint(key.fingerprint)) is not None:
            return f"this secret is there already, as {same.name}"
        return f"there are {MAX_KEYS} keys already; remove one first" if len(self.keys) >= MAX_KEYS else None

    def add(self, key: SigningKey, *, sign: bool = False) -> KeyRing:
        """Add a key; it signs if `sign`, or if it is the first one. Raises ValueError with the text of `refuse`."""
        if problem := self.refuse(key):
            raise ValueError(problem)
        return KeyRing((*self.keys, key), key.name if sign or self.sign_with is None else self.sign_with)

    def remove(self, name: str) -> KeyRing:
        """Remove a key. If it was the one that signs, the newest of the others does."""
        left = tuple(key for key in self.keys if key.name != name)
        newest = left[-1].name if left else None
        return KeyRing(left, newest if self.sign_with == name else self.sign_with)

    def choose(self, name: str) -> KeyRing:
        """Sign with the key of this name from now on. Raises ValueError if there is none."""
        if self.find(name) is None:
            raise ValueError(f"there is no key {name}")
        return replace(self, sign_with=name)
