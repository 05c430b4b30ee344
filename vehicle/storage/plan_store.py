"""The plans that are kept over a restart, each in a file of its own; how a file is written whole is file_writer.py's.

The files are the ones that MAVLink FTP serves (link/services/mission/files.py) and a checksum, which is a comment to
the tools that read them.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from dialects.enums import MissionType
from link.services.mission.files import FILE_TYPES, PlanFileError, decode_plan, encode_plan
from link.services.mission.items import Items
from vehicle.storage import file_writer
from vehicle.storage.checksummed_file import CorruptFileError, add_checksum, strip_checksum

FILES = {kind: name for name, kind in FILE_TYPES.items()}


class PlanStore:
    """Fits `vehicle.storage.plan_keeping.PlanStoreLike`."""

    def __init__(self, folder: Path) -> None:
        """Reads what there is; never raises."""
        self.plans: dict[MissionType, Items] = {}
        """What is kept."""
        self.damage: dict[MissionType, str] = {}
        """Why a kept plan could not be read."""
        self._writer = file_writer.FileWriter(folder)
        for kind, name in FILES.items():
            try:
                self.plans[kind] = file_writer.read_file(folder / name, decode) or ()
            except CorruptFileError as error:
                self.damage[kind] = f"saved {kind.name.lower()} {error}"

    @property
    def problem(self) -> str | None:
        """Why plans are not kept, one line."""
        return self._writer.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._writer.idle

    def save(self, kind: MissionType, items: Items) -> file_writer.PendingWrite:
        """Have it written."""
        return self._writer.write(FILES[kind], partial(encode, items))

    def close(self) -> None:
        """Wait for what is being written."""
        self._writer.close()


def encode(items: Items) -> bytes:
    """The file of a plan."""
    return add_checksum(encode_plan(items))


def decode(data: bytes) -> Items:
    """The plan of a file. Raises DamagedError."""
    try:
        return decode_plan(strip_checksum(data))
    except PlanFileError as error:
        raise CorruptFileError(str(error)) from error
