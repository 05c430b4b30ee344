"""Export: one pass through a log, for all outputs at once, in steps of some milliseconds."""

from __future__ import annotations

import fnmatch
import os
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import BinaryIO

import msgspec

from groundstation.export.exporter import Exporter, ExportError, LogInfo, NothingToExportError, PictureExporter
from groundstation.export.log_time import LogTime
from groundstation.export.pictures import NAME as PICTURES
from groundstation.export.pictures import PictureSource
from groundstation.export.sample import Sample
from groundstation.export.table import FORMATS
from link.tlog.scan import MAX_RECORD, Gap, LogFrame, foreign_log
from link.tlog.tlog import read_log


class ExportChoice(msgspec.Struct, frozen=True):
    """Which messages are exported: from `begin` on, before `end`; patterns are names in upper case."""

    begin: LogTime | None = None
    end: LogTime | None = None
    patterns: tuple[str, ...] = ()
    system: int | None = None

    def takes(self, name: str, system: int | None) -> bool:
        """Return whether messages of a name, of a system, are chosen."""
        named = not self.patterns or any(fnmatch.fnmatchcase(name, each) for each in self.patterns if name)
        return named and self.system in (None, system)

    @property
    def only(self) -> str:
        """The message, if it can be only one."""
        name = self.patterns[0] if len(self.patterns) == 1 else ""
        return "" if any(each in name for each in "*?[") else name


class ExportOutput(msgspec.Struct, frozen=True):
    """A file to write. `format` is a key of FORMATS."""

    format: str
    path: str


class Written(msgspec.Struct, frozen=True):
    """A file that was written."""

    format: str
    path: str
    count: int


class Damage(msgspec.Struct, frozen=True):
    """A part of the log that holds no record, and the time of the record before, us from the start."""

    offset: int
    size: int
    after: int


class ExportResult(msgspec.Struct):
    """What an export has done."""

    written: list[Written] = msgspec.field(default_factory=list)
    empty: list[ExportOutput] = msgspec.field(default_factory=list)
    """Outputs for which there was nothing: they are not written."""
    damage: list[Damage] = msgspec.field(default_factory=list)
    """The first of them."""
    damaged_parts: int = 0
    damaged_bytes: int = 0
    pictures: int = 0
    """Recorded pictures that were written."""
    damaged_pictures: int = 0
    """Bytes of their files that belong to no whole picture."""
    unknown: Counter[int] = msgspec.field(default_factory=Counter)
    """Id that is in no dialect known here -> messages that were left out."""

    @property
    def whole(self) -> bool:
        """Whether nothing is missing."""
        return not (self.empty or self.damaged_parts or self.damaged_pictures or self.unknown)


KEPT_DAMAGE = 20
"""Damaged parts that are listed one by one."""


class Export:
    """Reads `path` and writes the outputs. Files appear when all of it is done, and not at all otherwise."""

    def __init__(self, path: str, outputs: Sequence[ExportOutput], choice: ExportChoice) -> None:
        self._path = path
        self._outputs = outputs
        self._choice = choice
        self.result = ExportResult()
        self.size = 0
        """Bytes of the log."""

    def steps(self) -> Generator[int]:
        """Do it; yield the bytes that were read so far. Raises ExportError, NothingToExportError, OSError."""
        with ExitStack() as stack:
            file = stack.enter_context(_open(self._path))
            self.size = os.fstat(file.fileno()).st_size
            work = _Pass(self._path, file, self._choice, self.result)
            exporters: list[Exporter] = []
            for output in self._outputs:
                exporter = FORMATS[output.format].create(output.path, work.log)
                stack.callback(exporter.discard)
                exporters.append(exporter)
            self._add_pictures(stack, work, exporters)
            keeps = all(FORMATS[output.format].keeps_unknown for output in self._outputs)
            yield from work.run(file, exporters, count_unknown=not keeps)
            self._end(exporters)

    def _add_pictures(self, stack: ExitStack, work: _Pass, exporters: Sequence[Exporter]) -> None:
        """Have recorded pictures written where a format takes them, and nobody chose other things."""
        taking = [each for each in exporters if isinstance(each, PictureExporter)]
        if taking and self._choice.takes(PICTURES, None):
            source = PictureSource(Path(self._path), work.begin, work.end)
            stack.callback(source.close)
            work.pictures, work.taking = source, taking

    def _end(self, exporters: Sequence[Exporter]) -> None:
        for output, exporter in zip(self._outputs, exporters, strict=True):
            if not exporter.count:
                self.result.empty.append(output)
                continue
            exporter.finish()
            self.result.written.append(Written(output.format, output.path, exporter.count))
        if not self.result.written:
            raise NothingToExportError
        for exporter in exporters:
            if exporter.count:
                exporter.target.commit()


