"""Commands that take a while: one final answer, news on the way, and a cancel that always helps."""

from __future__ import annotations

from dialects.enums import Result
from dialects.messages import CommandAck, CommandCancel, CommandInt, CommandLong, Message
from link.core import Outgoing, Peer, Received
from link.services.command.client import CommandClient
from link.services.command.jobs import PROGRESS_PERIOD, REPEAT_WINDOW, CommandJob
from link.services.command.request import CommandRequest
from link.services.command.server import CommandHandler, CommandServer

HERE, THERE = Peer(0, "here"), Peer(0, "there")
TEST, OTHER = 209, 310


class Work:
    """A job of 2 s."""

    def __init__(self, now: float, result: Result = Result.ACCEPTED) -> None:
        self.began, self.result, self.cancelled, self.stepped = now, result, 0, 0
        self.percent: int | None = None

    def step(self, now: float) -> Result | None:
        self.stepped += 1
        return self.result if now - self.began >= 2.0 else None

    def cancel(self, now: float) -> None:
        self.cancelled += 1


class JobRig:
    """A server whose commands take a while, and the works it began."""

    def __init__(self) -> None:
        self.works: list[Work] = []
        self.refusal: Result | None = None
        handler = CommandHandler(self.begin)
        self.server = CommandServer({TEST: handler, OTHER: handler}, system=1, component=1)

    def begin(self, request: CommandRequest, now: float) -> Result | CommandJob:
        if self.refusal is not None:
            return self.refusal
        self.works.append(Work(now))
        return self.works[-1]

    def say(self, message: Message, now: float, system: int = 255, peer: Peer = HERE) -> list[Outgoing]:
        return self.server.receive(Received(message, system, 190, 0, peer, introduced=True), now)

    def ask(self, now: float, param1: float = 0.0, *, system: int = 255, command: int = TEST, confirmation: int = 0,
            ) -> list[Result]:  # fmt: skip
        return results(self.say(CommandLong(1, 1, command, confirmation, param1, 0, 0, 0, 0, 0, 0), now, system=system))

    def cancel(self, now: float, command: int = TEST, *, system: int = 255, target: tuple[int, int] = (1, 1)) -> list[
        Outgoing
    ]:  # fmt: skip
        return self.say(CommandCancel(*target, command), now, system=system, peer=HERE if system == 255 else THERE)


def results(outgoing: list[Outgoing]) -> list[Result]:
    return [Result(ack_of(each).result) for each in outgoing]


def ack_of(outgoing: Outgoing) -> CommandAck:
    assert isinstance(outgoing.message, CommandAck)
    return outgoing.message


def test_it_begins_tells_its_progress_and_ends_once() -> None:
    vehicle = JobRig()
    assert vehicle.ask(0.0) == [Result.IN_PROGRESS]
    words: list[Outgoing] = []
    for cycle in range(1, 200):
        vehicle.works[0].percent = min(100, cycle)
        words += vehicle.server.tick(cycle * 0.02)
    progress = [ack_of(each).progress for each in words[:-1]]
    assert results(words) == [Result.IN_PROGRESS] * 3 + [Result.ACCEPTED]
    assert progress == sorted(progress)
    assert {(each.peer, ack_of(each).target_system, ack_of(each).target_component) for each in words} == {
        (HERE, 255, 190)
    }
    assert vehicle.works[0].stepped == 100  # none after the end


def test_unknown_progress_is_255() -> None:
    [outgoing] = JobRig().say(CommandLong(1, 1, TEST, 0, 0, 0, 0, 0, 0, 0, 0), 0.0)
    assert ack_of(outgoing).progress == 255


def test_a_refused_one_is_no_job() -> None:
    vehicle = JobRig()
    vehicle.refusal = Result.DENIED
    assert vehicle.ask(0.0) == [Result.DENIED]
    assert vehicle.cancel(0.1) == []
    assert vehicle.server.tick(1.0) == []


def test_its_repeat_begins_nothing_and_another_one_has_to_wait() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    assert vehicle.ask(0.3) == [Result.IN_PROGRESS]
    assert vehicle.ask(0.6, confirmation=1) == [Result.IN_PROGRESS]
    assert vehicle.ask(0.7, 1.0) == [Result.TEMPORARILY_REJECTED]
    assert vehicle.ask(0.8, system=254) == [Result.TEMPORARILY_REJECTED]
    assert vehicle.ask(0.9, command=OTHER) == [Result.IN_PROGRESS]
    assert len(vehicle.works) == 2


