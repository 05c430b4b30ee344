"""CSV files, JSON lines, and a part of a log as a log again. Numbers have as many digits as their type, and no more."""

from __future__ import annotations

import contextlib
import io
import json
import math
import struct
from collections.abc import Iterator
from typing import Any, TextIO

from dialects.messages import Message, field_value
from groundstation.disk.new_file import NewFile, NewFolder
from groundstation.export.exporter import ExportError, LogInfo
from groundstation.export.log_time import iso_time
from groundstation.export.sample import Sample
from groundstation.formats.csv_row import csv_row
from link.tlog.tlog import encode_record

_FLOAT = struct.Struct("<f")


def field_values(message: Message) -> Iterator[tuple[str, Any]]:
    """Yield name and value of each field: numbers, texts, and lists of numbers."""
    kind = type(message)
    for name, of in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        value = field_value(message, name)
        if of == "float":
            value = [shortest(each) for each in value] if isinstance(value, list) else shortest(value)
        yield name, value


def shortest(value: float) -> float:
    """Return the number with the fewest digits that is the same float32: 0.1 and not 0.10000000149011612."""
    if not math.isfinite(value):
        return value
    for digits in (7, 8):
        near = float(f"{value:.{digits}g}")
        if abs(near) < 3.4e38 and _FLOAT.unpack(_FLOAT.pack(near))[0] == value:
            return near
    return float(f"{value:.9g}")


_HEAD = ("time", "seconds", "system", "component")
CSV_SUFFIX = ".csv"


class JsonExport:
    """Writes one object a line: time, source, name, and the fields as MAVLink names them."""

    learns = False

    def __init__(self, path: str, log: LogInfo) -> None:
        self.target = NewFile(path)
        self.count = 0
        self._begin = log.begin

    def add(self, sample: Sample) -> None:
        """Write a message of the dialect."""
        if sample.kind is None:
            return
        line = {
            "time": iso_time(sample.microseconds),
            "seconds": (sample.microseconds - self._begin) / 1e6,
            "system": sample.system,
            "component": sample.component,
            "name": sample.name,
            "fields": {name: _finite(value) for name, value in field_values(sample.message)},
        }
        self.target.file.write(json.dumps(line, separators=(",", ":")).encode() + b"\n")
        self.count += 1

    def finish(self) -> None:
        """Write nothing more."""

    def discard(self) -> None:
        """Remove what is not in its place."""
        self.target.discard()


def _finite(value: Any) -> Any:
    """Return the value as JSON can hold it: numbers that are not finite become null."""
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


class CsvExport:
    """Writes a folder with one file for each kind of message, or one file for the only kind."""

    learns = False

    def __init__(self, path: str, log: LogInfo) -> None:
        one = path.lower().endswith(CSV_SUFFIX)
        if one and not log.only:
            raise ExportError(f"{path}: one file has one kind of message: add --messages NAME, or name a folder")
        self.count = 0
        self._begin = log.begin
        self._files: dict[str, TextIO] = {}
        self.target: NewFile | NewFolder = NewFile(path) if one else NewFolder(path)

    def add(self, sample: Sample) -> None:
        """Write a message of the dialect."""
        if sample.kind is None:
            return
        values = list(field_values(sample.message))
        file = self._files.get(sample.name) or self._open(sample.name, sample.message)
        cells: list[Any] = [
            iso_time(sample.microseconds), f"{(sample.microseconds - self._begin) / 1e6:.6f}", sample.system,
            sample.component,
        ]  # fmt: skip
        for _, value in values:
            cells += value if isinstance(value, list) else [value]
        file.write(csv_row(cells) + "\n")
        self.count += 1

    def finish(self) -> None:
        """Close all files."""
        for file in self._files.values():
            file.close()

    def discard(self) -> None:
        """Remove what is not in its place."""
        with contextlib.suppress(OSError):
            self.finish()
        self.target.discard()

    def _open(self, name: str, message: Message) -> TextIO:
        """Begin a file with the titles of the columns: one for each number of an array."""
        if isinstance(self.target, NewFolder):
            file: TextIO = (self.target.folder / f"{name}{CSV_SUFFIX}").open("w", encoding="utf-8", newline="")
        else:
            file = io.TextIOWrapper(self.target.file, encoding="utf-8", newline="", write_through=True)
        titles = list(_HEAD)
        for field, value in field_values(message):
            titles += [f"{field}[{at}]" for at in range(len(value))] if isinstance(value, list) else [field]
        file.write(csv_row(titles) + "\n")
        self._files[name] = file
        return file


class TlogExport:
    """Writes the frames as they are, those of unknown messages too."""

    learns = False

    def __init__(self, path: str, log: LogInfo) -> None:
        self.target = NewFile(path)
        self.count = 0

    def add(self, sample: Sample) -> None:
        """Write a frame, unless it holds a key."""
        record = encode_record(sample.microseconds, sample.raw)
        self.target.file.write(record)
        self.count += bool(record)

    def finish(self) -> None:
        """Write nothing more."""

    def discard(self) -> None:
        """Remove what is not in its place."""
        self.target.discard()
