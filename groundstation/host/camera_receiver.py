"""CameraReceiver: has the stream of the camera received that a screen shows, and recorded beside the session's log."""

from __future__ import annotations

from dialects.enums import Severity
from groundstation.recording.station_recording import StationRecording
from groundstation.station.station import Station
from groundstation.stream.orders import StreamOrders
from groundstation.stream.receiver_link import ReceiverLink
from groundstation.stream.sender_lock import choose_senders
from groundstation.views.camera import CameraRequest


class CameraReceiver:
    """Joins a station to the process that receives pictures. `limit`: MB of recorded pictures; 0: none are recorded."""

    def __init__(self, station: Station, recording: StationRecording | None, limit: int) -> None:
        self._station = station
        self._recording = recording if limit else None
        self._link = ReceiverLink(limit)
        self._said = ""

    def tick(self, now: float) -> None:
        """Have what screens show received."""
        self._link.update(self._orders(now), now)
        report = self._link.report
        self._station.feed.camera.receiver_problem = report.problem
        failed = f"pictures are not recorded: {report.failure}" if report.failure else ""
        said = failed or (f"recording pictures to {report.recorded}" if report.recorded else "")
        if said and said != self._said:
            self._said = said
            self._station.log.add(now, "station", said, Severity.WARNING if failed else Severity.INFO)

    def close(self) -> None:
        """Write the rest."""
        self._link.close()

    def _orders(self, now: float) -> StreamOrders:
        stream = self._station.feed.camera.wanted(now)
        if not stream.port:
            return StreamOrders()
        requests = self._station.views.requests(CameraRequest)
        screens = tuple(sorted({each.port for each in requests if each.port}))
        senders = choose_senders(stream.hosts)
        current = self._recording.folder.current if self._recording is not None else None
        if self._recording is None or current is None:
            return StreamOrders(stream.port, screens, stream.stamped, senders=senders)
        return StreamOrders(stream.port, screens, stream.stamped, str(current.path), self._recording.offset, senders)
