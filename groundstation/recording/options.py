"""RecordOptions: where a station process records its session, as options of its command line."""

from __future__ import annotations

from pathlib import Path

import msgspec


class RecordOptions(msgspec.Struct, frozen=True):
    """Where the station records the session; sizes in MB."""

    folder: Path
    file_size: int
    folder_size: int
    video: bool = True
    """Pictures of the camera, too."""
    video_folder_size: int = 2000

    @property
    def arguments(self) -> list[str]:
        """Options of the station process."""
        sizes = (f"--record-file-size={self.file_size}", f"--record-folder-size={self.folder_size}")
        video = (f"--record-video-folder-size={self.video_folder_size if self.video else 0}",)
        return [f"--record-to={self.folder}", *sizes, *video]
