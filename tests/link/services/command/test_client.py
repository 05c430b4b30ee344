"""The client half of the command protocol: repeats, and an outcome for every command."""

from __future__ import annotations

import math
import random

import pytest

from dialects.enums import Command, Rejection, Result
from dialects.messages import CommandAck, CommandInt, CommandLong
from link.core import Outgoing, Received
from link.services.command.client import REPEAT_AFTER, TRIES, CommandClient, CommandPlace
from tests.link.command_rig import CommandRig, received


def sent(client: CommandClient) -> list[CommandLong]:
    return [each.message for each in client.messages_to_send()]  # type: ignore[misc]


def ack(command: int, result: int, target: int = 255) -> Received:
    return received(CommandAck(command, result, target_system=target, target_component=190), 1, 1)


def test_command_repeats_with_rising_confirmation_then_gives_up() -> None:
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
    client.cancel(400, 1)
    client.tick(10.0)
    assert sent(client) == []


def test_a_lossy_link_still_ends_every_command() -> None:
    dice, vehicle, client, now = random.Random(3), CommandRig(), CommandClient(255, 190), 0.0
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


def test_command_with_a_place_is_an_int_and_repeats_unconfirmed() -> None:
    client = CommandClient(255, 190)
    place = CommandPlace(3, -353632621, 1491652374)
    client.send(192, -1.0, 1.0, 0.0, 0.0, 9.0, 9.0, 5.0, target_system=1, now=0.0, place=place)
    client.tick(REPEAT_AFTER)
    first, again = (each.message for each in client.messages_to_send())
    assert isinstance(first, CommandInt)
    assert (first.frame, first.x, first.y, first.z, first.param2) == (3, -353632621, 1491652374, 5.0, 1.0)
    assert first.to_dict() == again.to_dict()
    client.receive(ack(192, Result.ACCEPTED), 0.5)
    assert [each.result for each in client.outcomes()] == [Result.ACCEPTED]


def rejected_for_want_of_a_proof() -> Received:
    answer = CommandAck(400, Result.TEMPORARILY_REJECTED, 0, Rejection.NO_PROOF, 255, 190)
    return received(answer, 1, 1)


def test_a_command_that_lacks_a_proof_is_repeated() -> None:
    client = CommandClient(255, 190)
    client.send(Command.COMPONENT_ARM_DISARM, 1.0, target_system=1, now=0.0)
    client.receive(rejected_for_want_of_a_proof(), 0.1)
    client.tick(REPEAT_AFTER)
    assert [each.confirmation for each in sent(client)] == [0, 1]
    client.receive(ack(400, Result.ACCEPTED), 0.5)
    assert [each.result for each in client.outcomes()] == [Result.ACCEPTED]


def test_a_command_that_lacks_a_proof_to_the_end_is_rejected() -> None:
    client, now = CommandClient(255, 190), 0.0
    client.send(Command.COMPONENT_ARM_DISARM, 1.0, target_system=1, now=now)
    while not (outcomes := client.outcomes()):
        for _ in sent(client):
            client.receive(rejected_for_want_of_a_proof(), now)
        now += 0.05
        client.tick(now)
    assert [(each.result, each.number) for each in outcomes] == [(Result.TEMPORARILY_REJECTED, 1)]
    assert now == pytest.approx(TRIES * REPEAT_AFTER, abs=0.5)


INT_ONLY, LONG_ONLY = 8, 7


def forms(client: CommandClient) -> list[tuple[type, int]]:
    return [(type(each), each.target_component) for each in sent(client)]


def test_a_command_that_is_taken_as_command_int_only_goes_so() -> None:
    client = CommandClient(255, 190)
    client.send(Command.DO_SET_HOME, 0.0, 0, 0, 0, 47.5, -8.25, 400.0, target_system=1, now=0.0)
    sent(client)
    client.receive(ack(179, INT_ONLY), 0.1)
    [message] = sent(client)
    assert isinstance(message, CommandInt)
    assert (message.frame, message.x, message.y, message.z) == (0, 475_000_000, -82_500_000, 400.0)
    assert client.outcomes() == []
    client.receive(ack(179, Result.ACCEPTED), 0.2)
    assert client.outcomes()[0].result is Result.ACCEPTED


