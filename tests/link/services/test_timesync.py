"""Round trips by TIMESYNC, and the echoes that other ground stations ask for."""

from __future__ import annotations

import pytest

from dialects.messages import Heartbeat, Message, Ping, Timesync
from link.core import Peer, Received
from link.services.timesync import TimesyncClient, handle_request

OURS = (1, 1)


def received(message: Message, system: int = 1) -> Received:
    return Received(message, system, 1, 0, Peer(0, "there"), introduced=True)


def test_the_round_trip_is_from_question_to_answer() -> None:
    client = TimesyncClient(1)
    for start in (10.0, 11.0, 12.0):
        client.tick(start)
        [question] = client.messages_to_send()
        [echo] = handle_request(received(question.message), 5.0, OURS)
        client.receive(received(echo.message), start + 0.012)
    assert client.round_trip == pytest.approx(0.012)
    assert client.jitter == pytest.approx(0.0, abs=1e-6)


def test_one_question_a_second() -> None:
    client = TimesyncClient(1)
    for tenth in range(100):
        client.tick(tenth / 10)
    assert len(client.messages_to_send()) == 10


def test_answers_to_others_and_repeats_do_not_count() -> None:
    client = TimesyncClient(1)
    client.tick(1.0)
    client.receive(received(Timesync(tc1=99, ts1=12345)), 1.1)
    client.receive(received(Heartbeat(6, 8, 0, 0, 4, 3)), 1.1)
    assert client.round_trip is None


def test_an_answer_names_the_one_it_is_for() -> None:
    [echo] = handle_request(received(Timesync(tc1=0, ts1=7), system=255), 1.0, OURS)
    assert isinstance(echo.message, Timesync)
    assert (echo.message.ts1, echo.message.target_system, echo.message.target_component) == (7, 255, 1)


@pytest.mark.parametrize(
    ("target", "answered"), [((0, 0), 1), ((1, 0), 1), ((1, 1), 1), ((0, 1), 1), ((2, 1), 0), ((1, 42), 0)]
)
def test_a_question_for_others_is_not_answered(target: tuple[int, int], answered: int) -> None:
    assert len(handle_request(received(Timesync(0, 7, *target)), 1.0, OURS)) == answered


@pytest.mark.parametrize(("target", "counts"), [(0, True), (1, True), (2, False)])
def test_an_answer_to_us_or_of_an_old_program_counts(target: int, counts: bool) -> None:
    client = TimesyncClient(1)
    client.tick(1.0)
    [question] = client.messages_to_send()
    assert isinstance(question.message, Timesync)
    client.receive(received(Timesync(99, question.message.ts1, target, 1)), 1.1)
    assert (client.round_trip is not None) is counts


def test_an_answer_is_never_answered() -> None:
    assert handle_request(received(Timesync(tc1=99, ts1=1)), 1.0, OURS) == []


def test_a_ping_for_all_is_echoed_to_its_sender() -> None:
    [echo] = handle_request(received(Ping(17, 4, 0, 0), system=255), 1.0, OURS)
    ping = echo.message
    assert isinstance(ping, Ping)
    assert (ping.time_usec, ping.seq, ping.target_system, ping.target_component) == (17, 4, 255, 1)
    assert handle_request(received(Ping(17, 4, 9, 1)), 1.0, OURS) == []


def test_each_path_has_a_round_trip_of_its_own() -> None:
    client, near, far = TimesyncClient(255), Peer(0, "near"), Peer(1, "far")
    for start in (10.0, 11.0, 12.0):
        client.tick(start)
        [question] = client.messages_to_send()
        [echo] = handle_request(received(question.message, system=255), 5.0, OURS)
        for peer, trip in ((near, 0.01), (far, 0.4), (near, 0.5), (far, 0.6)):
            client.receive(received(echo.message)._replace(peer=peer), start + trip)
    assert client.round_trip == pytest.approx(0.01)
    assert client.round_trip_of(near, 13.0) == pytest.approx(0.01)
    assert client.round_trip_of(far, 13.0) == pytest.approx(0.4)
    assert client.round_trip_of(far, 17.0) is None
    assert client.round_trip_of(Peer(2, "other"), 13.0) is None


def test_answers_of_many_peers_fill_no_table() -> None:
    client = TimesyncClient(255)
    client.tick(10.0)
    [question] = client.messages_to_send()
    [echo] = handle_request(received(question.message, system=255), 5.0, OURS)
    for number in range(100):
        client.receive(received(echo.message)._replace(peer=Peer(0, number)), 10.1)
    assert sum(client.round_trip_of(Peer(0, number), 10.2) is not None for number in range(100)) == 16
