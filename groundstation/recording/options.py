"""RecordOptions: where a station process records its session, as options of its command line."""

from __future__ import annotations

from pathlib import Path

import msgspec


class RecordOptions(msgspec.Struct, frozen=True):
    """Where the station records the session; sizes in MB."""

    folder: Path
    file_size: int
    folder_size: int

    @property
    def arguments(self) -> list[str]:
        """Options of the station process."""
        sizes = (f"--record-file-size={self.file_size}", f"--record-folder-size={self.folder_size}")
        return [f"--record-to={self.folder}", *sizes]