def test_command_int_is_sent_as_long_to_a_vehicle_that_needs_it() -> None:
    client = CommandClient(255, 190)
    place = CommandPlace(3, 475_000_000, 82_500_000)
    client.send(Command.DO_REPOSITION, -1.0, 1, 0, math.nan, 0, 0, 3.0, target_system=1, now=0.0, place=place)
    sent(client)
    client.receive(ack(192, LONG_ONLY), 0.1)
    [message] = sent(client)
    assert isinstance(message, CommandLong)
    assert (message.param1, message.param5, message.param6, message.param7) == (-1.0, 47.5, 8.25, 3.0)


def test_a_command_that_is_refused_in_both_forms_ends() -> None:
    client = CommandClient(255, 190)
    client.send(400, 0.0, target_system=1, now=0.0)
    client.receive(ack(400, INT_ONLY), 0.1)
    client.receive(ack(400, LONG_ONLY), 0.2)
    assert [each.number for each in client.outcomes()] == [LONG_ONLY]
    client.send(400, 0.0, 0, 0, 0, 1e12, target_system=1, now=0.0)
    client.receive(ack(400, INT_ONLY), 0.1)
    assert [each.number for each in client.outcomes()] == [INT_ONLY], "parameter 5 fits no integer"


def test_answers_to_the_form_that_was_refused_end_nothing() -> None:
    client = CommandClient(255, 190)
    client.send(400, 0.0, target_system=1, stop=True, now=0.0)
    for at in (0.1, 0.15, 0.2):
        client.receive(ack(400, INT_ONLY), at)
    assert client.outcomes() == [], "two more frames were on their way as COMMAND_LONG"
    client.receive(ack(400, Result.ACCEPTED), 0.3)
    assert client.outcomes()[0].result is Result.ACCEPTED


def test_an_unanswered_stop_goes_in_both_forms_to_all_components() -> None:
    client = CommandClient(255, 190)
    client.send(400, 0.0, target_system=1, target_component=1, further=(0, 2), stop=True, now=0.0)
    assert forms(client) == [(CommandLong, 1), (CommandLong, 0), (CommandLong, 2)]
    client.tick(REPEAT_AFTER)
    assert forms(client) == [(CommandInt, 1), (CommandInt, 0), (CommandInt, 2)]
    client.tick(2 * REPEAT_AFTER)
    assert {kind for kind, _ in forms(client)} == {CommandLong}


def test_other_commands_keep_their_form_without_an_answer() -> None:
    client = CommandClient(255, 190)
    client.send(400, 1.0, target_system=1, now=0.0)
    client.tick(REPEAT_AFTER)
    assert {kind for kind, _ in forms(client)} == {CommandLong}


def test_a_refusal_of_one_component_ends_nothing_for_the_others() -> None:
    client = CommandClient(255, 190)
    client.send(400, 0.0, target_system=1, target_component=1, further=(0, 2), stop=True, now=0.0)
    client.receive(received(CommandAck(400, 3, target_system=255), 1, 2), 0.1)
    assert client.outcomes() == []
    client.receive(received(CommandAck(400, 0, target_system=255), 1, 1), 0.2)
    assert [each.number for each in client.outcomes()] == [0]


def test_a_stop_is_not_refused_for_its_unknown_second_form() -> None:
    client = CommandClient(255, 190)
    client.send(400, 0.0, target_system=1, stop=True, now=0.0)
    client.tick(REPEAT_AFTER)
    client.receive(ack(400, Result.UNSUPPORTED), 0.5)
    assert client.outcomes() == []
    client.tick(2 * REPEAT_AFTER)
    client.receive(ack(400, Result.ACCEPTED), 0.9)
    assert client.outcomes()[0].result is Result.ACCEPTED
