"""Connect screen: what can be connected to, and how. Nothing is sent before ENTER."""

from __future__ import annotations

import time
from collections.abc import Iterable

from textual import events
from textual.containers import Horizontal, Vertical
from textual.widget import Widget

from groundstation.actions import ACTIONS
from groundstation.intents.session import StartSimulator
from groundstation.intents.vehicle import SelectVehicle
from groundstation.sitl.simulators import SIMULATORS
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.connect.model import ConnectModel, ConnectPanel
from groundstation.ui.connect.tables import heard_value, logs_value, ports_value, recent_value, simulators_value
from groundstation.ui.connect.welcome import Welcome, WelcomeValue
from groundstation.ui.display.display_state import DisplayState, ScreenKey
from groundstation.ui.display.wrap import plain
from groundstation.ui.files.model import FilesModel
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.row_table import RowTable
from groundstation.views.base import View, ViewRequest
from groundstation.views.connect import ConnectRequest, ConnectView
from link.endpoint import EndpointError, parse_endpoint
from link.runtime.wsl import is_wsl

WIDE = 120
"""Columns from which on the lists stand beside each other, with the logs that are here."""

SIMULATOR_KEYS = {row.key: row.kind for row in SIMULATORS}


class ConnectScreen(ConsoleScreen):
    """A head over four lists; TAB chooses the one that has the arrows."""

    CSS_PATH = "screen.tcss"
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (WIDE, "-wide")]  # noqa: RUF012 - Textual declares it so
    KEYS = (
        ScreenKey("enter", "Connect", "Connect to what is marked; with nothing heard, start a simulated rover"),
        ScreenKey("tab", "Panel", "Next list: heard now, recent, serial ports, simulators"),
        ScreenKey("colon", "Type one", "Type an endpoint"),
        ScreenKey("s", "Simulator", "Start a simulated rover; the other simulators are listed with their keys"),
        ScreenKey("W", "Watch", "Connect to what is marked, or to a typed endpoint, and never send a byte"),
        ScreenKey("p", "Pin", "Keep a recent endpoint on top of the list, or not any more"),
        ScreenKey("x", "Forget", "Forget a recent endpoint"),
        ScreenKey("b", "Baud", "Next baud rate for a serial port"),
        ScreenKey("o", "Replay", "Show the telemetry log that is marked in all screens, until Ctrl-Q"),
        ScreenKey("d", "Find", "Ask the network for vehicles that announce themselves (mDNS), or stop asking"),
    )  # fmt: skip

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(ConnectModel, context.numbers.take, context.folder)
        self.say(self._model.load())
        self._welcome = Welcome(WelcomeValue(), id="welcome")
        self._heard = RowTable(heard_value(None, None), id="heard")
        self._recent = RowTable(recent_value((), (), None), id="recent")
        self._ports = RowTable(ports_value((), (), self._model.baud, None), id="ports")
        self._simulators = RowTable(simulators_value(None, None), id="simulators")
        self._logs = RowTable(logs_value((), None), id="logs")
        self._typed = ""
        self._wsl = is_wsl()
        self._disk = context.keep(FilesModel, context.numbers.take, context.folder).disk

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the head, what is heard, and the other lists below."""
        yield self._welcome
        yield self.build_panel(self._heard, "heard now")
        recent = self.build_panel(self._recent, "recent")
        logs = self.build_panel(self._logs, "logs here, newest first")
        right = Horizontal(
            self.build_panel(self._ports, "serial ports"), self.build_panel(self._simulators, "simulators"), id="right"
        )
        yield Vertical(Vertical(recent, logs, id="before"), right, id="lists")

    def on_mount(self) -> None:
        """Read what is in the logs."""
        self._disk.scan()
        if self._disk.unread:
            self.run_worker(self._read_summaries())

    async def _read_summaries(self) -> None:
        await self._disk.read_summaries()
        self._show()

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the request for what can be connected to."""
        return (ConnectRequest(search=self._model.search),)

    def show_view(self, view: View) -> None:
        """Show what is heard, and leave for Drive once the link is open."""
        if isinstance(view, ConnectView):
            self._model.show_view(view)
            if problem := self._model.give_up():
                self.say(problem)
            self._show()

    def show_body(self, now: DisplayState) -> None:
        """Show the model, and go to Drive when the link is open that was asked for."""
        self._show()
        system = self._model.pop_opened(time.time(), now.snapshot.vehicles)
        if system is not None:
            self._drive(system)

    @property
    def advice(self) -> str:
        """Return what ENTER would do."""
        if self._typed:
            return self._typed
        if self._model.opening:
            return f"opening {self._model.opening}"
        does = self._model.choice.text
        first = f"ENTER {does}" if does else ": types an endpoint"
        return f"{first} · nothing is sent before you choose"

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the list of a widget."""
        if widget not in self._tables:
            return None
        self._model.chosen = ConnectPanel(self._tables.index(widget))
        self._show()
        return LIST_ARROWS

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if isinstance(event, KeyRepeat) and not rows_to_move(event.key, 2):
            return event.key in _ACTIONS or event.key in SIMULATOR_KEYS
        if rows := rows_to_move(event.key, self._tables[self._model.chosen].size.height):
            self._model.move(rows)
        elif event.key in SIMULATOR_KEYS:
            self._simulate(SIMULATOR_KEYS[event.key])
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        self._show()
        return True

    @property
    def marked_text(self) -> str:
        """The endpoint that is marked, or the name of the log."""
        choice = self._model.choice
        return choice.endpoint or choice.file

    def _enter(self, *, watch_only: bool = False) -> None:
        choice = self._model.choice
        if choice.endpoint:
            self._open(choice.endpoint, choice.system, watch_only=watch_only)
        elif watch_only:
            self._type(watch_only=True)
        elif choice.simulator:
            self._simulate(choice.simulator)
        elif choice.file:
            self.context.keep(FilesModel, self.context.numbers.take, self.context.folder).mark_here(choice.file)
            self.context.perform(ACTIONS["app.files"])
        elif choice.text:
            self._drive(choice.system or 0)

    def _watch(self) -> None:
        self._enter(watch_only=True)

    def _open(self, endpoint: str, system: int | None = None, *, watch_only: bool = False) -> None:
        def send() -> None:
            self.context.send(self._model.open(endpoint, system, watch_only=watch_only))

        if self._model.needs_consent(endpoint):
            self.ask(f"open {endpoint}, which everybody in the network can send to", send)
        else:
            send()

    def _simulate(self, kind: str) -> None:
        self.context.send(StartSimulator(kind=kind))
        self._drive(0)

    def _drive(self, system: int) -> None:
        if system and len(self._state.snapshot.vehicles) > 1:
            self.context.send(SelectVehicle(system=system))
        self.context.perform(ACTIONS["app.drive"])

    def _type(self, *, watch_only: bool = False) -> None:
        use = FieldUse(lambda text: self._submit(text, watch_only=watch_only), self._check, cancel=self._forget_typed)
        what = "to watch only, e.g. " if watch_only else "e.g. "
        self.field.open(use, placeholder=f"{what}udpin:0.0.0.0:14550, udpout:HOST:PORT, serial:/dev/ttyUSB0:57600")

    def _type_one(self) -> None:
        self._type()

    def _check(self, text: str) -> None:
        """Say whether the text is an endpoint while it is typed."""
        try:
            self._typed = f"ENTER opens {parse_endpoint(text).text}" if text else "ESC closes the field"
        except EndpointError as error:
            self._typed = str(error)

    def _forget_typed(self) -> None:
        self._typed = ""

    def _submit(self, text: str, *, watch_only: bool) -> None:
        self._typed = ""
        if not text.strip():
            return
        try:
            endpoint = parse_endpoint(text).text
        except EndpointError as error:
            self.say(str(error))
            return
        self._open(endpoint, watch_only=watch_only)

    def _replay(self) -> None:
        name = self._model.choice.file
        self.open_log(self.context.folder / name if name else None)

    def _next_panel(self) -> None:
        self._model.choose_panel(1)

    def _panel_before(self) -> None:
        self._model.choose_panel(-1)

    def _pin(self) -> None:
        self._model.pin()

    def _forget(self) -> None:
        forgotten = self._model.forget()
        self.say(f"{forgotten} forgotten" if forgotten else None)

    def _search(self) -> None:
        self._model.search = not self._model.search

    def _change_baud(self) -> None:
        self._model.change_baud()

    # ---- drawing ----

    @property
    def _tables(self) -> tuple[RowTable, ...]:
        return self._heard, self._recent, self._ports, self._simulators, self._logs

    def _show(self) -> None:
        model, snapshot = self._model, self._state.snapshot
        model.shows_logs = self.room.width >= WIDE
        if model.chosen is ConnectPanel.LOGS and not model.shows_logs:
            model.choose_panel(1)
        known = {each.name: found for each, found in self._disk.summaries.items()}
        self._logs.show(logs_value(model.logs, model.shown_cursor(ConnectPanel.LOGS), known))
        self._logs.border_subtitle = "o replays it · ENTER shows it on the Files screen"
        opened = model.view.endpoints if model.view else ()
        self._heard.show(heard_value(model.view, model.shown_cursor(ConnectPanel.HEARD)))
        self._recent.show(recent_value(model.entries, opened, model.shown_cursor(ConnectPanel.RECENT)))
        port = model.shown_cursor(ConnectPanel.PORTS)
        self._ports.show(ports_value(model.ports, opened, model.baud, port, wsl=self._wsl))
        self._simulators.show(simulators_value(model.shown_cursor(ConnectPanel.SIMULATORS), snapshot.simulator))
        self._heard.border_subtitle = plain("asked nobody, sent nothing yet" if not opened else f"{len(opened)} open")
        self._recent.border_subtitle = "* pinned · p pins · x forgets"
        self._ports.border_subtitle = "live"
        for panel, table in zip(ConnectPanel, self._tables, strict=True):
            table.set_class(panel is model.chosen, "-chosen")
        turn, endpoints = 0 if self._state.still else int(snapshot.uptime * 4), snapshot.endpoints
        self._welcome.show(
            WelcomeValue(
                self._describe_state(), len(model.heard), turn, endpoints, tuple(snapshot.addresses), self._wsl
            )
        )

    def _describe_state(self) -> str:
        """Return what the station does now."""
        if self._state.snapshot.endpoints:
            return f"open: {', '.join(self._state.snapshot.endpoints)}"
        ports = [row.endpoint.removeprefix("udpin:") for row in (self._model.view.listening if self._model.view else ())
                 if not row.problem]  # fmt: skip
        return f"listening on {', '.join(ports)}, sending nothing" if ports else "no link yet"


_ACTIONS = {
    "enter": ConnectScreen._enter,
    "tab": ConnectScreen._next_panel,
    "shift+tab": ConnectScreen._panel_before,
    "colon": ConnectScreen._type_one,
    "W": ConnectScreen._watch,
    "p": ConnectScreen._pin,
    "x": ConnectScreen._forget,
    "b": ConnectScreen._change_baud,
    "d": ConnectScreen._search,
    "o": ConnectScreen._replay,
}
"""Key -> what it does; ConnectScreen.KEYS has their names."""
