"""A layer of the map: the shapes of a file, as the process that reads it prints them."""

from __future__ import annotations

import msgspec

from groundstation.geo import Place


class LayerShape(msgspec.Struct, frozen=True, array_like=True):
    """A point (one place), a line, or an area (`closed`)."""

    places: tuple[Place, ...]
    closed: bool = False
    name: str = ""


class LayerDocument(msgspec.Struct, frozen=True):
    """The shapes of a file."""

    shapes: tuple[LayerShape, ...]
    total: int = 0
    """Places in the file; more than in `shapes`, if they were thinned."""
