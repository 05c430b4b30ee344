"""The runtime folder: it has one socket for each running station of this user, and nobody else can look into it."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from link.runtime.local_socket import LONGEST_ADDRESS

FOLDER = "mavhelm"
PREFIX, SUFFIX = "station-", ".sock"

MODE = 0o700

OPEN_FOLDERS = "/proc/self/fd"
"""The folders that this process has open have short paths there, on Linux."""


class FolderError(Exception):
    """The folder cannot be used; the message is one line for the user."""


def folder_path() -> Path:
    """Return the path: in $XDG_RUNTIME_DIR, or in /run/user/UID as a cron job needs it, or in /tmp."""
    user = os.getuid()
    named = os.environ.get("XDG_RUNTIME_DIR", "")
    for base in (named, f"/run/user/{user}"):
        if os.path.isabs(base) and os.path.isdir(base) and os.stat(base).st_uid == user:
            return Path(base) / FOLDER
    return Path(f"/tmp/{FOLDER}-{user}")


def make_folder() -> Path:
    """Return the folder, made if there was none. Raises FolderError."""
    path = folder_path()
    try:
        path.mkdir(MODE, exist_ok=True)
        check_folder(path)
    except OSError as error:
        raise FolderError(f"{path}: {error.strerror}") from error
    return path


def check_folder(path: Path) -> None:
    """Check that nobody else can put a socket into the folder. Raises FolderError, OSError."""
    status = path.lstat()  # not stat(): another user may have put a link to a folder of ours into /tmp
    if not stat.S_ISDIR(status.st_mode):
        raise FolderError(f"{path} is not a folder: remove it")
    if status.st_uid != os.getuid():
        raise FolderError(f"{path} belongs to another user (uid {status.st_uid}): set XDG_RUNTIME_DIR")
    if status.st_mode & 0o077:
        raise FolderError(f"{path} is open to other users: chmod 700 {path}")


def socket_path(folder: Path, pid: int) -> Path:
    """Return the path of the socket of the station with this process id."""
    return folder / f"{PREFIX}{pid}{SUFFIX}"


@contextmanager
def socket_address(path: Path) -> Iterator[str]:
    """Yield a path of the same socket that fits into an address: a runtime folder may be deep. Raises OSError."""
    if len(os.fsencode(path)) <= LONGEST_ADDRESS:
        yield str(path)
        return
    if not os.path.isdir(OPEN_FOLDERS):
        import tempfile  # by those that need it: it takes some ms of each start

        with tempfile.TemporaryDirectory(prefix="mh-", dir="/tmp") as short:  # nobody else can look into it
            link = Path(short) / "d"
            link.symlink_to(path.parent.absolute())
            yield str(link / path.name)
        return
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield f"{OPEN_FOLDERS}/{folder}/{path.name}"
    finally:
        os.close(folder)


def list_sockets() -> list[tuple[int, Path]]:
    """Return the process id and the socket of each station that may run; none without a folder. Raises FolderError."""
    path = folder_path()
    try:
        names = sorted(os.listdir(path))
        check_folder(path)
    except FileNotFoundError:
        return []
    except OSError as error:
        raise FolderError(f"{path}: {error.strerror}") from error
    found = [(name.removeprefix(PREFIX).removesuffix(SUFFIX), path / name) for name in names]
    return [(int(number), each) for number, each in found if number.isdecimal() and each.name.startswith(PREFIX)]
