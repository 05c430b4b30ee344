"""ParamStore: the parameters that ground stations have set, saved for the next start, and the form of their file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from vehicle.storage.checksummed_file import CorruptFileError, add_checksum, strip_checksum
from vehicle.storage.store import NullStore, Store

HEAD = "# Parameters set by ground stations. Written by the vehicle; a change by hand damages the file.\n"


def encode(values: Mapping[str, float]) -> bytes:
    """Return the file that holds `values`."""
    return add_checksum((HEAD + "".join(f"{name} {value!r}\n" for name, value in sorted(values.items()))).encode())


def decode(data: bytes) -> dict[str, float]:
    """Return the values of a file. Raises CorruptFileError."""
    try:
        lines = [line.split() for line in strip_checksum(data).decode().splitlines() if not line.startswith("#")]
        return {name: float(value) for name, value in lines}
    except ValueError as error:
        raise CorruptFileError(str(error)) from error


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
