"""MapLayers: the GeoJSON files that the map shows behind the plans."""

from __future__ import annotations

import math
from collections.abc import Iterable

from groundstation.formats.layer import LayerDocument
from groundstation.geo import LocalFrame, Place, Point, bearing
from groundstation.ui.map.draw.plan_map_value import MapShape

MAX_LAYERS = 8
"""Files that are shown at once; the oldest goes first."""
FAR = 20_000.0
"""m from the middle of the map beyond which a shape is not fitted into the view."""


class MapLayers:
    """Lives as long as the app. Shapes are converted to metres once for each frame of the map."""

    def __init__(self) -> None:
        self._documents: dict[str, LayerDocument] = {}
        self.hidden = False
        self._frame: LocalFrame | None = None
        self._shapes: tuple[MapShape, ...] = ()
        self._corners: tuple[Point, ...] = ()

    def add(self, name: str, document: LayerDocument) -> None:
        """Show a file, in place of the one that had this name."""
        self._documents.pop(name, None)
        self._documents[name] = document
        while len(self._documents) > MAX_LAYERS:
            del self._documents[next(iter(self._documents))]
        self.hidden, self._frame = False, None

    def toggle(self) -> str:
        """Hide the layers, or show them again; return what was done."""
        if not self._documents:
            return "no layers: O opens a .geojson file"
        self.hidden = not self.hidden
        return "layers hidden" if self.hidden else "layers shown"

    @property
    def place(self) -> Place | None:
        """A place of the newest file, around which the map is drawn if nothing else has one."""
        documents = list(self._documents.values())
        return documents[-1].shapes[0].places[0] if documents else None

    def shapes(self, frame: LocalFrame) -> tuple[MapShape, ...]:
        """Return what is drawn."""
        self._convert(frame)
        return () if self.hidden else self._shapes

    def corners(self, frame: LocalFrame) -> tuple[Point, ...]:
        """Return the corners of what a fit brings into view."""
        self._convert(frame)
        return () if self.hidden else self._corners

    @property
    def text(self) -> str:
        """The newest file, and how many others there are; empty without any."""
        names = list(self._documents)
        others = f" and {len(names) - 1} more" if len(names) > 1 else ""
        return f"{names[-1]}{others}" if names else ""

    def _convert(self, frame: LocalFrame) -> None:
        if frame == self._frame:
            return
        found = (shape for document in self._documents.values() for shape in document.shapes)
        self._shapes = tuple(
            MapShape(tuple(map(frame.to_point, shape.places)), shape.closed, shape.name) for shape in found
        )
        near = [point for shape in self._shapes for point in shape.points if math.hypot(*point) <= FAR]
        self._frame, self._corners = frame, _corners(near)


def describe_layer(name: str, document: LayerDocument, frame: LocalFrame | None) -> str:
    """Return what a file has, and how far away it is if that is too far to show it with the vehicle."""
    kinds = [_kind(len(shape.places), shape.closed) for shape in document.shapes]
    counts = ((kinds.count(kind), kind) for kind in ("point", "line", "area"))
    parts = [f"{count} {kind}{'' if count == 1 else 's'}" for count, kind in counts if count]
    drawn = sum(len(shape.places) for shape in document.shapes)
    if document.total > drawn:
        parts.append(f"{drawn} of {document.total} positions drawn")
    if frame is not None and (away := _distance(document, frame)) > FAR:
        point = frame.to_point(document.shapes[0].places[0])
        parts.append(f"{away / 1000:.0f} km away at {bearing((0.0, 0.0), point):03.0f}°, f does not show it")
    return f"{name}: {', '.join(parts)} · l hides the layers"


def _kind(places: int, closed: bool) -> str:
    return "area" if closed else "line" if places > 1 else "point"


def _distance(document: LayerDocument, frame: LocalFrame) -> float:
    return min(math.hypot(*frame.to_point(place)) for shape in document.shapes for place in shape.places)


def _corners(points: Iterable[Point]) -> tuple[Point, ...]:
    found = list(points)
    if not found:
        return ()
    norths, easts = [north for north, _ in found], [east for _, east in found]
    return (min(norths), min(easts)), (max(norths), max(easts))
