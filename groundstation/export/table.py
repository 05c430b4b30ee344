"""The table of formats. To add one, write a class that fits Exporter in a module beside this one, and add its row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import msgspec

from groundstation.export.exporter import Exporter, ExportError, LogInfo
from groundstation.export.map_files import GPX_FORMAT, KML_FORMAT, MapExport
from groundstation.export.text_files import CsvExport, JsonExport, TlogExport
from link.runtime.install_hint import install_command


class Format(msgspec.Struct, frozen=True):
    """A row."""

    create: Callable[[str, LogInfo], Exporter]
    """Takes the path of the file."""
    help: str
    counts: str = "messages"
    keeps_unknown: bool = False
    """Messages that are in no dialect known here are written, too."""


def _create_mcap(path: str, log: LogInfo) -> Exporter:
    try:
        from groundstation.export.mcap_file import McapExport
    except ModuleNotFoundError as error:
        text = f"MCAP needs the package {error.name}, which is not installed: {install_command('bags')}"
        raise ExportError(text) from None
    return McapExport(path, log)


_create_gpx = partial(MapExport, form=GPX_FORMAT)
_create_kml = partial(MapExport, form=KML_FORMAT)

FORMATS: Mapping[str, Format] = {
    "mcap": Format(_create_mcap, "all messages for Foxglove and ROS 2, and ROS topics such as /fix and /odom"),
    "csv": Format(CsvExport, "a folder with a table of each message; a name in .csv is the table of one message"),
    "gpx": Format(partial(MapExport, form=GPX_FORMAT), "the track, with warnings as waypoints", counts="points"),
    "kml": Format(
        partial(MapExport, form=KML_FORMAT), "the track, with warnings as places, for Google Earth", counts="points"
    ),
    "jsonl": Format(JsonExport, "one JSON object a line for each message"),
    "tlog": Format(TlogExport, "that part as a log again", keeps_unknown=True),
}
"""Option of `mavhelm export` -> its format."""
