"""The server half of the command protocol: every command for us is answered, and repeats have one effect."""

from __future__ import annotations

import pytest

from dialects.enums import Result
from dialects.messages import CommandAck, CommandInt, Heartbeat
from tests.link.command_rig import PEER, CommandRig, long, received


def test_an_answer_names_the_asker_and_goes_to_its_peer() -> None:
    [outgoing] = CommandRig().server.receive(received(long(400, 1.0)), 0.0)
    ack = outgoing.message
    assert isinstance(ack, CommandAck)
    assert (ack.command, ack.result, ack.target_system, ack.target_component) == (400, Result.ACCEPTED, 255, 190)
    assert outgoing.peer == PEER


@pytest.mark.parametrize("command", [0, 22, 65535])
def test_unknown_commands_are_unsupported_and_never_silent(command: int) -> None:
    assert [ack.result for ack in CommandRig().ask(long(command))] == [Result.UNSUPPORTED]


@pytest.mark.parametrize(("system", "component"), [(2, 1), (1, 42), (0, 1), (0, 0)])
def test_commands_for_others_are_not_ours_to_answer(system: int, component: int) -> None:
    vehicle = CommandRig()
    assert vehicle.ask(long(400, 1.0, system=system, component=component)) == []
    assert vehicle.ran == []


def test_a_broadcast_is_obeyed_only_where_it_can_do_no_harm() -> None:
    vehicle = CommandRig()
    assert len(vehicle.ask(long(185, 1.0, system=0, component=0))) == 1
    assert len(vehicle.ran) == 1


def test_ten_times_the_same_is_ten_answers() -> None:
    vehicle = CommandRig()
    answers = [vehicle.ask(long(400, 1.0, confirmation=times), times * 0.01) for times in range(10)]
    assert [len(each) for each in answers] == [1] * 10


def test_a_wish_that_failed_may_be_tried_again_at_once() -> None:
    vehicle = CommandRig(Result.FAILED)
    vehicle.ask(long(400, 1.0), 0.0)
    vehicle.result = Result.ACCEPTED
    assert vehicle.ask(long(400, 1.0), 0.2)[0].result == Result.ACCEPTED


def test_command_int_is_the_same_command() -> None:
    vehicle = CommandRig()
    vehicle.ask(CommandInt(1, 1, 6, 400, 0, 0, 1.0, 2.0, 3.0, 4.0, 473977420, -85455940, 7.0))
    request = vehicle.ran[0]
    assert request.params == (1.0, 2.0, 3.0, 4.0, 473977420, -85455940, 7.0)
    assert (request.is_int, request.frame, request.x, request.y) == (True, 6, 473977420, -85455940)


def test_other_messages_are_nothing_to_the_server() -> None:
    assert CommandRig().ask(Heartbeat(6, 8, 0, 0, 4, 3)) == []
