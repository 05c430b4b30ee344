"""The recordings of real vehicles that tests play: tests/recordings/README.md says what is in each."""

from __future__ import annotations

import lzma
from pathlib import Path

RECORDINGS = Path(__file__).parent / "recordings"
WHOLE_ARDUROVER = RECORDINGS / "ardurover-whole.tlog.xz"


def read_recording(path: Path) -> bytes:
    """Return the bytes of a telemetry log, unpacked where its name ends in .xz. Raises OSError, lzma.LZMAError."""
    data = path.read_bytes()
    return lzma.decompress(data) if path.suffix == ".xz" else data
