"""Drive screen: the instruments. Keys that drive, stop or command take another way, see key_gate.py."""

from __future__ import annotations

from dataclasses import replace

from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.widgets import Static

from groundstation.intents.session import StartSimulator
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.ui.alerts import active_alerts
from groundstation.ui.display_state import DisplayState
from groundstation.ui.instruments import INSTRUMENTS
from groundstation.ui.key_parser import KeyRepeat
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.strip import DrivingStrip, StripValue

CONSOLE_SIZE = (80, 24)
"""Columns and rows below which the console does not fit; the driving strip takes its place."""

MIN_STRIP_SIZE = (40, 10)
"""Columns and rows below which mode, ARMED, the bar of a held key and the first alert would not fit: nothing drives."""

SLOW = 0.5
"""s between updates of charts and tables. Each update changes all their lines, which is expensive over SSH."""


class DriveScreen(ConsoleScreen):
    """The instruments of one display state."""

    CSS_PATH = "drive.tcss"
    ROWS = INSTRUMENTS
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (120, "-wide")]  # noqa: RUF012 - Textual declares it so

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._slow_at = -SLOW
        self._too_small_text = ""
        self._strip = DrivingStrip(StripValue.from_state(self._state), id="strip")

    @property
    def snapshot(self) -> Snapshot:
        """What is shown."""
        return self._state.snapshot

    def compose(self) -> ComposeResult:
        """Lay out the places of INSTRUMENTS; drive.tcss sets their sizes."""
        with Vertical(id="console"):
            yield from self.build_place("top")
            with Horizontal(id="body"):
                yield from self.build_place("left")
                with Vertical(id="instruments"):
                    with Horizontal(id="motion") as motion:
                        motion.border_title = "motion"
                        yield from self.build_place("motion")
                    yield from self.build_place("heading")
                    with Vertical(id="drive") as drive:
                        drive.border_title = "drive"
                        yield from self.build_place("drive")
                    yield from self.build_place("charts")
                with Vertical(id="traffic"):
                    yield from self.build_place("traffic")
            yield from self.build_place("bottom")
        yield self._strip
        yield Static(id="too-small")

    def on_resize(self, event: events.Resize) -> None:
        """Show what fits: the console, the driving strip, or the size that is needed."""
        self.set_class(self.too_small, "-too-small")
        self.set_class(self._small and not self.too_small, "-strip")
        self._show_small()

    @property
    def too_small(self) -> bool:
        """Not even the driving strip fits."""
        return _is_smaller(self.size, MIN_STRIP_SIZE)

    @property
    def _small(self) -> bool:
        return _is_smaller(self.size, CONSOLE_SIZE)

    def _show_small(self) -> None:
        if self.too_small:
            self._show_too_small()
        elif self._small:
            self._strip.show(StripValue.from_state(self._state))

    def _show_too_small(self) -> None:
        width, height = self.size
        text = (
            f"This terminal has {width} x {height} characters.\n"
            f"Driving needs {MIN_STRIP_SIZE[0]} x {MIN_STRIP_SIZE[1]}.\n\n"
            f"{format_arming(self.snapshot.vehicle)}\n\n"
            "Keys neither drive nor arm now;\nstop, disarm and emergency stop work."
        )
        if text != self._too_small_text:
            self._too_small_text = text
            self.query_one("#too-small", Static).update(text)

    def show_body(self, now: DisplayState) -> None:
        """Show what depends on the size, the vehicle and the alerts."""
        self._show_small()
        self.set_class(now.snapshot.vehicle is None, "-waiting")
        self.set_class(bool(active_alerts(now)), "-alert")

    def show_rows(self) -> None:
        """Show the state in the instruments, in slow ones less often."""
        slow = self._is_slow_due(self.snapshot)
        for row in INSTRUMENTS:
            if slow or not row.slow:
                self.show_row(row)

    def _is_slow_due(self, snapshot: Snapshot) -> bool:
        if snapshot.vehicle is None or not self.has_class("-wide") or 0 <= snapshot.uptime - self._slow_at < SLOW:
            return False
        self._slow_at = snapshot.uptime
        return True

    def light_keycaps(self, pressed: frozenset[str]) -> None:
        """Light the caps of keys that are down, without waiting for the next display state."""
        self._state = replace(self._state, pressed=pressed)
        for row in INSTRUMENTS:
            if row.id == "keycaps":
                self.show_row(row)

    def perform_key(self, event: events.Key) -> bool:
        """Handle actions of the app; keys that drive, stop or command were sent by the input thread."""
        if isinstance(event, KeyRepeat):
            return False
        action = self.context.keymap.get_action(event.key)
        if action is not None and action.intent is None:
            self.context.perform(action)
            return True
        if action is None and event.key == "enter" and self.snapshot.vehicle is None:
            self.context.send(StartSimulator())
            return True
        return False


def _is_smaller(size: tuple[int, int], least: tuple[int, int]) -> bool:
    return size[0] < least[0] or size[1] < least[1]


def format_arming(vehicle: VehicleView | None) -> str:
    """Return what a driver must know in any case: name, mode, armed or not, emergency stop, silence."""
    if vehicle is None:
        return "no vehicle yet"
    parts = [vehicle.name, vehicle.mode, "ARMED" if vehicle.armed else "DISARMED"]
    if vehicle.emergency_stop:
        parts.append("EMERGENCY STOP")
    if not vehicle.alive:
        parts.append("no heartbeat")
    return " · ".join(parts)
