"""Intents about the files and logs of a vehicle. The station writes and reads the files of this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.intents.services import ServiceIntent

if TYPE_CHECKING:
    from groundstation.vehicles.services import VehicleServices

SAME, DIFFERS = "same", "differs"
"""With which the detail of a CompareFile that was accepted begins."""


class ListFolder(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """List a folder of the vehicle by MAVLink FTP."""

    service, what = "folders", "list a folder"
    open_to_all = True

    path: str

    def start(self, services: VehicleServices, now: float) -> None:
        services.folders.list_folder(self.request, self.path, now)


class GetFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Download a file; one that was interrupted is resumed, and the checksum compared."""

    service, what = "files", "download a file"

    path: str
    """On the vehicle."""
    folder: str
    """On this machine."""
    name: str
    """In that folder; a name that would leave it is refused."""
    overwrite: bool = False

    def start(self, services: VehicleServices, now: float) -> None:
        services.transfers.get_file(self.request, self.path, self.folder, self.name, now, overwrite=self.overwrite)


class PutFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Upload a file, in place of the one that is there, and compare the checksum."""

    service, what = "files", "upload a file"

    path: str
    """On the vehicle."""
    file: str
    """On this machine."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.transfers.put_file(self.request, self.path, self.file, now)


class RemoveFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Remove a file of the vehicle."""

    service, what = "files", "remove a file"

    path: str

    def start(self, services: VehicleServices, now: float) -> None:
        services.files.remove(self.request, self.path, now)


class CompareFile(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Compare the checksum of a file of the vehicle with that of a file of this machine."""

    service, what = "files", "compare a file"

    path: str
    """On the vehicle."""
    file: str
    """On this machine."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.comparing.compare(self.request, self.path, self.file, now)


class ListLogs(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """List the logs of the vehicle."""

    service, what = "folders", "list logs"
    open_to_all = True

    def start(self, services: VehicleServices, now: float) -> None:
        services.logs.list_logs(self.request, now)


class GetLog(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Download a log of the newest list; one that was interrupted is resumed."""

    service, what = "files", "download a log"

    log: int
    folder: str
    name: str
    overwrite: bool = False

    def start(self, services: VehicleServices, now: float) -> None:
        services.transfers.get_log(self.request, self.log, self.folder, self.name, now, overwrite=self.overwrite)


class EraseLogs(ServiceIntent, frozen=True, tag=True, kw_only=True):
    """Erase all logs of the vehicle."""

    service, what = "files", "erase all logs"

    def start(self, services: VehicleServices, now: float) -> None:
        services.logs.erase(self.request, now)
