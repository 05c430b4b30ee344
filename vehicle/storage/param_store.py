"""The parameters that are kept over a restart; how a file is written whole is file_writer.py's."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from vehicle.storage.checksummed_file import DamagedError
from vehicle.storage.file_writer import Scribe, read
from vehicle.storage.param_file import dump, parsed

NAME = "parameters"


class ParamStore:
    """Fits `vehicle.commands.params.Keeper`."""

    def __init__(self, folder: Path) -> None:
        """Reads what there is; never raises."""
        self.values: dict[str, float] = {}
        """What is kept."""
        self.damage: str | None = None
        """Why the kept values could not be read: the vehicle has its defaults."""
        self._scribe = Scribe(folder)
        try:
            self.values = read(folder / NAME, parsed) or {}
        except DamagedError as error:
            self.damage = f"parameter file {error}"

    @property
    def problem(self) -> str | None:
        """Why values are not kept, one line."""
        return self._scribe.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._scribe.idle

    def keep(self, name: str, value: float) -> None:
        """Have it written."""
        self.values[name] = value
        self.save()

    def save(self) -> None:
        """Have all of them written."""
        self._scribe.write(NAME, partial(dump, dict(self.values)))

    def close(self) -> None:
        """Wait for what is being written."""
        self._scribe.close()