def test_a_repeat_with_nan_parameters_is_still_a_repeat() -> None:
    vehicle = JobRig()
    for times in range(2):  # each decodes to a NaN of its own
        nan = float("nan")
        said = vehicle.say(CommandLong(1, 1, TEST, times, 1.0, nan, nan, nan, nan, nan, nan), times * 0.3)
        assert results(said) == [Result.IN_PROGRESS]
    assert len(vehicle.works) == 1


def test_long_after_its_beginning_only_what_says_so_is_a_repeat() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    assert vehicle.ask(REPEAT_WINDOW + 1, confirmation=2) == [Result.IN_PROGRESS]
    assert vehicle.ask(REPEAT_WINDOW + 1) == [Result.TEMPORARILY_REJECTED]


def test_repeat_after_end_hears_of_it_and_a_new_wish_starts_anew() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    assert results(vehicle.server.tick(2.0)) == [Result.ACCEPTED]
    assert vehicle.ask(2.5, confirmation=1) == [Result.ACCEPTED]
    assert len(vehicle.works) == 1
    assert vehicle.ask(2.6) == [Result.IN_PROGRESS]
    assert len(vehicle.works) == 2


def test_a_command_int_counts_as_a_repeat_for_a_while() -> None:
    vehicle = JobRig()
    same = CommandInt(1, 1, 0, TEST, 0, 0, 0, 0, 0, 0, 0, 0, 0)
    vehicle.say(same, 0.0)
    vehicle.server.tick(2.0)
    assert results(vehicle.say(same, 2.1)) == [Result.ACCEPTED]
    assert results(vehicle.say(same, 2.0 + REPEAT_WINDOW)) == [Result.IN_PROGRESS]
    assert len(vehicle.works) == 2


def test_a_cancel_stops_it_and_is_its_end() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    [outgoing] = vehicle.cancel(0.5)
    assert (ack_of(outgoing).command, ack_of(outgoing).result) == (TEST, Result.CANCELLED)
    assert (vehicle.works[0].cancelled, vehicle.works[0].stepped) == (1, 0)
    assert vehicle.server.tick(2.0 + PROGRESS_PERIOD) == []
    assert results(vehicle.cancel(0.9)) == [Result.CANCELLED]  # said again because the answer was lost
    assert vehicle.works[0].cancelled == 1


def test_whoever_cancels_and_whoever_began_hear_of_it() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    words = vehicle.cancel(0.5, system=254)
    assert {(each.peer, ack_of(each).target_system) for each in words} == {(HERE, 255), (THERE, 254)}
    assert results(words) == [Result.CANCELLED] * 2


def test_a_cancel_finds_nothing_idle_and_nothing_of_others() -> None:
    vehicle = JobRig()
    assert vehicle.cancel(0.0) == []
    vehicle.ask(0.0)
    for target in ((2, 1), (1, 42), (0, 0), (0, 1)):
        assert vehicle.cancel(0.1, target=target) == []
    assert vehicle.cancel(0.1, OTHER) == []
    assert vehicle.cancel(0.1, 400) == []
    assert vehicle.works[0].cancelled == 0
    assert len(vehicle.cancel(0.1, target=(1, 0))) == 1


def test_a_cancel_long_after_the_end_is_ignored() -> None:
    vehicle = JobRig()
    vehicle.ask(0.0)
    vehicle.server.tick(2.0)
    assert vehicle.cancel(2.0 + REPEAT_WINDOW) == []


def test_client_waits_for_end_on_a_line_that_loses_first_words() -> None:
    vehicle, client, now = JobRig(), CommandClient(255, 190), 0.0
    client.send(TEST, target_system=1, now=now)
    answers, outcomes = 0, client.outcomes()
    while not outcomes:
        assert now < 10.0
        words = [word for each in client.messages_to_send() for word in vehicle.say(each.message, now)]
        for word in words + vehicle.server.tick(now):
            answers += 1
            if answers > 2:
                client.receive(Received(word.message, 1, 1, 0, HERE, introduced=True), now)
        now += 0.05
        client.tick(now)
        outcomes = client.outcomes()
    assert [each.result for each in outcomes] == [Result.ACCEPTED]
    assert len(vehicle.works) == 1
