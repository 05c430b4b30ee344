"""A cockpit with requests, whose disk jobs run at once, on real files."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.disk.file_jobs import run_job
from groundstation.intents.services import ServiceIntent
from groundstation.views.base import View, ViewRequest
from groundstation.views.requests import RequestLine, RequestsRequest
from tests.fakes.served import FileVehicle
from tests.groundstation.cockpits import Cockpit


class FileCockpit:
    """A cockpit, its requests and its disk."""

    def __init__(self, vehicle: FileVehicle | None = None, *, loss: float = 0.0) -> None:
        self.vehicle = vehicle or FileVehicle()
        self.cockpit = Cockpit(self.vehicle, loss=loss)
        self.disk = True
        self.run(1.5)

    def run(self, seconds: float) -> None:
        """Advance the time; the disk answers every 0.1 s."""
        for _ in range(max(1, round(seconds / 0.1))):
            self.cockpit.run(0.1)
            services = self.cockpit.station.services
            for job in services.pop_disk_jobs() if self.disk else ():
                services.handle_disk(run_job(job), self.cockpit.now)

    def until(self, condition: Callable[[], object], within: float = 60.0) -> None:
        """Advance the time until it is true."""
        end = self.cockpit.now + within
        while not condition():
            assert self.cockpit.now < end, f"not within {within} s"
            self.run(0.1)

    def view(self, request: ViewRequest) -> View:
        """Return a view."""
        station, now = self.cockpit.station, self.cockpit.now
        views: list[View] = []

        def take(view: View) -> bool:
            views.append(view)
            return True

        station.views.watch((request,))
        station.views.send_due(take, now + 10.0, now)
        station.views.watch(())
        return views[-1]

    def line(self, number: int) -> RequestLine | None:
        """Return how a request stands."""
        view = self.view(RequestsRequest())
        lines = [*getattr(view, "running", ()), *getattr(view, "ended", ())]
        return next((line for line in lines if line.number == number), None)

    def end_of(self, intent: ServiceIntent, within: float = 60.0) -> RequestLine:
        """Make a request and return how it ended."""
        self.cockpit.do(intent)
        return self.ended(intent.request, within)

    def ended(self, number: int, within: float = 60.0) -> RequestLine:
        """Wait until a request has ended."""

        def line() -> RequestLine | None:
            found = self.line(number)
            return found if found is not None and found.state != "running" else None

        self.until(line, within)
        found = line()
        assert found is not None
        return found
