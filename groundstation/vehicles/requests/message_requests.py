"""Requests for messages: SET_MESSAGE_INTERVAL and REQUEST_MESSAGE to the autopilot of a vehicle."""

from __future__ import annotations

from dialects.enums import Command
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.requests import RequestBook

DEFAULT_INTERVAL, NO_INTERVAL = 0.0, -1.0
"""Values of param2 of SET_MESSAGE_INTERVAL (common.xml)."""

HIGHEST_RATE = 1000.0
"""Hz; more than any vehicle sends."""


class MessageRequests:
    """Requests for messages by their id; `name` is for the operator."""

    def __init__(self, commands: CommandRequests, book: RequestBook) -> None:
        self._commands = commands
        self._book = book

    def set_rate(self, number: int, component: int, message: int, name: str, rate: float, now: float) -> None:
        """Request a message at `rate` Hz; 0: at its default rate, below 0: not at all."""
        what = f"send {name} {'at its default rate' if rate == 0 else 'no more' if rate < 0 else f'at {rate:g} Hz'}"
        if rate > HIGHEST_RATE or rate != rate:
            self._refuse(number, what, f"rates are up to {HIGHEST_RATE:g} Hz", now)
        elif self._is_ours(number, component, what, now):
            interval = 1e6 / rate if rate > 0 else DEFAULT_INTERVAL if rate == 0 else NO_INTERVAL
            self._commands.send(number, Command.SET_MESSAGE_INTERVAL, (message, interval), what, now)

    def request_once(self, number: int, component: int, message: int, name: str, now: float) -> None:
        """Request a message once."""
        what = f"send {name} once"
        if self._is_ours(number, component, what, now):
            self._commands.send(number, Command.REQUEST_MESSAGE, (message,), what, now)

    def _is_ours(self, number: int, component: int, what: str, now: float) -> bool:
        """Return whether the component is the one that our commands go to; refuse the request if not."""
        if component == self._commands.target[1]:
            return True
        self._refuse(number, what, f"only the autopilot (component {self._commands.target[1]}) is asked", now)
        return False

    def _refuse(self, number: int, what: str, why: str, now: float) -> None:
        if self._book.begin(number, what):
            self._book.refuse(number, why, now, by_vehicle=False)
