"""RuntimeLinks: opens and closes links while the station runs, without a pause for the links that are open.

Opening may take seconds (a host name is looked up, a port is configured), so a thread does it.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging

import msgspec

from dialects.enums import Severity
from groundstation.intents.links import AddLink
from groundstation.station.station import Station
from groundstation.station_socket.about import ATTACH, explain_taken
from groundstation.vehicles.state.places import PLACES
from groundstation.views.connect import LinkAttempt
from link.core import LinkReport
from link.endpoint import EndpointError, Side, parse_endpoint, parse_endpoints
from link.links import build_link
from link.protocol.sent_frames import SentFrames
from link.runner import Runner
from link.runtime.worker import Worker
from link.transport.backoff import Backoff
from link.transport.transport import LinkError, Transport
from link.transport.transports import open_transports

log = logging.getLogger(__name__)

KEPT_ATTEMPTS = 8
"""Attempts that the screen can still read."""

FIRST_RETRY, LONGEST_RETRY = 1.0, 10.0
"""s between attempts to open a link: a port that another program frees is found while the user waits."""

SILENT = "it sends nothing before it is sent to, so nothing can be heard: watch with udpin or a serial port"


class _Attempt(msgspec.Struct):
    """One AddLink."""

    request: int
    endpoint: str
    index: int
    """Of the link; below 0 until it is open."""
    watch_only: bool = False
    state: str = "opening"
    problem: str = ""
    due: float | None = None
    """When it is tried again."""
    closed: bool = False
    backoff: Backoff = msgspec.field(default_factory=lambda: Backoff(FIRST_RETRY, LONGEST_RETRY))


class RuntimeLinks:
    """The links of a runner, as the operator wants them. `ids` are our system and component id."""

    def __init__(self, runner: Runner, station: Station, ids: tuple[int, int], sent: SentFrames) -> None:
        self._runner = runner
        self._station = station
        self._ids = ids
        self._sent = sent
        self._attempts: list[_Attempt] = []
        self._closing: set[int] = set()
        self._next_index = len(runner.links)
        self._not_open = 0

    # ---- what the operator wants ----

    def add(self, intent: AddLink, now: float) -> None:
        """Open a link; what cannot work at all is refused, anything else is tried again until it is closed."""
        self._not_open -= 1
        attempt = _Attempt(intent.request, intent.endpoint, self._not_open, intent.watch_only)
        self._attempts = [*self._attempts, attempt][-KEPT_ATTEMPTS:]
        try:
            attempt.endpoint = parse_endpoint(intent.endpoint).text
            parse_endpoints([*self._texts(without=attempt), attempt.endpoint])
        except EndpointError as error:
            self._refuse(attempt, str(error))
            return
        if intent.watch_only and attempt.endpoint.startswith("udpout:"):
            self._refuse(attempt, f"{attempt.endpoint}: {SILENT}")
            return
        self._try(attempt)
        self._tell()

    def close(self, index: int, now: float) -> None:
        """Close a link once the station has sent neutral to the vehicles behind it; see link_closing.py."""
        waiting = next((each for each in self._attempts if each.index == index), None)
        if index < 0 and waiting is not None:
            waiting.closed = True
            self._attempts.remove(waiting)
            self._tell()
        elif any(link.channel.index == index for link in self._runner.links):
            self._closing.add(index)

    def open_now(self, endpoint: str) -> None:
        """Open a link that needs no name lookup. Raises LinkError."""
        self._open(open_transports([endpoint], Side.GROUND_STATION)[0], watch_only=False)

    # ---- time ----

    def tick(self, now: float) -> None:
        """Try again what is due, and close what may be closed."""
        for attempt in self._attempts:
            if attempt.due is not None and now >= attempt.due:
                self._try(attempt)
        for index in [each for each in self._closing if self._station.link_closing.is_ready(each, now)]:
            self._closing.remove(index)
            self._close(index, now)
        self._tell()

    def attempts(self, now: float) -> tuple[LinkAttempt, ...]:
        """Return how the newest attempts stand."""
        return tuple(
            LinkAttempt(each.request, each.endpoint, each.state, each.problem, _wait(each, now))
            for each in self._attempts
        )

    # ---- parts ----

    def _refuse(self, attempt: _Attempt, problem: str) -> None:
        attempt.state, attempt.problem, attempt.closed = "refused", problem, True

    def _try(self, attempt: _Attempt) -> None:
        attempt.due = None
        loop = asyncio.get_running_loop()

        def open_it() -> None:
            result: Transport | str
            try:
                result = open_transports([attempt.endpoint], Side.GROUND_STATION)[0]
            except (LinkError, EndpointError) as error:
                result = explain_taken(str(error), ATTACH)
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._opened, attempt, result)

        worker = Worker(f"open {attempt.endpoint}", 1)
        worker.submit(open_it)
        worker.close(patience=0.0)

    def _opened(self, attempt: _Attempt, result: Transport | str) -> None:
        """Handle the result of the thread."""
        now = asyncio.get_running_loop().time()
        if isinstance(result, str):
            attempt.problem = result.removeprefix(f"{attempt.endpoint}: ")
            attempt.due, attempt.state = now + attempt.backoff.next_delay(), "failed"
        elif attempt.closed:
            result.close()
        else:
            attempt.index = self._open(result, watch_only=attempt.watch_only)
            attempt.state, attempt.problem = "open", ""
            note = " (watch only: nothing is sent)" if attempt.watch_only else ""
            self._station.log.add(now, "station", f"{attempt.endpoint} opened{note}", Severity.NOTICE)
        self._tell()

    def _open(self, transport: Transport, *, watch_only: bool) -> int:
        index, self._next_index = self._next_index, self._next_index + 1
        system, component = self._ids
        self._runner.add(
            build_link(
                transport,
                index,
                system=system,
                component=component,
                sent=self._sent,
                watch_only=watch_only,
                places=PLACES,
                downloads=True,
            )
        )
        return index

    def _close(self, index: int, now: float) -> None:
        name = next((link.channel.name for link in self._runner.links if link.channel.index == index), "")
        self._runner.remove(index)
        self._station.link_closing.end(index, now)
        self._attempts = [each for each in self._attempts if each.index != index]
        self._station.log.add(now, "station", f"{name} closed", Severity.NOTICE)

    def _waiting(self) -> list[_Attempt]:
        return [each for each in self._attempts if each.index < 0 and not each.closed]

    def _texts(self, without: _Attempt | None = None) -> list[str]:
        waiting = (each.endpoint for each in self._waiting() if each is not without)
        return [*(link.channel.name for link in self._runner.links), *waiting]

    def _tell(self) -> None:
        """Tell the station which links there are."""
        now = asyncio.get_running_loop().time()
        reports = [
            LinkReport(each.endpoint, each.index, down=each.problem or "connecting", retry_in=_wait(each, now))
            for each in self._waiting()
        ]
        self._station.station_info.set_links(self._texts(), reports)


def _wait(attempt: _Attempt, now: float) -> float | None:
    return None if attempt.due is None else max(0.0, round(attempt.due - now))
