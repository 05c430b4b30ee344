"""Drive screen: the instruments. Keys that drive, stop or command take another way, see key_gate.py."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.widgets import Static

from groundstation.intents import StartSimulator
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.ui.display_state import DisplayState
from groundstation.ui.instruments import INSTRUMENTS, InstrumentRow
from groundstation.ui.key_parser import KeyRepeat
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.instrument import Instrument

MIN_CONSOLE_SIZE = (80, 24)
"""Columns and rows below which something that a driver must see would not fit."""

SLOW = 0.5
"""s between updates of charts and tables. Each update changes all their lines, which is expensive over SSH."""


class DriveScreen(ConsoleScreen):
    """The instruments of one display state."""

    CSS_PATH = "drive.tcss"
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (120, "-wide")]  # noqa: RUF012 - Textual declares it so

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._state = DisplayState(Snapshot(), context.keymap)
        self._instruments: dict[str, Instrument[Any]] = {}
        self._slow_at = -SLOW
        self._too_small_text = ""

    @property
    def snapshot(self) -> Snapshot:
        """What is shown."""
        return self._state.snapshot

    def compose(self) -> ComposeResult:
        """Lay out the places of INSTRUMENTS; drive.tcss sets their sizes."""
        with Vertical(id="console"):
            yield from self._build("top")
            with Horizontal(id="body"):
                yield from self._build("left")
                with Vertical(id="instruments"):
                    with Horizontal(id="motion") as motion:
                        motion.border_title = "motion"
                        yield from self._build("motion")
                    yield from self._build("heading")
                    with Vertical(id="drive") as drive:
                        drive.border_title = "drive"
                        yield from self._build("drive")
                    yield from self._build("charts")
                with Vertical(id="traffic"):
                    yield from self._build("traffic")
            yield from self._build("bottom")
        yield Static(id="too-small")

    def _build(self, place: str) -> Iterator[Instrument[Any]]:
        for row in INSTRUMENTS:
            if row.place == place:
                self._instruments[row.id] = row.build(row.value(self._state), id=row.id)
                yield self._instruments[row.id]

    def on_resize(self, event: events.Resize) -> None:
        """Show the size that is needed instead of an incomplete console."""
        self.set_class(self.too_small, "-too-small")
        self._show_too_small()

    @property
    def too_small(self) -> bool:
        """The console does not fit."""
        width, height = self.size
        return width < MIN_CONSOLE_SIZE[0] or height < MIN_CONSOLE_SIZE[1]

    def _show_too_small(self) -> None:
        width, height = self.size
        text = (
            f"This terminal has {width} x {height} characters.\n"
            f"The console needs {MIN_CONSOLE_SIZE[0]} x {MIN_CONSOLE_SIZE[1]}.\n\n"
            f"{format_arming(self.snapshot.vehicle)}\n\n"
            "Keys neither drive nor arm now;\nstop, disarm and emergency stop work."
        )
        if text != self._too_small_text:
            self._too_small_text = text
            self.query_one("#too-small", Static).update(text)

    def show_state(self, now: DisplayState) -> None:
        """Give every instrument its value; each redraws only the lines that changed."""
        self._state = now
        if self.too_small:
            self._show_too_small()
        self.set_class(now.snapshot.vehicle is None, "-waiting")
        slow = self._is_slow_due(now.snapshot)
        for row in INSTRUMENTS:
            if slow or not row.slow:
                self._show(row)

    def _is_slow_due(self, snapshot: Snapshot) -> bool:
        if snapshot.vehicle is None or not self.has_class("-wide") or 0 <= snapshot.uptime - self._slow_at < SLOW:
            return False
        self._slow_at = snapshot.uptime
        return True

    def _show(self, row: InstrumentRow) -> None:
        self._instruments[row.id].show(row.value(self._state))

    def light_keycaps(self, pressed: frozenset[str]) -> None:
        """Light the caps of keys that are down, without waiting for the next display state."""
        self._state = replace(self._state, pressed=pressed)
        for row in INSTRUMENTS:
            if row.id == "keycaps":
                self._show(row)

    def on_key(self, event: events.Key) -> None:
        """Handle actions of the app; keys that drive, stop or command were sent by the input thread."""
        if isinstance(event, KeyRepeat):
            return
        action = self.context.keymap.get_action(event.key)
        if action is not None and action.intent is None:
            self.context.perform(action)
        elif action is None and event.key == "enter" and self.snapshot.vehicle is None:
            self.context.send(StartSimulator())


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
