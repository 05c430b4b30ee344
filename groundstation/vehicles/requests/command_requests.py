"""Commands to one vehicle as requests: with progress, and the vehicle's own words where it refuses."""

from __future__ import annotations

from typing import NamedTuple

from dialects import messages as m
from dialects.enums import Command, Result, command_name, result_token
from groundstation.vehicles.requests.requests import RequestBook
from link.core import Received
from link.services.command.client import TRIES, CommandClient, CommandOutcome, CommandPlace


class _Held(NamedTuple):
    """A request that waits for the end of a query."""

    number: int
    params: tuple[float, ...]
    place: CommandPlace | None


class CommandRequests:
    """COMMAND_LONG and COMMAND_INT requests to the component `target` (system, component).

    COMMAND_ACK does not tell two commands of one kind apart, so a request waits for the end of a query, and is refused
    while another request of its kind is under way.
    """

    def __init__(self, client: CommandClient, book: RequestBook, target: tuple[int, int]) -> None:
        self._client = client
        self._book = book
        self.target = target
        self._numbers: dict[int, int] = {}
        """Command -> the request under way."""
        self._held: dict[int, _Held] = {}
        """Command -> the request that is sent after the query under way."""
        self._queries: list[CommandOutcome] = []

    def send(
        self,
        number: int,
        command: Command | int,
        params: tuple[float, ...],
        what: str,
        now: float,
        place: CommandPlace | None = None,
    ) -> None:
        """Send a command with up to 7 parameters; `what` names it for the operator. With a `place` a COMMAND_INT."""
        if not self._book.begin(number, what):
            return
        if int(command) in self._numbers or int(command) in self._held:
            text = f"{command_name(int(command))} is being requested already"
            self._book.refuse(number, text, now, by_vehicle=False)
        elif self.is_waiting(command):
            self._held[int(command)] = _Held(number, params, place)
        else:
            self._numbers[int(command)] = number
            self._transmit(int(command), params, now, place)

    def send_named(self, number: int, name: str, params: tuple[float, ...], what: str, now: float) -> None:
        """Send the MAV_CMD of this name; by name for intents, which do not load the dialect."""
        self.send(number, Command[name], params, what, now)

    def query(self, command: Command, params: tuple[float, ...], now: float) -> None:
        """Send a command that is not a request of the operator; call it only while none of its kind is_waiting."""
        self._transmit(command, params, now)

    def is_waiting(self, command: Command | int) -> bool:
        """Return whether a command of this kind still waits for its COMMAND_ACK."""
        return self._client.is_waiting(int(command), self.target[0])

    def pop_queries(self) -> list[CommandOutcome]:
        """Return how the queries ended since the last call."""
        queries, self._queries = self._queries, []
        return queries

    def cancel(self, number: int, now: float) -> None:
        """Stop repeating a command. The vehicle may have done it, unless it still waits for a query."""
        for command, held in list(self._held.items()):
            if held.number == number:
                del self._held[command]
                self._book.cancel(number)
        for command, each in list(self._numbers.items()):
            if each == number:
                del self._numbers[command]
                self._client.cancel(command, self.target[0])
                self._book.cancel(number)

    def refuse(self, message: m.Message, why: str) -> None:
        """End the request whose command is not sent, because our role does not allow it."""
        self._client.refuse(message, why)

    def receive(self, received: Received, now: float) -> None:
        """Handle COMMAND_ACK of the vehicle."""
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, report progress."""
        self._client.tick(now)
        for command, number in self._numbers.items():
            progress = self._client.progress(command, self.target[0])
            if progress is not None:
                self._book.advance(number, progress, 100)
        self._handle_outcomes(now)

    def _transmit(self, command: int, params: tuple[float, ...], now: float, place: CommandPlace | None = None) -> None:
        system, component = self.target
        self._client.send(command, *params, target_system=system, target_component=component, now=now, place=place)

    def _release(self, command: int, now: float) -> None:
        """Send the request that has waited for the end of a query."""
        if (held := self._held.pop(command, None)) is not None:
            self._numbers[command] = held.number
            self._transmit(command, held.params, now, held.place)

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            number = self._numbers.pop(outcome.command, None)
            if number is None:
                self._queries.append(outcome)
                self._release(outcome.command, now)
            elif outcome.result is Result.ACCEPTED:
                self._book.accept(number)
            elif outcome.refusal:
                self._book.refuse(number, outcome.refusal, now, by_vehicle=False)
            elif outcome.number is None:
                self._book.fail(number, f"after {TRIES} tries")
            else:
                explained = outcome.command != Command.REQUEST_MESSAGE  # of which programs send many in a row
                text = _refusal(outcome.command, outcome.number)
                self._book.refuse(number, text, now, by_vehicle=explained, answer=outcome.number)


def _refusal(command: int, result: int) -> str:
    """Return a result by name. ArduPilot gives no reason while it still calibrates."""
    name = result_token(result)
    later = command == Command.PREFLIGHT_CALIBRATION and result == Result.TEMPORARILY_REJECTED
    return f"{name}: another calibration may be under way, try again in some seconds" if later else name
