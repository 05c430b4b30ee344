"""GPX 1.1 and KML 2.2: tracks of vehicles and their warnings. Elements stand in the order of the formats' schemas.

https://www.topografix.com/GPX/1/1/gpx.xsd, https://schemas.opengis.net/kml/2.2.0/ogckml22.xsd
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from xml.sax.saxutils import escape

import msgspec

from dialects.printable import printable
from groundstation.disk.new_file import NewFile
from groundstation.export.exporter import LogInfo
from groundstation.export.log_time import iso_time
from groundstation.export.sample import Sample
from groundstation.export.track import Position, RecordedTrack, Remark, Tracks

_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
GPX = "http://www.topografix.com/GPX/1/1"
KML = "http://www.opengis.net/kml/2.2"


class MapFormat(msgspec.Struct, frozen=True):
    """A format of tracks."""

    point: Callable[[Position], str]
    """Returns the lines of a point."""
    pause: Callable[[bool], str]
    """Returns the lines between two segments of a track; takes whether it flies."""
    lines: Callable[[Tracks, LogInfo], Iterator[str | RecordedTrack]]
    """Yields the lines of the file, and each track where its points are."""


class MapExport:
    """Writes a track for each vehicle, with a place for each of its warnings."""

    learns = False

    def __init__(self, path: str, log: LogInfo, form: MapFormat) -> None:
        self.target = NewFile(path)
        self._log = log
        self._form = form
        self._tracks = Tracks(form.point, form.pause)

    @property
    def count(self) -> int:
        """Points."""
        return self._tracks.count

    def add(self, sample: Sample) -> None:
        """Handle a position or a warning."""
        self._tracks.add(sample)

    def finish(self) -> None:
        """Write the file."""
        file = self.target.file
        for each in self._form.lines(self._tracks, self._log):
            if isinstance(each, RecordedTrack):
                file.writelines(each.read())
            else:
                file.write(f"{each}\n".encode())

    def discard(self) -> None:
        """Remove what is not in its place."""
        self._tracks.close()
        self.target.discard()


def _gpx_lines(tracks: Tracks, log: LogInfo) -> Iterator[str | RecordedTrack]:
    yield f'{_XML}<gpx version="1.1" creator="mavhelm" xmlns="{GPX}">'
    yield f"<metadata><name>{_text(log.name)}</name><time>{iso_time(log.begin)}</time></metadata>"
    for each in tracks.remarks:
        yield f"<wpt {_gpx_place(each.position)}>{_gpx_details(each.position)}<name>{_text(each.text)}</name></wpt>"
    for system, track in sorted(tracks.of.items()):
        yield f"<trk><name>vehicle {system}</name><trkseg>"
        yield track
        yield "</trkseg></trk>"
    yield "</gpx>"


def _kml_lines(tracks: Tracks, log: LogInfo) -> Iterator[str | RecordedTrack]:
    """Yield a line for each vehicle: on the ground, of what flies at its altitude above mean sea level."""
    yield f'{_XML}<kml xmlns="{KML}"><Document><name>{_text(log.name)}</name>'
    yield '<Style id="track"><LineStyle><color>ff3399ff</color><width>3</width></LineStyle></Style>'
    for system, track in sorted(tracks.of.items()):
        yield from _kml_head(system, track)
        yield track
        yield "</coordinates></LineString></MultiGeometry></Placemark>"
    yield from map(_kml_remark, tracks.remarks)
    yield "</Document></kml>"


def _gpx_point(at: Position) -> str:
    return f"<trkpt {_gpx_place(at)}>{_gpx_details(at)}</trkpt>\n"


def _gpx_place(at: Position) -> str:
    return f'lat="{at.latitude:.7f}" lon="{at.longitude:.7f}"'


def _gpx_details(at: Position) -> str:
    return f"<ele>{at.altitude:.3f}</ele><time>{iso_time(at.microseconds)}</time>"


def _kml_point(at: Position) -> str:
    return f"{_kml_place(at)}\n"


def _kml_place(at: Position) -> str:
    return f"{at.longitude:.7f},{at.latitude:.7f},{at.altitude:.3f}"


def _kml_head(system: int, track: RecordedTrack) -> Iterator[str]:
    assert track.first is not None
    assert track.last is not None
    begin, end = sorted((track.first.microseconds, track.last.microseconds))
    yield f"<Placemark><name>vehicle {system}</name>"
    yield f"<TimeSpan><begin>{iso_time(begin)}</begin><end>{iso_time(end)}</end></TimeSpan>"
    yield "<styleUrl>#track</styleUrl>"
    yield f"<MultiGeometry>{_kml_line(track.flies)}"


def _kml_line(flies: bool) -> str:
    """Return the begin of a line; a wall below it shows where it has flown."""
    look = "<extrude>1</extrude><altitudeMode>absolute</altitudeMode>" if flies else "<tessellate>1</tessellate>"
    return f"<LineString>{look}<coordinates>"


def _kml_remark(each: Remark) -> str:
    at = each.position
    return (
        f"<Placemark><name>{_text(each.text)}</name><description>vehicle {each.system}</description>"
        f"<TimeStamp><when>{iso_time(at.microseconds)}</when></TimeStamp>"
        f"<Point><coordinates>{_kml_place(at)}</coordinates></Point></Placemark>"
    )


def _text(text: str) -> str:
    """Return a text for XML, which has no control characters."""
    return escape(printable(text))


GPX_FORMAT = MapFormat(_gpx_point, lambda flies: "</trkseg>\n<trkseg>\n", _gpx_lines)
KML_FORMAT = MapFormat(_kml_point, lambda flies: f"</coordinates></LineString>\n{_kml_line(flies)}\n", _kml_lines)
