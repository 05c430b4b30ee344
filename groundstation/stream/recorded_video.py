"""RecordedVideo: the pictures beside a telemetry log, found by their time. Damaged parts are left out and counted."""

from __future__ import annotations

import os
from array import array
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path

import msgspec

from groundstation.stream.names import find_parts, part_name
from groundstation.stream.rtp import MAX_UNIT
from groundstation.stream.video_file import HEAD, MAGIC, UnitHead, read_head

BLOCK = 1 << 16
"""Bytes of a damaged part that are searched at once."""


class RecordedUnit(msgspec.Struct, frozen=True):
    """One picture."""

    time: int
    """Unix time at which it came, us: that of the telemetry log."""
    data: bytes
    key: bool
    stamped: bool


class _Part:
    """One file, read from its begin, and on where it has grown."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.next = 0
        """Where the next head is expected."""
        self.descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)

    def read(self, at: int, size: int) -> bytes:
        return os.pread(self.descriptor, size, at)

    @property
    def size(self) -> int:
        return os.fstat(self.descriptor).st_size


class RecordedVideo:
    """All parts beside one log. `refresh` reads files, in a thread where a screen waits."""

    def __init__(self, log: Path) -> None:
        self.damaged = 0
        """Bytes that belong to no whole picture."""
        self.tail = 0
        """Bytes at the end that are not a whole picture: of one that is being written, or that was cut."""
        self._log = log
        self._parts: dict[Path, _Part] = {}
        self._times, self._places, self._sizes = array("q"), array("q"), array("q")
        self._files: list[_Part] = []
        self._keys = array("q")
        """Numbers of the pictures that need no earlier one."""
        self._flags = bytearray()

    def __len__(self) -> int:
        return len(self._times)

    @property
    def problem(self) -> str:
        """What is wrong with the files, in one line; "" if nothing is."""
        name = part_name(self._log, 1).name
        if not self._parts:
            return f"no pictures were recorded beside this log: there is no {name}"
        if not self._times:
            return f"{name}: has no picture that mavhelm recorded"
        return f"{self.damaged} damaged bytes of {name} are left out" if self.damaged else ""

    def refresh(self) -> None:
        """Read what is new. Raises OSError."""
        for path in find_parts(self._log):
            if path not in self._parts:
                self._parts[path] = _Part(path)
        self.tail = 0
        for part in self._parts.values():
            self._read_part(part)

    def close(self) -> None:
        """Close the files."""
        for part in self._parts.values():
            os.close(part.descriptor)
        self._parts.clear()

    def time(self, number: int) -> int:
        """Return when a picture came, us."""
        return self._times[number]

    def is_stamped(self, number: int) -> bool:
        """Return whether its time is in its top rows."""
        return bool(self._flags[number])

    def find(self, at: int) -> int | None:
        """Return the number of the newest picture at a time; None before the first one."""
        number = bisect_right(self._times, at) - 1
        return number if number >= 0 else None

    def key_before(self, number: int) -> int:
        """Return the number of the newest picture up to this one that needs no earlier one."""
        place = bisect_right(self._keys, number) - 1
        return self._keys[place] if place >= 0 else 0

    def read(self, number: int) -> bytes:
        """Return a picture with its head. Raises OSError."""
        return self._files[number].read(self._places[number], self._sizes[number])

    def units(self) -> Iterator[RecordedUnit]:
        """Yield all pictures without their heads. Raises OSError."""
        keys = set(self._keys)
        for number in range(len(self)):
            yield RecordedUnit(self.time(number), self.read(number)[HEAD:], number in keys, self.is_stamped(number))

    def _read_part(self, part: _Part) -> None:
        size = part.size
        while part.next + HEAD <= size:
            head = read_head(part.read(part.next, HEAD))
            if head is not None and head.size <= MAX_UNIT and part.next + HEAD + head.size > size:
                if (found := self._search(part, part.next + 1, size)) is None:
                    break  # it is being written, or was cut
                self._skip(part, found)
            elif head is not None and head.fits(part.read(part.next + HEAD, min(head.size, MAX_UNIT))):
                self._add(part, head)
            else:
                found = self._search(part, part.next + 1, size)
                self._skip(part, max(part.next + 1, size - HEAD + 1) if found is None else found)
        self.tail += max(0, size - part.next)

    def _skip(self, part: _Part, to: int) -> None:
        self.damaged += to - part.next
        part.next = to

    def _search(self, part: _Part, at: int, size: int) -> int | None:
        """Return where the next head may begin."""
        while at < size:
            found = part.read(at, BLOCK + len(MAGIC)).find(MAGIC)
            if found >= 0:
                return at + found
            at += BLOCK
        return None

    def _add(self, part: _Part, head: UnitHead) -> None:
        number = len(self._times)
        self._times.append(max(head.time, self._times[-1]) if number else head.time)
        self._places.append(part.next)
        self._sizes.append(HEAD + head.size)
        self._files.append(part)
        self._flags.append(head.stamped)
        if head.key:
            self._keys.append(number)
        part.next += HEAD + head.size
