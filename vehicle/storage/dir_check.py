"""Checks that a folder is writable, with an unnamed temporary file, so that nothing is left behind."""

from __future__ import annotations

import os
import pwd
import stat
from pathlib import Path

PROBE_SIZE = 65_536
"""Bytes to write: more than all saved parameters, and enough for a full disk or an exhausted quota to fail."""


def write_problem(folder: Path, setting: str) -> str | None:
    """Return why this user cannot write to `folder` and what to do, in one line; None without a problem.

    A missing folder is not created: it would belong to the user who checks, not to the user who runs the vehicle.
    `setting` names the setting that selects another folder.
    """
    nearest = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
    try:
        if not _is_folder(nearest):
            return f"{nearest} is not a folder; remove it, or set another folder with {setting}"
        if nearest != folder:
            writable = os.access(nearest, os.W_OK | os.X_OK, effective_ids=True)
            return None if writable else _permission_problem(nearest, setting)
        import tempfile  # when it is needed: it takes 3 ms of each start

        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            if file.write(bytes(PROBE_SIZE)) != PROBE_SIZE:
                return f"{folder} is full; free some space, or set another folder with {setting}"
            os.fsync(file.fileno())
    except PermissionError:
        return _permission_problem(nearest, setting)
    except OSError as error:
        return f"{folder} cannot be written, {error.strerror}; fix that, or set another folder with {setting}"
    return None


def _is_folder(path: Path) -> bool:
    """Like Path.is_dir, which hides a missing permission in newer Pythons. Raises PermissionError."""
    try:
        return stat.S_ISDIR(path.stat().st_mode)
    except FileNotFoundError:  # a dangling link
        return False


def _permission_problem(folder: Path, setting: str) -> str:
    user = _user_name(os.geteuid())
    try:
        owner = _user_name(folder.stat().st_uid)
    except OSError:  # in a folder without access, such as the state folder of a service with DynamicUser=
        remedy = "and cannot be examined; run this with sudo"
    else:
        remedy = "chmod u+rwx it" if owner == user else f"it belongs to {owner}; run this as {owner}"
    return f"{folder} is not writable by {user}, {remedy}, or set another folder with {setting}"


def _user_name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"user {uid}"
