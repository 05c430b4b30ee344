"""The file with the keys of one program: TOML, for its user only. Any error is one line with file, key and remedy."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pwd
import re
import resource
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import msgspec

from link.runtime.whole_file import PRIVATE, replace_file
from link.signing.keys import SECRET_SIZE, KeyRing, SigningKey
from link.signing.role import ROLES
from link.toml.errors import explain_error
from link.toml.file import TomlError, parse_toml

FILE = "keys.toml"
"""Name of the file: in the state folder of a vehicle, in the config folder of a ground station's user."""
MAX_SIZE = 64 * 1024
"""Bytes of a file that is read: ten times what the most keys need."""
OTHERS = stat.S_IRWXG | stat.S_IRWXO
HEX_SECRET = re.compile(rf"[0-9A-Fa-f]{{{2 * SECRET_SIZE}}}")
HEAD = """\
# Keys for MAVLink signing, written by mavhelm. Who can read this file can do all that these keys may do.
"""


class KeyFileError(Exception):
    """The file cannot be used. The text is one line: file, key, error, remedy. It contains no secret."""


class _KeyTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: str
    role: str
    secret: str


class _FileTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    sign_with: str | None = None
    key: Annotated[list[_KeyTable], msgspec.Meta(max_length=256)] = []


def load_keys(path: Path) -> KeyRing:
    """Return the keys in a file; an empty ring if there is no file. Raises KeyFileError.

    A process that has read keys writes no core dump any more.
    """
    forbid_core_dumps()
    try:
        text = _read_private(path)
        return _parse(text, path) if text is not None else KeyRing()
    except TomlError as error:
        raise KeyFileError(f"{error}; correct it, or remove the file and pair again") from None


def save_keys(path: Path, ring: KeyRing) -> None:
    """Write the keys, readable for their owner only from the first byte on. Raises KeyFileError.

    A file written by root in another user's folder belongs to that user, so that the service of the vehicle reads it.
    """
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(path, format_keys(ring).encode(), mode=PRIVATE, durable=True, folders_owner=True)
    except OSError as error:
        raise KeyFileError(f"{path}: {error.strerror}; no key was changed") from error


def change_keys(path: Path, change: Callable[[KeyRing], KeyRing]) -> KeyRing:
    """Read the keys, write those that `change` returns, and return them. Raises KeyFileError, and what `change` raises.

    Another program that changes the file at the same time waits.
    """
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        lock = _open_lock(path.with_name(f".{path.name}.lock"))
    except OSError as error:
        raise KeyFileError(f"{path}: {error.strerror}; no key was changed") from error
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        after = change(load_keys(path))
        save_keys(path, after)
        return after
    finally:
        os.close(lock)


def station_key_file() -> Path:
    """Return the file of this user's ground station: $XDG_CONFIG_HOME/mavhelm/keys.toml on Linux."""
    from platformdirs import user_config_path  # when it is needed: it takes 3 ms of each start

    return user_config_path("mavhelm") / FILE


def format_keys(ring: KeyRing) -> str:
    """Return the text of the file."""
    chosen = "" if ring.sign_with is None else f'sign_with = "{ring.sign_with}"\n'
    return HEAD + chosen + "".join(map(_format_key, ring.keys))


def _open_lock(path: Path) -> int:
    """Open the lock beside the keys. A new one belongs to the owner of the folder, as the keys do.

    One that exists is left as it is: the owner of the folder may have linked another file there.
    """
    flags = os.O_RDWR | os.O_NOFOLLOW
    try:
        descriptor = os.open(path, flags | os.O_CREAT | os.O_EXCL, PRIVATE)
    except FileExistsError:
        return os.open(path, flags)
    if os.geteuid() == 0:
        folder = path.parent.stat()
        os.fchown(descriptor, folder.st_uid, folder.st_gid)
    return descriptor


def _format_key(key: SigningKey) -> str:
    return f'\n[[key]]\nname = "{key.name}"\nrole = "{key.role.word}"\nsecret = "{key.secret.hex()}"\n'


def _read_private(path: Path) -> str | None:
    """Return the text of a file that nobody else can read or replace; None without a file."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except FileNotFoundError:
        return None
    except OSError as error:
        if path.is_symlink():
            raise KeyFileError(f"{path}: is a symbolic link; put the file itself there") from None
        raise KeyFileError(f"{path}: {error.strerror}; run this as the user whose keys these are") from error
    try:
        _check_private(path, os.fstat(descriptor))
        with open(descriptor, "rb", closefd=False) as file:
            data = file.read(MAX_SIZE + 1)
    finally:
        os.close(descriptor)
    if len(data) > MAX_SIZE:
        raise KeyFileError(f"{path}: is larger than {MAX_SIZE} bytes; it is not a key file")
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise KeyFileError(f"{path}: byte {error.start + 1} is not UTF-8 text; remove it and pair again") from None


def _check_private(path: Path, found: os.stat_result) -> None:
    if not stat.S_ISREG(found.st_mode):
        raise KeyFileError(f"{path}: is not a regular file; put a key file there")
    if found.st_uid not in _trusted_owners(path):
        remedy = f"chown {_user_name(os.geteuid())} {path}, if you know where it comes from"
        raise KeyFileError(f"{path}: belongs to {_user_name(found.st_uid)}; {remedy}")
    if found.st_mode & OTHERS:
        raise KeyFileError(
            f"{path}: other users can read or write it (mode {found.st_mode & 0o777:o}); chmod 600 {path}"
        )


def _trusted_owners(path: Path) -> set[int]:
    """Return who may own the file: its reader; for root also the owner of its folder, such as the vehicle's service."""
    user = os.geteuid()
    return {user, path.parent.stat().st_uid} if user == 0 else {user}


def _user_name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"user {uid}"


def _parse(text: str, path: Path) -> KeyRing:
    content = parse_toml(text, str(path))
    try:
        table = msgspec.convert(content, _FileTable)
    except msgspec.ValidationError as error:
        raise TomlError(f"{path}: {explain_error(error, _FileTable, '')}") from None
    ring = KeyRing()
    for number, each in enumerate(table.key):
        try:
            ring = ring.add(_key(each))
        except ValueError as error:
            raise TomlError(f"{path}: key[{number}] {each.name!r}: {error}") from None
    if table.sign_with is not None:
        if ring.find(table.sign_with) is None:
            raise TomlError(f"{path}: sign_with: there is no key {table.sign_with!r}")
        ring = ring.choose(table.sign_with)
    return ring


def _key(table: _KeyTable) -> SigningKey:
    """Return the key of a table. Raises ValueError, without the secret in its text."""
    if table.role not in ROLES:
        raise ValueError(f"role {table.role!r} is not known; there are {', '.join(ROLES)}")
    if not HEX_SECRET.fullmatch(table.secret):
        what = f"has {len(table.secret)} characters" if len(table.secret) != 2 * SECRET_SIZE else "has other characters"
        raise ValueError(f"a secret is {2 * SECRET_SIZE} hex digits, this one {what}")
    return SigningKey(table.name, ROLES[table.role], bytes.fromhex(table.secret))


def forbid_core_dumps() -> None:
    """Write no memory image of this process, or of those that it starts from now on, if it crashes.

    Where a sandbox forbids the call, its owner has decided already (LimitCORE=0 in the unit of the vehicle).
    """
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
