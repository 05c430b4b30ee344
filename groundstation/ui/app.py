"""The app: joins the station's pipe, the keys' gate and the screens, and renews the lease while it lives."""

from __future__ import annotations

import asyncio
import gc
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from textual import events
from textual.app import App
from textual.binding import Binding, BindingType
from textual.driver import Driver

from groundstation.input.keymap import KeyEvent, Keymap
from groundstation.intents import AnyIntent, OperatorAction, RenewLease
from groundstation.snapshot import Snapshot
from groundstation.ui.colours import THEME
from groundstation.ui.exit import exit_on_signals
from groundstation.ui.key_gate import GateClosure, GateLevel, KeyGate, StationConnection
from groundstation.ui.key_parser import KeyRepeat, KeyUp
from groundstation.ui.palette import ActionProvider
from groundstation.ui.screens.drive import DriveScreen
from groundstation.ui.screens.help import HelpScreen
from groundstation.ui.terminal import PING, ConsoleDriver, TerminalClosed
from groundstation.ui.tty_output import TerminalFile, redirect_output
from groundstation.ui.tty_ping import PERIOD

TICK = 0.1
"""s between renewals of the lease: a third of what the station allows."""

LIT = 0.15
"""s for which a cap stays lit after a press; by then a snapshot (10 Hz) has told what is held."""

FASTEST_PICTURE = 0.06
"""s between two pictures at least: what comes faster is skipped, only the newest counts."""


