"""The parameters that are kept over a restart; how a file is written whole is file_writer.py's."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from vehicle.storage.checksummed_file import CorruptFileError
from vehicle.storage.file_writer import FileWriter, read_file
from vehicle.storage.param_file import decode, encode

NAME = "parameters"


class ParamStore:
    """Fits `vehicle.commands.params.ParamStoreLike`."""

    def __init__(self, folder: Path) -> None:
        """Reads what there is; never raises."""
        self.values: dict[str, float] = {}
        """What is kept."""
        self.damage: str | None = None
        """Why the kept values could not be read: the vehicle has its defaults."""
        self._writer = FileWriter(folder)
        try:
            self.values = read_file(folder / NAME, decode) or {}
        except CorruptFileError as error:
            self.damage = f"parameter file {error}"

    @property
    def problem(self) -> str | None:
        """Why values are not kept, one line."""
        return self._writer.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._writer.idle

    def set(self, name: str, value: float) -> None:
        """Have it written."""
        self.values[name] = value
        self.save()

    def save(self) -> None:
        """Have all of them written."""
        self._writer.write(NAME, partial(encode, dict(self.values)))

    def close(self) -> None:
        """Wait for what is being written."""
        self._writer.close()
