"""Can the vehicle keep things in a folder? Tried with a file that has no name, so that nothing is left behind."""

from __future__ import annotations

import os
import pwd
import stat
import tempfile
from pathlib import Path

PROBE_SIZE = 65_536
"""Bytes: more than all kept parameters, and what a full disk or a used-up quota refuses."""


def write_problem(folder: Path, setting: str) -> str | None:
    """Why this user cannot write there and what to do, one line; None where nothing is in the way.

    A folder that is missing is not made here: it would belong to whoever checks, and not to who drives. `setting` is
    what names another folder.
    """
    there = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
    try:
        if not _is_folder(there):
            return f"{there} is no folder; remove it, or name another folder as {setting}"
        if there != folder:
            return None if os.access(there, os.W_OK | os.X_OK, effective_ids=True) else _forbidden(there, setting)
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            if file.write(bytes(PROBE_SIZE)) != PROBE_SIZE:
                return f"{folder} is full; make room, or name another folder as {setting}"
            os.fsync(file.fileno())
    except PermissionError:
        return _forbidden(there, setting)
    except OSError as error:
        return f"{folder} cannot be written, {error.strerror}; mend that, or name another folder as {setting}"
    return None


def _is_folder(path: Path) -> bool:
    """Not Path.is_dir: newer Pythons say False also of what they may not look at. Raises PermissionError."""
    try:
        return stat.S_ISDIR(path.stat().st_mode)
    except FileNotFoundError:  # a link to nowhere
        return False


def _forbidden(folder: Path, setting: str) -> str:
    me = _name(os.geteuid())
    try:
        owner = _name(folder.stat().st_uid)
    except OSError:  # behind a closed door, as what a service keeps that runs as nobody in particular
        remedy = "nor looked at; run this with sudo"
    else:
        remedy = "chmod u+rwx it" if owner == me else f"it belongs to {owner}; run this as {owner}"
    return f"{folder} may not be written by {me}, {remedy}, or name another folder as {setting}"


def _name(user: int) -> str:
    try:
        return pwd.getpwuid(user).pw_name
    except KeyError:
        return f"user {user}"