class ConsoleApp(App[int]):
    """One operator at one terminal."""

    COMMANDS: ClassVar[Any] = {ActionProvider}
    BINDINGS: ClassVar[list[BindingType]] = [Binding("ctrl+z", "suspend_process", "Suspend", show=False)]

    def __init__(
        self,
        client: StationConnection,
        keymap: Keymap,
        *,
        terminal: TerminalFile | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.gate = KeyGate(client, keymap, clock)
        driver: type[Driver] | None = None if terminal is None else ConsoleDriver.bind(self.gate, terminal)
        super().__init__(driver_class=driver)
        self._client, self._keys, self._terminal, self._clock = client, keymap, terminal, clock
        self._snapshot = Snapshot()
        self._pressed: dict[str, float] = {}
        self._shown_at = 0.0
        self._leaving = False
        self._own_loop: asyncio.AbstractEventLoop | None = None
        self.drive = DriveScreen(keymap, self._send, self.perform_action)

    # ---- life ----

    def on_mount(self) -> None:
        """The Drive screen first; the garbage collector's long passes never while somebody drives."""
        self.register_theme(THEME)
        self.theme = THEME.name
        self.push_screen(self.drive)
        self._own_loop = asyncio.get_running_loop()
        self._own_loop.add_reader(self._client.fileno(), self._readable)
        # In this loop and in no thread: a screen that hangs must lose its lease.
        self.set_interval(TICK, self._tick)
        self.set_interval(PERIOD, self._ping)
        if self._terminal is not None:
            self.call_after_refresh(_freeze)

    def on_unmount(self) -> None:
        """Neutral before anything else ends."""
        self.gate.close("quitting")
        asyncio.get_running_loop().remove_reader(self._client.fileno())

    def end(self, code: int = 0) -> None:
        """Leave; neutral at once."""
        self.gate.close("quitting")
        self._leaving = True
        self.exit(code)

    def end_threadsafe(self, code: int) -> None:
        """The same from a signal handler: takes no lock."""
        if self._own_loop is None:
            raise SystemExit(code)
        self._own_loop.call_soon_threadsafe(self.end, code)

    def on_terminal_closed(self, event: TerminalClosed) -> None:
        """Nobody can see or type any more: the same as a hang-up."""
        self.end(128 + signal.SIGHUP)

    def push_screen(self, screen: Any, *arguments: Any, **options: Any) -> Any:
        """Another screen on top is neutral at once, before it is even made."""
        if screen is not self.drive:
            self.gate.set_closure(GateClosure("another screen is open", GateLevel.STOPS))
        return super().push_screen(screen, *arguments, **options)

    # ---- the station ----

    def _send(self, intent: AnyIntent) -> None:
        self._client.send(intent)

    def _readable(self) -> None:
        """A snapshot waits. Many may: only the newest is shown, and not faster than an eye can follow."""
        snapshot = self._client.receive()
        if snapshot is not None:
            self._handle_snapshot(snapshot)
        if not self._client.alive:
            asyncio.get_running_loop().remove_reader(self._client.fileno())

    def _handle_snapshot(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        vehicle, helm = snapshot.vehicle, snapshot.operator
        driving = bool(helm.throttle or helm.steering or helm.held)
        self.gate.update(armed=vehicle is not None and vehicle.armed, driving=driving)
        if self._clock() - self._shown_at >= FASTEST_PICTURE:
            self._show_snapshot()

    def _show_snapshot(self) -> None:
        self._shown_at = self._clock()
        if self.drive.is_mounted:
            self.drive.show_snapshot(
                self._snapshot,
                pressed=frozenset(self._pressed),
                shut=self.gate.closure,
                terminal=self.gate.ping.round_trip,
                alive=self._client.alive,
            )

    # ---- the beat ----

    def _tick(self) -> None:
        if not self.screen_stack:
            return  # the app has taken its screens down, and timers live a little longer
        now = self._clock()
        self._client.send(RenewLease())
        self.gate.set_closure(self._gate_closure(now))
        for key in [key for key, until in self._pressed.items() if now >= until]:
            del self._pressed[key]
        if now - self._shown_at >= TICK:
            self._show_snapshot()

    def _ping(self) -> None:
        if isinstance(self._driver, ConsoleDriver) and self.gate.ping.next_due(self._clock()):
            self._driver.write(PING)

    def _gate_closure(self, now: float) -> GateClosure | None:
        """Why keys must not drive now, as far as the screen knows; None when they may."""
        checks: tuple[tuple[bool, GateClosure], ...] = (
            (self._leaving, GateClosure("quitting")),
            (not self._client.alive, GateClosure("the station has ended")),
            (self.screen is not self.drive, GateClosure("another screen is open", GateLevel.STOPS)),
            (self.drive.question is not None, GateClosure("a question is open", GateLevel.STOPS)),
            (not self.app_focus, GateClosure("this window does not have the focus")),
            (self.drive.too_small, GateClosure("the terminal is too small")),
            (self.gate.ping.is_silent(now), GateClosure("the terminal does not answer")),
            (
                self._terminal is not None and self._terminal.is_stuck(time.monotonic()),
                GateClosure("the terminal is stuck"),
            ),
        )
        return next((shut for holds, shut in checks if holds), None)

    # ---- keys ----

    async def on_event(self, event: events.Event) -> None:
        """Before any widget: quit works everywhere, and where no driver of ours took the key, it is taken here."""
        if isinstance(event, events.Key) and not self.screen_stack:
            return  # it was on its way when the app took its screens down, and Textual would fail over it
        if isinstance(event, events.Key) and not event.is_forwarded:
            if not isinstance(self._driver, ConsoleDriver):
                self.gate.handle_keys([KeyEvent(event.key)])
            action = self._keys.get_action(event.key)
            if action is not None and action.id == "app.quit":
                self.end()
                return
            if not isinstance(event, KeyRepeat):  # of a key that counts as held the snapshot tells
                self._light(event.key)
        await super().on_event(event)
        if isinstance(event, (events.Key, events.AppBlur, events.AppFocus)) and self.screen_stack:
            self.gate.set_closure(self._gate_closure(self._clock()))

    def on_key_up(self, event: KeyUp) -> None:
        """Dark again."""
        self._pressed.pop(event.key, None)
        self.drive.light_keycaps(frozenset(self._pressed))

    def _light(self, key: str) -> None:
        self._pressed[key] = self._clock() + LIT
        if self.screen is self.drive:
            self.drive.light_keycaps(frozenset(self._pressed))

    # ---- actions ----

    def perform_action(self, action: OperatorAction) -> None:
        """Do an action by its name: what the app does itself, and what was chosen in the palette."""
        if action.id == "app.quit":
            self.end()
        elif action.id == "app.help" and not any(isinstance(each, HelpScreen) for each in self.screen_stack):
            # Of several keys in one read each asks for it, before the first one's screen takes the rest.
            self.push_screen(HelpScreen(self._keys))

    def choose_action(self, action: OperatorAction) -> None:
        """An action from the palette: no key has sent its intent."""
        vehicle = self._snapshot.vehicle
        if vehicle is not None and vehicle.armed and action.when_armed is not None:
            self._send(action.when_armed)
        elif action.confirm or action.intent is None:
            self.drive.request_action(action)
        else:
            self._send(action.intent)


def run(client: StationConnection, *, keymap: Keymap, log_file: Path | None = None) -> int:
    """Show the screen until its person leaves or is gone. 0 after a quit, 128 + n after signal n, 1 when it broke."""
    with redirect_output(log_file) as terminal:
        app = ConsoleApp(client, keymap, terminal=terminal)
        with exit_on_signals(app.end_threadsafe, terminal):
            # No mouse: each move of it would wake the loop, and people want to select text.
            code = app.run(mouse=False)
    if code is None:
        sys.stderr.write(f"groundstation: the screen failed; {log_file or 'run with --log-file: the log'} tells why\n")
        return 1
    return code


def _freeze() -> None:
    """What is there now stays: the collector need not walk it again (28-61 ms a pass when it did)."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
