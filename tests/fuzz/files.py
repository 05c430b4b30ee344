"""Texts as files, for readers that take a path."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path


def as_file(text: str, read: Callable[[Path], object]) -> object:
    """Read `text` from a file."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        path = Path(folder) / "fuzzed.toml"
        path.write_bytes(text.encode(errors="surrogatepass"))
        return read(path)
