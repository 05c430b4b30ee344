"""ParamStore: the parameters that ground stations have set, saved for the next start."""

from __future__ import annotations

from functools import partial

from vehicle.storage.checksummed_file import CorruptFileError
from vehicle.storage.param_file import decode, encode
from vehicle.storage.store import NullStore, Store

NAME = "parameters"
"""Name of the file."""


class ParamStore:
    """The saved parameters, all in one file of a store."""

    def __init__(self, store: Store | None = None) -> None:
        """Read the saved parameters; never raises. Without a `store` nothing is saved."""
        self.values: dict[str, float] = {}
        """Name -> saved value."""
        self.damage: str | None = None
        """Why the saved values could not be read: the vehicle has its defaults."""
        self._store: Store = store or NullStore()
        try:
            self.values = self._store.read(NAME, decode) or {}
        except CorruptFileError as error:
            self.damage = f"parameter file {error}"

    @property
    def is_volatile(self) -> bool:
        """Values end with the program."""
        return isinstance(self._store, NullStore)

    @property
    def problem(self) -> str | None:
        """Why values are not saved, one line."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._store.idle

    def set(self, name: str, value: float) -> None:
        """Change a value and queue the file for writing. Never blocks and never raises."""
        self.values[name] = value
        self.save()

    def save(self) -> None:
        """Queue the file with all values for writing. Never blocks and never raises."""
        self._store.write(NAME, partial(encode, dict(self.values)))

    def close(self) -> None:
        """Wait until the file is written."""
        self._store.close()
