"""Names of recorded pictures: those of the telemetry log beside them, in parts. `LOG.h264`, `LOG.2.h264`, ..."""

from __future__ import annotations

import re
from pathlib import Path

SUFFIX = ".h264"
_PART = r"(?:\.(\d{1,6}))?\.h264"
_NAME = re.compile(r"(\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d(?:-\d+)?)" + _PART)


def part_name(log: Path, number: int) -> Path:
    """Return the path of a part, from 1."""
    return log.with_name(f"{log.stem}{SUFFIX}" if number == 1 else f"{log.stem}.{number}{SUFFIX}")


def find_parts(log: Path) -> list[Path]:
    """Return the parts beside a log, the first ones first. Raises OSError."""
    shape = re.compile(re.escape(log.stem) + _PART)
    return sorted((path for path in log.parent.iterdir() if shape.fullmatch(path.name)), key=part_number)


def part_number(path: Path) -> int:
    """Return the number of a part."""
    found = re.search(_PART + "$", path.name)
    return int(found[1] or 1) if found else 1


def recorded_order(path: Path) -> tuple[str, int, int] | None:
    """Return what sorts recordings of stations by age; None for a file of another name."""
    found = _NAME.fullmatch(path.name)
    return None if found is None else (found[1][:19], int(found[1][20:] or 1), int(found[2] or 1))
