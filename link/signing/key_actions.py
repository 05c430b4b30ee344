"""What `mavhelm vehicle key` and `mavhelm sign` do with a key file."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path

from link.signing.key_file import change_keys, load_keys
from link.signing.key_qr import draw_qr
from link.signing.key_words import words_from_secret
from link.signing.keys import KeyRing, SigningKey, new_key
from link.signing.role import SigningRole


class KeyActionError(Exception):
    """The action is not possible; one line."""


class ShownAs(Enum):
    """How a secret is shown on request."""

    WORDS = "words"
    HEX = "hex"
    QR = "qr"


WORDS_PER_LINE = 6
WARNING = "who sees this can do all that the key may do; clear the screen and its history afterwards"


def make_key(path: Path, name: str, role: SigningRole) -> SigningKey:
    """Add a new key to a file and return it. Raises KeyActionError, KeyFileError."""
    return store_key(path, _checked(lambda: new_key(name, role)))


def install_key(path: Path, name: str, role: SigningRole, secret: bytes) -> SigningKey:
    """Add a key made elsewhere to a file and return it. Raises KeyActionError, KeyFileError."""
    return store_key(path, _checked(lambda: SigningKey(name, role, secret)))


def store_key(path: Path, key: SigningKey) -> SigningKey:
    """Add a key to a file and return it. Raises KeyActionError, KeyFileError."""

    def add(ring: KeyRing) -> KeyRing:
        if problem := ring.refuse(key):
            raise KeyActionError(problem)
        return ring.add(key)

    change_keys(path, add)
    return key


def remove_key(path: Path, name: str) -> SigningKey:
    """Remove a key from a file and return it. Raises KeyActionError, KeyFileError."""
    removed: list[SigningKey] = []

    def remove(ring: KeyRing) -> KeyRing:
        key = pick_key(ring, name)
        removed.append(key)
        return ring.remove(key.name)

    change_keys(path, remove)
    return removed.pop()


def use_key(path: Path, name: str) -> SigningKey:
    """Sign with this key from now on; return it. Raises KeyActionError, KeyFileError."""
    ring = change_keys(path, lambda ring: ring.choose(pick_key(ring, name).name))
    return pick_key(ring, name)


def find_key(path: Path, name: str | None) -> SigningKey:
    """Return the key with this name or fingerprint, or the only one. Raises KeyActionError, KeyFileError."""
    return pick_key(load_keys(path), name)


def pick_key(ring: KeyRing, name: str | None) -> SigningKey:
    """Return the key with this name or fingerprint, or the only one. Raises KeyActionError."""
    if not ring.keys:
        raise KeyActionError("there are no keys")
    known = ", ".join(each.name for each in ring.keys)
    if name is None:
        if len(ring.keys) > 1:
            raise KeyActionError(f"name a key: {known}")
        (only,) = ring.keys
        return only
    if (key := ring.find(name) or ring.find_fingerprint(name)) is None:
        raise KeyActionError(f"there is no key {name!r}; there are {known}")
    return key


def format_list(ring: KeyRing, *, roles: bool) -> Iterator[str]:
    """Yield a line for each key; `>` marks the one that signs."""
    for key in ring.keys:
        role = f"  {key.role.word:<5}" if roles else ""
        yield f"{'>' if key.name == ring.sign_with else ' '} {key.name:<24}{role}  {key.fingerprint}"


def format_secret(key: SigningKey, form: ShownAs) -> str:
    """Return the secret in clear text, lines with their ends. Raises KeyActionError, MissingPackageError."""
    if form is ShownAs.HEX:
        return f"{key.secret.hex()}\n"
    if form is ShownAs.WORDS:
        words = words_from_secret(key.secret)
        lines = (words[at : at + WORDS_PER_LINE] for at in range(0, len(words), WORDS_PER_LINE))
        return "".join(f"{' '.join(line)}\n" for line in lines)
    if not sys.stdout.isatty():
        raise KeyActionError("a QR code is for a terminal; --hex and --words go to files and pipes")
    unicode = (sys.stdout.encoding or "").lower().replace("-", "") == "utf8"
    return draw_qr(key.secret.hex().upper(), unicode=unicode)  # capitals: QR's alphanumeric mode, a smaller code


def _checked(make: Callable[[], SigningKey]) -> SigningKey:
    try:
        return make()
    except ValueError as error:
        raise KeyActionError(str(error)) from None
