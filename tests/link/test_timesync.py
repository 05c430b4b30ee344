"""Round trips by TIMESYNC, and the echoes that other ground stations ask for."""

from __future__ import annotations

import pytest

from dialects.messages import Heartbeat, Message, Ping, Timesync
from link.core import Peer, Received
from link.services.timesync import TimesyncClient, answer


def received(message: Message, system: int = 1) -> Received:
    return Received(message, system, 1, 0, Peer(0, "there"), introduced=True)


def test_the_round_trip_is_from_question_to_answer() -> None:
    client = TimesyncClient()
    for start in (10.0, 11.0, 12.0):
        client.tick(start)
        [question] = client.messages_to_send()
        [echo] = answer(received(question.message), 5.0, 1)
        client.receive(received(echo.message), start + 0.012)
    assert client.round_trip == pytest.approx(0.012)
    assert client.jitter == pytest.approx(0.0, abs=1e-6)


def test_one_question_a_second() -> None:
    client = TimesyncClient()
    for tenth in range(100):
        client.tick(tenth / 10)
    assert len(client.messages_to_send()) == 10


def test_answers_to_others_and_repeats_do_not_count() -> None:
    client = TimesyncClient()
    client.tick(1.0)
    client.receive(received(Timesync(tc1=99, ts1=12345)), 1.1)
    client.receive(received(Heartbeat(6, 8, 0, 0, 4, 3)), 1.1)
    assert client.round_trip is None


def test_an_answer_is_never_answered() -> None:
    assert answer(received(Timesync(tc1=99, ts1=1)), 1.0, 1) == []


def test_a_ping_for_all_is_echoed_to_its_sender() -> None:
    [echo] = answer(received(Ping(17, 4, 0, 0), system=255), 1.0, 1)
    ping = echo.message
    assert isinstance(ping, Ping)
    assert (ping.time_usec, ping.seq, ping.target_system, ping.target_component) == (17, 4, 255, 1)
    assert answer(received(Ping(17, 4, 9, 1)), 1.0, 1) == []
