"""Builds the view of the files and logs of a vehicle."""

from __future__ import annotations

from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.requests.folder_cache import ListedFolder
from groundstation.vehicles.requests.transfer_requests import log_ending
from groundstation.views.files import FileRow, FilesRequest, FilesView, FolderRow, VehicleLog

MAX_ROWS = 2000
"""Entries of all folders of one view, which is a packet of at most 256 kB."""


def build_files(contact: Contact, request: FilesRequest) -> FilesView:
    """Return what was listed so far, of one vehicle."""
    services = contact.services
    logs = services.logs.logs if services else None
    listed = services.folders.folders if services else {}
    return FilesView(
        system=contact.state.system,
        name=contact.state.name,
        log_ending=log_ending(contact.state.autopilot),
        logs=None if logs is None else tuple(VehicleLog(each.number, each.begun, each.size) for each in logs),
        folders=tuple(_folders(request.folders, listed)),
    )


def _folders(paths: tuple[str, ...], listed: dict[str, ListedFolder]) -> list[FolderRow]:
    rows, room = [], MAX_ROWS
    for path in paths:
        folder = listed.get(path)
        if folder is not None:
            entries = tuple(FileRow(entry.name, entry.size) for entry in folder.entries[:room])
            rows.append(FolderRow(path, entries, folder.problem))
            room -= len(entries)
    return rows
