"""Intents about the files and logs of a vehicle. The station writes and reads the files of this machine."""

from __future__ import annotations

from groundstation.intents.services import ServiceIntent

SAME, DIFFERS = "same", "differs"
"""With which the detail of a CompareFile that was accepted begins."""


class ListFolder(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """List a folder of the vehicle by MAVLink FTP."""

    open_to_all = True

    path: str


class GetFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Download a file; one that was interrupted is resumed, and the checksum compared."""

    path: str
    """On the vehicle."""
    folder: str
    """On this machine."""
    name: str
    """In that folder; a name that would leave it is refused."""
    overwrite: bool = False


class PutFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Upload a file, in place of the one that is there, and compare the checksum."""

    path: str
    """On the vehicle."""
    file: str
    """On this machine."""


class RemoveFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Remove a file of the vehicle."""

    path: str


class CompareFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Compare the checksum of a file of the vehicle with that of a file of this machine."""

    path: str
    """On the vehicle."""
    file: str
    """On this machine."""


class ListLogs(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """List the logs of the vehicle."""

    open_to_all = True


class GetLog(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Download a log of the newest list; one that was interrupted is resumed."""

    log: int
    folder: str
    name: str
    overwrite: bool = False


class EraseLogs(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Erase all logs of the vehicle."""
