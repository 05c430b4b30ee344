"""What the core wants of the disk, and the answers: values only, the shell runs them (groundstation/disk)."""

from __future__ import annotations

from enum import Enum, auto
from pathlib import PurePosixPath

import msgspec


class DiskWork(Enum):
    """Kinds of jobs."""

    PREPARE = auto()
    """Check that a file may be created; read what an earlier download left of it."""
    READ = auto()
    """Read a file to upload."""
    KEEP = auto()
    """Keep the beginning of a download."""
    STORE = auto()
    """Write a whole download under its name."""
    CHECKSUM = auto()
    """Compute the checksum of a file."""


class DiskJob(msgspec.Struct, frozen=True):
    """One job."""

    number: int
    """The request that it is for."""
    work: DiskWork
    path: str
    data: bytes = b""
    overwrite: bool = False


class DiskResult(msgspec.Struct, frozen=True):
    """The answer to a job."""

    number: int
    work: DiskWork
    data: bytes = b""
    checksum: int = 0
    """CRC-32 as MAVLink FTP computes it, of a CHECKSUM job."""
    problem: str = ""
    """Why it failed, one line that names the file; "" after success."""


def name_problem(name: str) -> str:
    """Return why a file of the vehicle cannot have this name in a folder here; "" if it can."""
    if not name or name in (".", "..") or name != PurePosixPath(name).name or "\\" in name:
        return f"{name!r} would leave the folder"
    if name[0] in ".-":
        return f"{name!r} would be hidden or taken for an option"
    return "" if name.isprintable() else f"{name!r} has control characters"
