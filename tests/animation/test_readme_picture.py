"""README begins with a picture that moves, is small enough for a page, and lasts as long as a person looks."""

from __future__ import annotations

import re
import struct

from tests.animation import LARGEST, PICTURE, ROOT
from tests.groundstation.ui.png_palette import read_chunks

README = ROOT / "README.md"


def test_the_first_picture_of_readme_is_the_recorded_drive() -> None:
    first = re.search(r"!\[[^\]]+\]\(([^)]+)\)", README.read_text())
    assert first is not None
    assert README.parent / first[1] == PICTURE


def test_the_picture_of_readme_is_animated_and_small() -> None:
    png = PICTURE.read_bytes()
    assert len(png) <= LARGEST
    chunks = list(read_chunks(png))
    [(count, repeats)] = [struct.unpack(">II", body) for name, body in chunks if name == b"acTL"]
    delays = [struct.unpack(">HH", body[20:24]) for name, body in chunks if name == b"fcTL"]
    assert len(delays) == count >= 40
    assert repeats == 0, "for ever"
    assert 8.0 <= sum(part / (whole or 100) for part, whole in delays) <= 20.0
