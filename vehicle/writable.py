"""Can the vehicle keep things in a folder? Tried with a file that has no name, so that nothing is left behind."""

from __future__ import annotations

import contextlib
import os
import pwd
import tempfile
from pathlib import Path

TRIED = 65_536
"""Bytes: more than all kept parameters, and what a full disk or a used-up quota refuses."""


def obstacle(folder: Path, setting: str) -> str | None:
    """Why this user cannot write there and what to do, one line; None where nothing is in the way.

    A folder that is missing is not made here: it would belong to whoever checks, and not to who drives. `setting` is
    what names another folder.
    """
    there = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
    try:
        if not there.is_dir():
            return f"{there} is no folder; remove it, or name another folder as {setting}"
        if there != folder:
            return None if os.access(there, os.W_OK | os.X_OK, effective_ids=True) else _forbidden(there, setting)
        with tempfile.TemporaryFile(dir=folder, buffering=0) as file:
            if file.write(bytes(TRIED)) != TRIED:
                return f"{folder} is full; make room, or name another folder as {setting}"
            os.fsync(file.fileno())
    except PermissionError:
        return _forbidden(there, setting)
    except OSError as error:
        return f"{folder} cannot be written, {error.strerror}; mend that, or name another folder as {setting}"
    return None


def _forbidden(folder: Path, setting: str) -> str:
    me, owner = _name(os.geteuid()), None
    with contextlib.suppress(OSError):
        owner = _name(folder.stat().st_uid)
    whose = f", it belongs to {owner}; run this as {owner}" if owner and owner != me else "; chmod u+rwx it"
    return f"{folder} may not be written by {me}{whose}, or name another folder as {setting}"


def _name(user: int) -> str:
    try:
        return pwd.getpwuid(user).pw_name
    except KeyError:
        return f"user {user}"
