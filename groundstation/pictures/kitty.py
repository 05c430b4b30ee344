"""Pictures by the graphics protocol of kitty (https://sw.kovidgoyal.net/kitty/graphics-protocol/)."""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Iterator

from groundstation.pictures.picture import Picture

CHUNK = 4096
"""Bytes of base64 in one sequence, at most; the protocol demands it."""
IMAGE_IDS = (7301, 7302)
"""Two images, shown in turn: the old one goes after the new one stands, so that nothing flickers."""
PLACEMENT = 1
COMPRESSION = 1
"""Level of zlib: more costs time and saves little."""
QUIET = "q=2"
"""No answers, not even of errors: they would come as input."""


class KittyEncoder:
    """Draws pictures of any size into an area of cells; the terminal scales them."""

    def __init__(self) -> None:
        self._shown = False
        self._next = 0

    def encode(self, picture: Picture, columns: int, rows: int) -> str:
        """Return what shows a picture at the cursor, which stays where it is, and deletes the one before."""
        ours, other = IMAGE_IDS[self._next], IMAGE_IDS[1 - self._next]
        head = (
            f"a=T,{QUIET},f=24,o=z,t=d,s={picture.width},v={picture.height},i={ours},p={PLACEMENT},"
            f"c={columns},r={rows},C=1"
        )
        data = b64encode(zlib.compress(picture.rgb, COMPRESSION)).decode()
        old = _deletion(other) if self._shown else ""
        self._shown, self._next = True, 1 - self._next
        return "".join(_sequences(head, data)) + old

    def clear(self) -> str:
        """Return what deletes the pictures."""
        self._shown = False
        return "".join(map(_deletion, IMAGE_IDS))


def _sequences(head: str, data: str) -> Iterator[str]:
    for at in range(0, len(data), CHUNK):
        more = int(at + CHUNK < len(data))
        keys = f"{head},m={more}" if not at else f"m={more},{QUIET}"
        yield f"\x1b_G{keys};{data[at : at + CHUNK]}\x1b\\"


def _deletion(image: int) -> str:
    return f"\x1b_Ga=d,d=I,i={image},{QUIET}\x1b\\"
