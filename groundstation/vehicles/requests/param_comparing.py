"""The file that the operator compares with the parameters of one vehicle."""

from __future__ import annotations

from groundstation.formats.errors import FileFormatError
from groundstation.formats.param_file import ParamFile, parse_params
from groundstation.vehicles.requests.requests import RequestBook


class ParamComparing:
    """Keeps one file; a damaged one replaces nothing."""

    def __init__(self, book: RequestBook) -> None:
        self._book = book
        self.name = ""
        """Empty: no file is compared."""
        self.file: ParamFile | None = None
        self.values: dict[str, float] = {}
        """Name -> value in the file."""

    def open(self, number: int, name: str, text: str, now: float) -> None:
        """Compare with this file; without a name with none."""
        if not self._book.begin(number, f"compare with {name}" if name else "close the file"):
            return
        try:
            file = parse_params(text, name) if name else None
        except FileFormatError as error:
            self._book.refuse(number, str(error), now, by_vehicle=False)
            return
        self.name, self.file = name, file
        self.values = {line.name: line.value for line in file.lines} if file else {}
        self._book.accept(number, f"{len(self.values)} parameters" if file else "")
