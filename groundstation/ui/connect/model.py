"""ConnectModel: what the Connect screen lists, where its cursors are, and what ENTER would open. No widgets."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from pathlib import Path

import msgspec

from groundstation.intents.links import AddLink
from groundstation.recent.recent import RecentEndpoint, RecentEndpoints
from groundstation.recent.recent_file import RecentFile
from groundstation.sitl.simulators import SIMULATORS
from groundstation.ui.base.local_files import LocalFile, list_logs
from groundstation.views.connect import ConnectView, HeardRow, LinkAttempt, PortRow
from link.endpoint import ANY_ADDRESSES, LISTENING, EndpointError, parse_endpoint

BAUDS = (57600, 115200, 921600, 38400, 9600)
"""Baud rates to choose from: radios, USB ports of autopilots, companion computers, old radios, GPS-like devices."""


class ConnectPanel(IntEnum):
    """Panels, in the order of TAB."""

    HEARD = 0
    RECENT = 1
    PORTS = 2
    SIMULATORS = 3
    LOGS = 4
    """Only where there is room for it."""


class Choice(msgspec.Struct, frozen=True):
    """What ENTER would do."""

    text: str
    """For the hint line, e.g. "connects to Rover 1"."""
    endpoint: str = ""
    """To open; "" if it is open, or there is none."""
    system: int | None = None
    """Vehicle to select."""
    simulator: str = ""
    """Kind of simulator to start."""
    file: str = ""
    """To show on the Files screen."""


class ConnectModel:
    """Lives as long as the app. `take_number` returns numbers for requests."""

    def __init__(self, take_number: Callable[[], int], folder: Path, file: RecentFile | None = None) -> None:
        self._folder = folder
        self.logs: tuple[LocalFile, ...] = ()
        self.shows_logs = False
        """There is room for the panel of the logs."""
        self._take_number = take_number
        self._file = file or RecentFile()
        self.recent = RecentEndpoints()
        self.view: ConnectView | None = None
        self.chosen = ConnectPanel.HEARD
        self.baud = BAUDS[0]
        self.search = False
        """Also ask the network for vehicles that announce themselves."""
        self._cursors = dict.fromkeys(ConnectPanel, 0)
        self._awaited: AddLink | None = None
        self._wanted_system: int | None = None
        self._wanted_name = ""
        self._accepted: set[str] = set()
        """Endpoints that listen to the whole network and were agreed to."""
        self._named: set[tuple[str, str]] = set()

    # ---- lists ----

    def load(self) -> str | None:
        """Read the endpoints used before, and which logs are here; return what is wrong with the file."""
        self.logs = list_logs(self._folder)
        self.recent = self._file.load()
        return self._file.warning

    def show_view(self, view: ConnectView) -> None:
        """Show a view; the cursor stays on its row as far as that is there."""
        self.view = view
        for row in view.heard:
            if row.open and (row.endpoint, row.name) not in self._named:
                self._named.add((row.endpoint, row.name))
                self._name(row)

    @property
    def heard(self) -> tuple[HeardRow, ...]:
        """Vehicles that are heard."""
        return self.view.heard if self.view else ()

    @property
    def ports(self) -> tuple[PortRow, ...]:
        """Serial ports."""
        return self.view.ports if self.view else ()

    @property
    def entries(self) -> tuple[RecentEndpoint, ...]:
        """Endpoints used before, pinned ones first."""
        return self.recent.listed

    def count(self, panel: ConnectPanel) -> int:
        """Return how many rows a panel has."""
        return (len(self.heard), len(self.entries), len(self.ports), len(SIMULATORS), len(self.logs))[panel]

    def cursor(self, panel: ConnectPanel) -> int:
        """Return the row of the cursor in a panel."""
        return max(0, min(self._cursors[panel], self.count(panel) - 1))

    def shown_cursor(self, panel: ConnectPanel) -> int | None:
        """Return the row to mark: in the chosen panel only, and where there is a row."""
        return self.cursor(panel) if panel is self.chosen and self.count(panel) else None

    def move(self, rows: int) -> None:
        """Move the cursor of the chosen panel."""
        self._cursors[self.chosen] = max(0, min(self.cursor(self.chosen) + rows, self.count(self.chosen) - 1))

    def choose_panel(self, step: int) -> None:
        """Choose the next panel, or the one before."""
        panels = [panel for panel in ConnectPanel if panel is not ConnectPanel.LOGS or self.shows_logs]
        at = panels.index(self.chosen) if self.chosen in panels else 0
        self.chosen = panels[(at + step) % len(panels)]

    def change_baud(self) -> None:
        """Choose the next baud rate."""
        self.baud = BAUDS[(BAUDS.index(self.baud) + 1) % len(BAUDS)]

    def _name(self, row: HeardRow) -> None:
        """Remember which vehicle an endpoint led to."""
        known = self.recent.find(row.endpoint)
        if known is not None and known.vehicle != row.name:
            used = known.used
            self._change(lambda recent: recent.add(row.endpoint, used, row.name))

    # ---- what ENTER does ----

    @property
    def choice(self) -> Choice:
        """What ENTER would do now."""
        if not self.count(self.chosen):
            if self.chosen is ConnectPanel.HEARD:
                return Choice("starts a simulated rover", simulator=SIMULATORS[0].kind)
            return Choice("")
        at = self.cursor(self.chosen)
        choices = (
            self._heard_choice,
            self._recent_choice,
            self._port_choice,
            self._simulator_choice,
            self._log_choice,
        )
        return choices[self.chosen](at)

    def _heard_choice(self, at: int) -> Choice:
        row = self.heard[at]
        if row.open:
            return Choice(f"drives {row.system} {row.name}", system=row.system)
        name = f"{row.system} {row.name}" if row.system else row.name
        return Choice(f"connects to {name}", row.endpoint, row.system or None)

    def _recent_choice(self, at: int) -> Choice:
        return self._opening(self.entries[at].endpoint)

    def _port_choice(self, at: int) -> Choice:
        return self._opening(f"serial:{self.ports[at].path}:{self.baud}")

    def _simulator_choice(self, at: int) -> Choice:
        row = SIMULATORS[at]
        return Choice(f"starts a simulator: {row.label}", simulator=row.kind)

    def _log_choice(self, at: int) -> Choice:
        name = self.logs[at].name
        return Choice(f"shows {name} on the Files screen", file=name)

    def _opening(self, endpoint: str) -> Choice:
        if self.view is not None and endpoint in self.view.endpoints:
            return Choice(f"drives: {endpoint} is open")
        return Choice(f"opens {endpoint}", endpoint)

    # ---- opening ----

    def needs_consent(self, endpoint: str) -> bool:
        """Return whether to ask first: it listens to the whole network, and that was not agreed to before."""
        try:
            end = parse_endpoint(endpoint)
        except EndpointError:
            return False
        everybody = end.scheme in LISTENING and end.host in ANY_ADDRESSES
        return everybody and end.text not in self._accepted and self.recent.find(end.text) is None

    def open(self, endpoint: str, system: int | None = None, *, watch_only: bool = False) -> AddLink:
        """Return the intent to open an endpoint. `system` is selected once it is heard there."""
        self._accepted.add(endpoint)
        self._wanted_system = system
        heard = (row.name for row in self.heard if (row.endpoint, row.system) == (endpoint, system))
        self._wanted_name = next(heard, "")
        self._awaited = AddLink(request=self._take_number(), endpoint=endpoint, watch_only=watch_only)
        return self._awaited

    @property
    def awaited(self) -> LinkAttempt | None:
        """How the newest attempt stands; None without one, or before the station has reported it."""
        if self._awaited is None or self.view is None:
            return None
        number = self._awaited.request
        return next((each for each in self.view.attempts if each.request == number), None)

    @property
    def opening(self) -> str:
        """Endpoint that is being opened; "" if none is."""
        attempt = self.awaited
        busy = self._awaited is not None and (attempt is None or attempt.state == "opening")
        return self._awaited.endpoint if busy and self._awaited is not None else ""

    def pop_opened(self, now: float, vehicles: tuple[int, ...]) -> int | None:
        """Return, once, that the awaited link is open: the vehicle to select, 0 for any; None while it is not.

        A vehicle that was heard before is awaited, too. `now` is in s since 1970.
        """
        attempt = self.awaited
        if attempt is None or attempt.state != "open" or self._wanted_system not in (None, *vehicles):
            return None
        self._awaited = None
        name = self._wanted_name
        self._change(lambda recent: recent.add(attempt.endpoint, now, name))
        return self._wanted_system or 0

    def give_up(self) -> str:
        """Return, once, why the awaited link cannot be opened; "" else. The station goes on trying where it can."""
        attempt = self.awaited
        if attempt is None or attempt.state not in ("refused", "failed"):
            return ""
        self._awaited = None
        return attempt.problem.removeprefix(f"{attempt.endpoint}: ")

    # ---- endpoints used before ----

    def pin(self) -> None:
        """Pin the endpoint under the cursor, or unpin it."""
        if self.chosen is ConnectPanel.RECENT and self.entries:
            entry = self.entries[self.cursor(ConnectPanel.RECENT)]
            self._change(lambda recent: recent.pin(entry.endpoint, not entry.pinned))
            self._cursors[ConnectPanel.RECENT] = [each.endpoint for each in self.entries].index(entry.endpoint)

    def forget(self) -> str:
        """Forget the endpoint under the cursor; return it, "" without one."""
        if self.chosen is not ConnectPanel.RECENT or not self.entries:
            return ""
        entry = self.entries[self.cursor(ConnectPanel.RECENT)]
        self._change(lambda recent: recent.forget(entry.endpoint))
        return entry.endpoint

    def _change(self, change: Callable[[RecentEndpoints], RecentEndpoints]) -> None:
        self.recent = self._file.update(change)
