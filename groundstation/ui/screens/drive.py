"""The Drive screen: what a driver needs at one glance, and the questions that actions ask. It sends no drive keys."""

from __future__ import annotations

from collections.abc import Callable

from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.screen import Screen
from textual.widgets import Static

from groundstation.input.keymap import CONFIRM_KEY, Keymap
from groundstation.intents import AnyIntent, OperatorAction, StartSimulator
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.ui.alerts import AlertContext, active_alerts
from groundstation.ui.colours import BLUE, GREEN
from groundstation.ui.key_gate import GateClosure
from groundstation.ui.key_parser import KeyRepeat
from groundstation.ui.keynames import format_key
from groundstation.ui.widgets.alert import AlertLine
from groundstation.ui.widgets.chart import Chart, Series
from groundstation.ui.widgets.footer import KeyFooter
from groundstation.ui.widgets.heading_tape import HeadingTape, heading_degrees
from groundstation.ui.widgets.horizon import Horizon, HorizonValue
from groundstation.ui.widgets.keycaps import Keycaps, KeycapsValue
from groundstation.ui.widgets.links import LinksPanel
from groundstation.ui.widgets.log import LogPanel
from groundstation.ui.widgets.rates import RatesPanel
from groundstation.ui.widgets.speed import SpeedReadout, speed_text
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from groundstation.ui.widgets.sticks import StickBars, build_bars
from groundstation.ui.widgets.track import TrackMap, TrackValue
from groundstation.ui.widgets.waiting import WaitingPage

MIN_CONSOLE_SIZE = (80, 24)
"""Columns and rows below which the console would lose something that a driver must see."""

SLOW = 0.5
"""s between pictures of what nobody drives by: charts and tables. Each moves all its lines, and over ssh that costs."""


class DriveScreen(Screen[None]):
    """One picture of one snapshot."""

    CSS_PATH = "drive.tcss"
    AUTO_FOCUS = ""
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (120, "-wide")]  # noqa: RUF012 - Textual declares it so

    def __init__(
        self, keymap: Keymap, send: Callable[[AnyIntent], None], ask_app: Callable[[OperatorAction], None]
    ) -> None:
        super().__init__()
        self._keymap, self._send, self._ask_app = keymap, send, ask_app
        self.snapshot = Snapshot()
        """What is shown."""
        self._slow_at = -SLOW
        self.question: OperatorAction | None = None
        """The action that waits for its second key."""

    def compose(self) -> ComposeResult:
        """Every instrument has its place; drive.tcss says where."""
        simulator = self._keymap.get_keys("app.simulator")
        self._status = StatusBar(StatusBarValue(self.snapshot), id="status")
        self._track, self._tape = TrackMap(TrackValue(), id="track"), HeadingTape(None, id="tape")
        self._speed, self._horizon = SpeedReadout(" -.--", id="speed"), Horizon(None, id="horizon")
        self._sticks, self._keycaps = StickBars((), id="sticks"), Keycaps(self._keymap, id="keycaps")
        self._speeds = Chart("speed", "m/s", (Series("", GREEN),), step=0.5, id="speeds")
        self._battery = Chart("battery", "V", (Series("", BLUE),), step=0.5, id="battery")
        self._rates, self._links, self._log = (
            RatesPanel((), id="rates"),
            LinksPanel((), id="links"),
            LogPanel((), id="log"),
        )
        self._waiting = WaitingPage(format_key(simulator[0]) if simulator else "F5", id="waiting")
        self._alert, self._footer = AlertLine((), id="alert"), KeyFooter(self._keymap, id="footer")
        with Vertical(id="console"):
            yield self._status
            yield self._waiting
            with Horizontal(id="body"):
                yield self._track
                with Vertical(id="instruments"):
                    with Horizontal(id="motion") as motion:
                        motion.border_title = "motion"
                        yield self._speed
                        yield self._horizon
                    yield self._tape
                    with Vertical(id="drive") as drive:
                        drive.border_title = "drive"
                        yield self._sticks
                        yield self._keycaps
                    yield self._speeds
                    yield self._battery
                with Vertical(id="traffic"):
                    yield self._rates
                    yield self._links
            yield self._log
            yield self._alert
            yield self._footer
        yield Static(id="too-small")

    def on_resize(self, event: events.Resize) -> None:
        """A picture with holes would be worse than none."""
        self.set_class(self.too_small, "-too-small")
        width, height = event.size
        self.query_one("#too-small", Static).update(
            f"This terminal has {width} x {height} characters.\n"
            f"The console needs {MIN_CONSOLE_SIZE[0]} x {MIN_CONSOLE_SIZE[1]}.\n\n"
            "Keys do not drive now; stop and emergency stop work."
        )

    @property
    def too_small(self) -> bool:
        """The console does not fit."""
        width, height = self.size
        return width < MIN_CONSOLE_SIZE[0] or height < MIN_CONSOLE_SIZE[1]

    def show_snapshot(
        self,
        snapshot: Snapshot,
        *,
        pressed: frozenset[str],
        shut: GateClosure | None,
        terminal: float | None,
        alive: bool,
    ) -> None:
        """Give every instrument its part of the snapshot; each draws only what changed."""
        self.snapshot = snapshot
        vehicle = snapshot.vehicle
        self.set_class(vehicle is None, "-waiting")
        self._status.show(StatusBarValue(snapshot, terminal))
        self._alert.show(tuple(active_alerts(AlertContext(snapshot, self._keymap, shut, self.question, alive))))
        self._log.show(snapshot.texts)
        if vehicle is None:
            self._waiting.show(snapshot)
            return
        self._track.show(TrackValue.from_vehicle(vehicle))
        self._speed.show(speed_text(vehicle))
        self._horizon.show(HorizonValue.from_vehicle(vehicle))
        self._tape.show(heading_degrees(vehicle))
        self._sticks.show(build_bars(snapshot))
        self.light_keycaps(pressed)
        self._footer.show(vehicle.armed)
        if self.has_class("-wide") and not 0 <= snapshot.uptime - self._slow_at < SLOW:
            self._slow_at = snapshot.uptime
            self._show_slow(snapshot, vehicle)

    def _show_slow(self, snapshot: Snapshot, vehicle: VehicleView) -> None:
        self._speeds.add(snapshot.uptime, vehicle.speed)
        self._battery.add(snapshot.uptime, vehicle.battery_voltage)
        self._rates.show(snapshot.messages)
        self._links.show(snapshot.links)

    def light_keycaps(self, pressed: frozenset[str]) -> None:
        """Light the caps of keys that are down."""
        self._keycaps.show(KeycapsValue.from_operator(self.snapshot.operator, pressed, self._keymap))

    def on_key(self, event: events.Key) -> None:
        """What the screen itself does on keys; what drives and stops went its way in the input thread."""
        if isinstance(event, KeyRepeat):
            return
        action = self._keymap.get_action(event.key)
        if self.question is not None:
            self._answer(event.key)
        elif action is not None:
            self.request_action(action)
        elif event.key == "enter" and self.snapshot.vehicle is None:
            self._send(StartSimulator())

    def request_action(self, action: OperatorAction) -> None:
        """Ask first where the action wants it. Intents without a question have been sent already."""
        vehicle = self.snapshot.vehicle
        if action.when_armed is not None and vehicle is not None and vehicle.armed:
            return
        if action.confirm and vehicle is not None:
            self.question = action
        elif action.intent is None:
            self._ask_app(action)

    def _answer(self, key: str) -> None:
        action, self.question = self.question, None
        if key == CONFIRM_KEY and action is not None and action.intent is not None:
            self._send(action.intent)
