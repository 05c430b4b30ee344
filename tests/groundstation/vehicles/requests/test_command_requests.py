"""Requests for commands: a query of the station's own does not get in their way."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.requests import RequestBook, RequestState
from link.core import Peer, Received
from link.services.command.client import CommandClient

QUERY, REQUEST = (float(m.HomePosition.id),), (float(m.SysStatus.id),)


class Rig:
    """Requests to vehicle 1, whose answers the test gives."""

    def __init__(self) -> None:
        self.book = RequestBook()
        self.client = CommandClient(255, 190)
        self.requests = CommandRequests(self.client, self.book, (1, 1))

    def request(self, number: int) -> None:
        """Request SYS_STATUS."""
        self.requests.send(number, Command.REQUEST_MESSAGE, REQUEST, "SYS_STATUS", 0.0)

    def answer(self, result: Result, now: float = 0.1) -> None:
        """Let the vehicle answer REQUEST_MESSAGE."""
        ack = m.CommandAck(Command.REQUEST_MESSAGE, result, 0, 0, 255, 190)
        self.requests.receive(Received(ack, 1, 1, 0, Peer(0, "here"), introduced=True), now)

    def sent(self) -> list[float]:
        """Return the messages that were requested since the last call."""
        commands = [each.message for each in self.client.messages_to_send()]
        return [each.param1 for each in commands if isinstance(each, m.CommandLong)]

    def states(self) -> dict[int, RequestState]:
        """Return what has become of requests since the last call."""
        return {report.number: report.state for report in self.book.pop_changes()}


def test_a_request_follows_the_query_under_way() -> None:
    rig = Rig()
    rig.requests.query(Command.REQUEST_MESSAGE, QUERY, 0.0)
    rig.request(1)
    assert rig.sent() == [*QUERY]
    assert rig.states() == {1: RequestState.RUNNING}
    rig.answer(Result.UNSUPPORTED)  # of the query, and not of the request
    assert rig.sent() == [*REQUEST]
    assert [each.result for each in rig.requests.pop_queries()] == [Result.UNSUPPORTED]
    rig.answer(Result.ACCEPTED)
    assert rig.states() == {1: RequestState.ACCEPTED}


def test_a_second_request_of_a_kind_is_refused() -> None:
    rig = Rig()
    rig.requests.query(Command.REQUEST_MESSAGE, QUERY, 0.0)
    for number in (1, 2):
        rig.request(number)
    assert rig.states() == {1: RequestState.RUNNING, 2: RequestState.REFUSED}
    rig.answer(Result.ACCEPTED)
    rig.request(3)
    assert rig.states() == {3: RequestState.REFUSED}


def test_a_request_that_waits_for_a_query_can_be_cancelled() -> None:
    rig = Rig()
    rig.requests.query(Command.REQUEST_MESSAGE, QUERY, 0.0)
    rig.request(1)
    rig.requests.cancel(1, 0.0)
    rig.answer(Result.ACCEPTED)
    assert rig.sent() == [*QUERY]
    assert rig.states() == {1: RequestState.CANCELLED}
