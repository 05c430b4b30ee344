"""View of the files and logs of a vehicle."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest


class FilesRequest(ViewRequest, frozen=True):
    """The logs of the selected vehicle, and the folders that were listed."""

    folders: tuple[str, ...] = ()
    """Those that the screen shows."""


class VehicleLog(msgspec.Struct, frozen=True):
    """One log on the vehicle."""

    number: int
    begun: int
    """Unix time by the clock of the vehicle, s; 0: not known."""
    size: int


class FileRow(msgspec.Struct, frozen=True):
    """One entry of a folder on the vehicle."""

    name: str
    size: int | None
    """Bytes; None: a folder."""


class FolderRow(msgspec.Struct, frozen=True):
    """A folder that was listed."""

    path: str
    entries: tuple[FileRow, ...] = ()
    problem: str = ""
    """Why it could not be listed, e.g. because the vehicle has no file service."""


class FilesView(View, frozen=True, kw_only=True):
    """Files and logs of the selected vehicle."""

    system: int
    name: str
    log_ending: str = ".bin"
    """Ending of the name of a log: .ulg for PX4."""
    logs: tuple[VehicleLog, ...] | None = None
    """None: not listed yet."""
    folders: tuple[FolderRow, ...] = ()
