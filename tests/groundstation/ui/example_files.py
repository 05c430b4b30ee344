"""Views of the Files screen to draw, and the files of a folder here."""

from __future__ import annotations

import os
from pathlib import Path

from groundstation.views.files import FileRow, FilesView, FolderRow, VehicleLog
from groundstation.views.requests import RequestLine, RequestsView
from tests.groundstation.ui.examples import NOON

LOGS = (
    VehicleLog(9, 1_699_000_000, 1_900_000), VehicleLog(10, 0, 12_400_000), VehicleLog(11, 1_699_600_000, 900_000),
    VehicleLog(12, 1_699_800_000, 8_100_000), VehicleLog(13, 1_699_900_000, 14_200_000),
    VehicleLog(14, 1_700_000_000, 3_600_000),
)  # fmt: skip
FOLDERS = (
    FolderRow("/", (FileRow("APM", None), FileRow("@SYS", None), FileRow("crash_dump.bin", 98_000))),
    FolderRow("/APM", (FileRow("LOGS", None), FileRow("TERRAIN", None))),
    FolderRow("/APM/LOGS", (FileRow("00000013.BIN", 14_200_000), FileRow("00000014.BIN", 3_600_000))),
)
FILES = FilesView(system=1, name="Rover 1", logs=LOGS, folders=FOLDERS)

TASKS = RequestsView(
    (
        RequestLine(7, "running", "download log 14", done=1_476_000, total=3_600_000, service="files", system=1),
        RequestLine(8, "running", "upload /APM/TERRAIN/S36E149.DAT", done=70_000, total=1_000_000, service="files",
                    system=1, waits="waits: you drive, and the line is slow"),
    ),
    (
        RequestLine(4, "accepted", "download /@SYS/threads.txt", "saved to /home/me/logs/threads.txt", 1100, 1100,
                    "files", system=1),
        RequestLine(5, "refused", "remove /APM/LOGS/00000013.BIN", "the vehicle protects the file", service="files",
                    system=1),
        RequestLine(6, "cancelled", "download log 12", done=100, total=8_100_000, service="files", system=1),
    ),
)  # fmt: skip
NO_TASKS = RequestsView((), ())
NO_SERVICE = FilesView(system=1, name="Rover 1", logs=(), folders=(FolderRow("/", problem="no answer after 16 tries"),))


def fill_folder(folder: Path) -> Path:
    """Put logs into a folder, all of one size and time that the frames show."""
    for number, (name, size) in enumerate(
        (("1-00013.bin", 14_200), ("1-00009.bin.part", 1_159_000), ("2-00003.bin", 900), ("threads.txt", 1100))
    ):
        (folder / name).write_bytes(bytes(size))
        os.utime(folder / name, (NOON - number, NOON - number))
    return folder
