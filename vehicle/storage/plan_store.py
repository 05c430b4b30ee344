"""PlanStore: mission, fence and rally points, saved for the next start, each in a file of its own.

The files are the ones that MAVLink FTP serves (link/services/mission/files.py), with a checksum, which is a comment to
the tools that read them.
"""

from __future__ import annotations

from functools import partial

from dialects.enums import MissionType
from link.services.mission.files import FILE_TYPES, PlanFileError, decode_plan, encode_plan
from link.services.mission.items import Items
from vehicle.storage.checksummed_file import CorruptFileError, add_checksum, strip_checksum
from vehicle.storage.store import NullStore, PendingWrite, Store

FILES = {kind: name for name, kind in FILE_TYPES.items()}


class PlanStore:
    """The saved plans, as they were at the start."""

    def __init__(self, store: Store | None = None) -> None:
        """Read the saved plans; never raises. Without a `store` nothing is saved."""
        self.plans: dict[MissionType, Items] = {}
        """Plan type -> saved items."""
        self.damage: dict[MissionType, str] = {}
        """Plan type -> why its file could not be read."""
        self._store: Store = store or NullStore()
        for kind, name in FILES.items():
            try:
                self.plans[kind] = self._store.read(name, decode) or ()
            except CorruptFileError as error:
                self.damage[kind] = f"saved {kind.name.lower()} {error}"

    @property
    def is_volatile(self) -> bool:
        """Plans end with the program."""
        return isinstance(self._store, NullStore)

    @property
    def problem(self) -> str | None:
        """Why plans are not saved, one line."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._store.idle

    def save(self, kind: MissionType, items: Items) -> PendingWrite:
        """Queue a plan for writing; the result reports completion. Never blocks and never raises."""
        return self._store.write(FILES[kind], partial(encode, items))

    def close(self) -> None:
        """Wait until the files are written."""
        self._store.close()


def encode(items: Items) -> bytes:
    """Return the file of a plan."""
    return add_checksum(encode_plan(items))


def decode(data: bytes) -> Items:
    """Return the plan of a file. Raises CorruptFileError."""
    try:
        return decode_plan(strip_checksum(data))
    except PlanFileError as error:
        raise CorruptFileError(str(error)) from error
