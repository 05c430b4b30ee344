"""StationRecording: joins a station and its links to the recorder of the session."""

from __future__ import annotations

import asyncio
import logging

from dialects.codec import encode_payload
from dialects.enums import Severity
from dialects.enums import StationEventKind as Kind
from dialects.messages import RoverStationEvent
from groundstation.recording.log_folder import LogFolder
from groundstation.recording.session_recorder import SessionRecorder
from groundstation.station.station import Station
from link.protocol.log_tap import LogTap
from link.protocol.sent_frames import SentFrames

log = logging.getLogger(__name__)


class StationRecording:
    """What the links bring and take goes to `log_tap`. `ids` are our system and component id."""

    def __init__(self, station: Station, folder: LogFolder, ids: tuple[int, int], sent: SentFrames) -> None:
        self.folder = folder
        self._station = station
        self._session = SessionRecorder(folder)
        self.log_tap = LogTap(
            self._session.recorder.add, system=ids[0], component=ids[1], unsent=False, sent=sent
        )  # fmt: skip
        station.notes.sink = self._add_note

    def tick(self, now: float) -> None:
        """Write what has come since the last call, ten times a second; tell the operator what is new."""
        for news in self._session.tick(now, vehicle=bool(self._station.fleet.system_ids)):
            log.log(logging.WARNING if news.severity <= Severity.WARNING else logging.INFO, news.text)
            self._station.log.add(now, "station", news.text, news.severity)
        self._station.station_info.recording = self._session.view(now)

    @property
    def offset(self) -> int:
        """The us to add to the monotonic clock for the times in the log."""
        return self._session.recorder.since

    def close(self) -> None:
        """Write the rest; a log without this note was ended by a kill."""
        self._station.notes.add(asyncio.get_running_loop().time(), Kind.MARK, "recording ends")
        self._station.notes.sink = None
        self._session.close()

    def _add_note(self, now: float, note: RoverStationEvent) -> None:
        self.log_tap.record_sent(type(note).id, encode_payload(note), now)
