"""The command protocol: never silence, repeats with one effect, and an end for every question."""

from __future__ import annotations

import random

import pytest

from dialects.enums import Command, Result
from dialects.messages import CommandAck, CommandInt, CommandLong, Heartbeat, Message
from link.core import Outgoing, Peer, Received
from link.services.command.server import (
    REPEAT_AFTER,
    TRIES,
    CommandClient,
    CommandHandler,
    CommandRequest,
    CommandServer,
)

PEER = Peer(0, "there")


def received(message: Message, system: int = 255, component: int = 190) -> Received:
    return Received(message, system, component, 0, PEER, introduced=True)


def long(
    command: int, param1: float = 0.0, *, system: int = 1, component: int = 1, confirmation: int = 0
) -> CommandLong:
    return CommandLong(system, component, command, confirmation, param1, 0, 0, 0, 5, 6, 7)


class Vehicle:
    """A server that notes what it ran."""

    def __init__(self, result: Result = Result.ACCEPTED) -> None:
        self.ran: list[CommandRequest] = []
        self.result = result
        self.server = CommandServer(
            {
                Command.COMPONENT_ARM_DISARM: CommandHandler(self.run),
                Command.DO_FLIGHTTERMINATION: CommandHandler(self.run, broadcast=True),
            },
            system=1,
            component=1,
        )

    def run(self, request: CommandRequest, now: float) -> Result:
        self.ran.append(request)
        return self.result

    def ask(self, message: Message, now: float = 0.0, system: int = 255) -> list[CommandAck]:
        answers = [each.message for each in self.server.receive(received(message, system), now)]
        assert all(isinstance(each, CommandAck) for each in answers)
        return answers  # type: ignore[return-value]


def test_an_answer_names_the_asker_and_goes_to_its_peer() -> None:
    [outgoing] = Vehicle().server.receive(received(long(400, 1.0)), 0.0)
    ack = outgoing.message
    assert isinstance(ack, CommandAck)
    assert (ack.command, ack.result, ack.target_system, ack.target_component) == (400, Result.ACCEPTED, 255, 190)
    assert outgoing.peer == PEER


@pytest.mark.parametrize("command", [0, 22, 65535])
def test_unknown_commands_are_unsupported_and_never_silent(command: int) -> None:
    assert [ack.result for ack in Vehicle().ask(long(command))] == [Result.UNSUPPORTED]


@pytest.mark.parametrize(("system", "component"), [(2, 1), (1, 42), (0, 1), (0, 0)])
def test_commands_for_others_are_not_ours_to_answer(system: int, component: int) -> None:
    vehicle = Vehicle()
    assert vehicle.ask(long(400, 1.0, system=system, component=component)) == []
    assert vehicle.ran == []


def test_a_broadcast_is_obeyed_only_where_it_can_do_no_harm() -> None:
    vehicle = Vehicle()
    assert len(vehicle.ask(long(185, 1.0, system=0, component=0))) == 1
    assert len(vehicle.ran) == 1


def test_ten_times_the_same_is_ten_answers() -> None:
    vehicle = Vehicle()
    answers = [vehicle.ask(long(400, 1.0, confirmation=times), times * 0.01) for times in range(10)]
    assert [len(each) for each in answers] == [1] * 10


def test_a_wish_that_failed_may_be_tried_again_at_once() -> None:
    vehicle = Vehicle(Result.FAILED)
    vehicle.ask(long(400, 1.0), 0.0)
    vehicle.result = Result.ACCEPTED
    assert vehicle.ask(long(400, 1.0), 0.2)[0].result == Result.ACCEPTED


def test_command_int_is_the_same_command() -> None:
    vehicle = Vehicle()
    vehicle.ask(CommandInt(1, 1, 6, 400, 0, 0, 1.0, 2.0, 3.0, 4.0, 473977420, -85455940, 7.0))
    request = vehicle.ran[0]
    assert request.params == (1.0, 2.0, 3.0, 4.0, 473977420, -85455940, 7.0)
    assert (request.is_int, request.frame, request.x, request.y) == (True, 6, 473977420, -85455940)