class _Pass:
    """Goes through the records of a log. Raises ExportError if there is none."""

    def __init__(self, path: str, file: BinaryIO, choice: ExportChoice, result: ExportResult) -> None:
        if foreign := foreign_log(file.read(MAX_RECORD)):
            raise ExportError(f"{path}: {foreign}")
        begin = next((each.stamp for part in read_log(file) for each in part if isinstance(each, LogFrame)), None)
        if begin is None:
            raise ExportError(f"{path}: this is not a telemetry log: it has no MAVLink frame")
        self.log = LogInfo(Path(path).name, begin, choice.only)
        self._choice = choice
        self.begin = choice.begin.resolve(begin) if choice.begin else 0
        self.end = choice.end.resolve(begin) if choice.end else 1 << 64
        if self.end <= self.begin:
            raise ExportError("--to is not after --from")
        self._result = result
        self._time = begin
        self._wanted: dict[tuple[int, str], bool] = {}
        self.pictures: PictureSource | None = None
        self.taking: Sequence[PictureExporter] = ()

    def run(self, file: BinaryIO, exporters: Sequence[Exporter], *, count_unknown: bool) -> Iterator[int]:
        """Give all samples to the exporters that want them."""
        plain = [each for each in exporters if not each.learns]
        learning = [each for each in exporters if each.learns]
        for part in read_log(file):
            for each in part:
                if isinstance(each, Gap):
                    self._count_gap(each)
                    continue
                sample = self._sample(each)
                for exporter in learning:
                    exporter.add(sample)
                if sample.chosen:
                    if sample.kind is None and count_unknown:
                        self._result.unknown[sample.id] += 1
                    for exporter in plain:
                        exporter.add(sample)
            self._add_pictures(self._time)
            yield file.tell()
        self._add_pictures(self.end)

    def _add_pictures(self, until: int) -> None:
        """Give the recorded pictures up to a time to those that take them."""
        if self.pictures is None:
            return
        for unit in self.pictures.pop(until):
            self._result.pictures += 1
            for exporter in self.taking:
                exporter.add_picture(unit)
        self._result.damaged_pictures = self.pictures.damaged

    def _sample(self, frame: LogFrame) -> Sample:
        sample = Sample(frame)
        self._time = frame.stamp
        sample.chosen = self.begin <= self._time < self.end and self._is_wanted(sample)
        return sample

    def _is_wanted(self, sample: Sample) -> bool:
        key = sample.system, sample.name
        known = self._wanted.get(key)
        if known is None:
            known = self._wanted[key] = self._choice.takes(sample.name, sample.system)
        return known

    def _count_gap(self, gap: Gap) -> None:
        if not self.begin <= self._time < self.end:
            return
        self._result.damaged_parts += 1
        self._result.damaged_bytes += gap.size
        if len(self._result.damage) < KEPT_DAMAGE:
            self._result.damage.append(Damage(gap.offset, gap.size, self._time - self.log.begin))


def _open(path: str) -> BinaryIO:
    """Open a log. Raises ExportError."""
    if not Path(path).is_file():  # reading a pipe might never end, and it cannot be read twice
        raise ExportError(f"{path}: {'not a file' if Path(path).exists() else 'no such file'}: name a telemetry log")
    try:
        return Path(path).open("rb")
    except OSError as error:
        raise ExportError(f"{path}: {error.strerror}") from error
