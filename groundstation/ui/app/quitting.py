"""Quitting: the gate closes, what would be left armed is disarmed, and the app ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from textual.app import App

from groundstation.intents.session import QUITTING, Quit
from groundstation.ui.keys.key_gate import GateClosure, GateLevel, KeyGate, StationConnection
from groundstation.ui.replay.log_child import LogChild

QUIT_TIMEOUT = 6.0
"""s for a station that disarms before its exit (it needs 2 to 4); then the screen leaves in any case."""

DISARMING = GateClosure(f"{QUITTING}, disarming in 2 s; Ctrl-Q again leaves it ARMED", GateLevel.STOPS)


class Quitting:
    """Ends an app. `left_armed` returns whether a vehicle would be left armed."""

    def __init__(
        self,
        app: App[int],
        client: StationConnection,
        gate: KeyGate,
        log_child: LogChild,
        left_armed: Callable[[], Any],
    ) -> None:
        self._app, self._client, self._gate, self._log_child = app, client, gate, log_child
        self._left_armed = left_armed
        self.closure: GateClosure | None = None
        """Why keys do not drive any more; None while nobody has quit."""

    def request(self) -> None:
        """Quit. What would be left armed is disarmed before; a second request quits at once and leaves it armed."""
        if self.closure is not None or not self._left_armed() or not self._client.alive:
            self.end()
            return
        self._close(DISARMING)
        self._client.send(Quit(disarm=True))
        self._app.set_timer(QUIT_TIMEOUT, self.end)

    def end(self, code: int = 0) -> None:
        """Close the gate, which means neutral, and leave."""
        self._close(GateClosure(QUITTING))
        self._log_child.end(lambda: self._app.exit(code))

    def handle_station_ended(self) -> None:
        """Leave if the station was to end: it has disarmed."""
        if self.closure is DISARMING:
            self.end()

    def _close(self, closure: GateClosure) -> None:
        self.closure = closure
        self._gate.set_closure(closure)