def test_other_messages_are_nothing_to_the_server() -> None:
    assert Vehicle().ask(Heartbeat(6, 8, 0, 0, 4, 3)) == []


# ---- client ----


def sent(client: CommandClient) -> list[CommandLong]:
    return [each.message for each in client.messages_to_send()]  # type: ignore[misc]


def ack(command: int, result: int, target: int = 255) -> Received:
    return received(CommandAck(command, result, target_system=target, target_component=190), 1, 1)


def test_a_command_is_repeated_with_a_rising_confirmation_and_then_given_up() -> None:
    client, now, confirmations = CommandClient(255, 190), 0.0, []
    client.send(Command.COMPONENT_ARM_DISARM, 1.0, target_system=1, now=now)
    while not (outcomes := client.outcomes()):
        confirmations += [each.confirmation for each in sent(client)]
        now += 0.05
        client.tick(now)
    assert confirmations == list(range(TRIES))
    assert outcomes[0].result is None
    assert now == pytest.approx(TRIES * REPEAT_AFTER, abs=0.5)


def test_an_answer_ends_the_repeats() -> None:
    client = CommandClient(255, 190)
    client.send(Command.COMPONENT_ARM_DISARM, 1.0, target_system=1, now=0.0)
    assert sent(client)[0].param1 == 1.0
    client.receive(ack(400, Result.DENIED), 0.1)
    [outcome] = client.outcomes()
    assert (outcome.command, outcome.result, outcome.target_system) == (400, Result.DENIED, 1)
    client.tick(10.0)
    assert sent(client) == []
    assert client.outcomes() == []


def test_answers_to_others_and_from_others_do_not_count() -> None:
    client = CommandClient(255, 190)
    client.send(400, 1.0, target_system=1, now=0.0)
    client.receive(ack(400, Result.ACCEPTED, target=254), 0.1)
    client.receive(received(CommandAck(400, 0, target_system=255), 2, 1), 0.1)
    client.receive(ack(176, Result.ACCEPTED), 0.1)
    assert client.outcomes() == []
    assert client.is_waiting(400, 1)


def test_an_unknown_result_is_a_failure_with_its_number() -> None:
    client = CommandClient(255, 190)
    client.send(400, 1.0, target_system=1, now=0.0)
    client.receive(ack(400, 77), 0.1)
    [outcome] = client.outcomes()
    assert (outcome.result, outcome.number) == (Result.FAILED, 77)


def test_in_progress_is_patience_and_not_the_end() -> None:
    client = CommandClient(255, 190)
    client.send(400, 1.0, target_system=1, now=0.0)
    client.receive(ack(400, Result.IN_PROGRESS), 0.1)
    client.tick(1.0)
    assert len(sent(client)) == 1
    client.receive(ack(400, Result.ACCEPTED), 1.1)
    assert client.outcomes()[0].result is Result.ACCEPTED


def test_a_newer_wish_replaces_the_older_of_its_kind() -> None:
    client = CommandClient(255, 190)
    client.send(400, 1.0, target_system=1, now=0.0)
    client.send(400, 0.0, target_system=1, now=0.1)
    sent(client)
    client.tick(0.1 + REPEAT_AFTER)
    assert [each.param1 for each in sent(client)] == [0.0]
    client.cancel(400)
    client.tick(10.0)
    assert sent(client) == []


def test_a_lossy_link_still_ends_every_command() -> None:
    dice, vehicle, client, now = random.Random(3), Vehicle(), CommandClient(255, 190), 0.0
    ended = []
    for _ in range(200):
        client.send(400, 1.0, target_system=1, now=now)
        while not (outcomes := client.outcomes()):
            for outgoing in client.messages_to_send():
                answers: list[Outgoing] = vehicle.server.receive(received(outgoing.message), now)
                if dice.random() > 0.3 and answers and dice.random() > 0.3:
                    client.receive(received(answers[0].message, 1, 1), now)
            now += 0.05
            client.tick(now)
        ended += outcomes
    assert len(ended) == 200
    assert sum(each.result is Result.ACCEPTED for each in ended) > 190
