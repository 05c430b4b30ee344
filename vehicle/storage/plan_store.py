"""The plans that are kept over a restart, each in a file of its own; how a file is written whole is file_writer.py's.

The files are the ones that MAVLink FTP serves (link/services/mission/files.py) and a checksum, which is a comment to
the tools that read them.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from dialects.enums import MissionType
from link.services.mission.files import NAMES, PlanFileError, read, write
from link.services.mission.items import Items
from vehicle.storage import file_writer
from vehicle.storage.checksummed_file import DamagedError, sealed, unsealed

FILES = {kind: name for name, kind in NAMES.items()}


class PlanStore:
    """Fits `vehicle.storage.plan_keeping.PlanKeeper`."""

    def __init__(self, folder: Path) -> None:
        """Reads what there is; never raises."""
        self.plans: dict[MissionType, Items] = {}
        """What is kept."""
        self.damage: dict[MissionType, str] = {}
        """Why a kept plan could not be read."""
        self._scribe = file_writer.Scribe(folder)
        for kind, name in FILES.items():
            try:
                self.plans[kind] = file_writer.read(folder / name, parsed) or ()
            except DamagedError as error:
                self.damage[kind] = f"saved {kind.name.lower()} {error}"

    @property
    def problem(self) -> str | None:
        """Why plans are not kept, one line."""
        return self._scribe.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._scribe.idle

    def keep(self, kind: MissionType, items: Items) -> file_writer.Writing:
        """Have it written."""
        return self._scribe.write(FILES[kind], partial(dump, items))

    def close(self) -> None:
        """Wait for what is being written."""
        self._scribe.close()


def dump(items: Items) -> bytes:
    """The file of a plan."""
    return sealed(write(items))


def parsed(data: bytes) -> Items:
    """The plan of a file. Raises DamagedError."""
    try:
        return read(unsealed(data))
    except PlanFileError as error:
        raise DamagedError(str(error)) from error
