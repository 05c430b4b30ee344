"""An address that may be forged gets a bounded multiple of what came from it, until it answers."""

from __future__ import annotations

import pytest

from dialects import codec
from dialects import messages as m
from link.core import Outgoing
from link.protocol.address_budget import AddressBudget
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningPolicy
from link.signing.role import SigningRole
from tests.link.frames import frame, heartbeat, version_1
from tests.link.signing import signed as signing

VICTIM = ("192.0.2.7", 14550)
BEAT = m.Heartbeat(10, 0, 81, 0, 3, 3)
STATUS = m.SysStatus(*(1,) * 13)
OPEN = SigningPolicy(unsigned=SigningRole.WATCH)


def vehicle(*, stream: bool = False, target: tuple[str, int] | None = None, bounded: bool = True) -> Channel:
    wanted = frozenset({m.Heartbeat.id, m.Ping.id, m.Timesync.id, m.ParamRequestList.id})
    return Channel("udp", 0, system=1, component=1, stream=stream, target=target, wanted=wanted, bounded=bounded)


def told(channel: Channel, message: m.Message = STATUS, times: int = 3000) -> int:
    """Bytes of a message that the address gets when it is sent again and again."""
    outgoing = Outgoing(message)
    return sum(len(data) for _ in range(times) for data, _, _ in channel.send(outgoing))


def asked(channel: Channel, now: float) -> list[m.Message]:
    found = (codec.decode_frame(int.from_bytes(data[7:10], "little"), data) for data, _ in channel.questions(now))
    return list(found)


def test_one_heartbeat_brings_a_hundred_times_its_size() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    assert (len(heartbeat(0)), len(frame(STATUS))) == (21, 43)
    assert told(channel) == 2100 // 43 * 43
    channel.receive(heartbeat(1), VICTIM, 1.0)
    assert 1900 < told(channel) < 2200, "default telemetry to who sends a HEARTBEAT a second is half of that"


def test_a_first_request_brings_room_for_all_parameters_once() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    channel.receive(frame(m.ParamRequestList(1, 1), 1), VICTIM, 0.0)
    assert 11_000 < told(channel) < 12_500
    channel.receive(frame(m.ParamRequestList(1, 1), 2), VICTIM, 0.0)
    assert told(channel) < 2500


def test_what_was_saved_up_has_a_limit() -> None:
    channel = vehicle()
    for number in range(200):
        channel.receive(heartbeat(number), VICTIM, float(number))
    assert told(channel) <= 65536


def test_heartbeats_and_acknowledgements_always_go_out() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    told(channel)
    assert told(channel) == 0
    assert told(channel, BEAT, 10) == 10 * 21
    assert told(channel, m.CommandAck(400, 0, 0, 0, 255, 190), 10) > 0


def test_an_answer_to_ping_or_timesync_lifts_the_limit() -> None:
    for kind in (m.Ping, m.Timesync):
        channel = vehicle()
        channel.receive(heartbeat(0), VICTIM, 0.0)
        told(channel)
        ping, timesync = asked(channel, 0.0)
        assert isinstance(ping, m.Ping)
        assert isinstance(timesync, m.Timesync)
        answers = {m.Ping: m.Ping(ping.time_usec, ping.seq, 1, 1), m.Timesync: m.Timesync(7, timesync.ts1)}
        channel.receive(frame(answers[kind], 1), VICTIM, 0.1)
        assert told(channel) > 100_000
        assert asked(channel, 60.0) == []


def test_a_guess_and_an_echo_of_the_question_are_no_answers() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    ping, timesync = asked(channel, 0.0)
    assert isinstance(ping, m.Ping)
    assert isinstance(timesync, m.Timesync)
    for number, wrong in enumerate(
        (m.Ping(ping.time_usec + 1, 1, 1, 1), m.Ping(ping.time_usec, 1, 0, 0), m.Timesync(0, timesync.ts1)), 1
    ):
        channel.receive(frame(wrong, number), VICTIM, 0.1)
    assert told(channel) < 20_000


def test_it_asks_five_times_and_then_seldom() -> None:
    channel = vehicle()
    assert asked(channel, 0.0) == [], "nobody is there"
    channel.receive(heartbeat(0), VICTIM, 0.0)
    times = [now / 10 for now in range(600) if asked(channel, now / 10)]
    assert times[:5] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert times[5:] == [14.0, 24.0, 34.0, 44.0, 54.0]


def test_who_has_sent_no_heartbeat_is_not_asked() -> None:
    channel = vehicle()
    channel.receive(frame(m.ParamRequestList(1, 1), 1), VICTIM, 0.0)
    assert asked(channel, 0.0) == []


def test_a_signature_lifts_the_limit_for_good() -> None:
    channel = signing.vehicle(signing.keep(signing.DRIVER), OPEN, bounded=True)
    channel.receive(heartbeat(0, system=100), VICTIM, 0.0)
    assert told(channel) == 2100 // 56 * 56, "signatures count"
    channel.receive(signing.signed(), VICTIM, 0.1)
    channel.receive(heartbeat(1, system=100), VICTIM, 0.2)
    assert told(channel) > 100_000


def test_a_link_without_keys_counts_no_signatures() -> None:
    channel = signing.vehicle(signing.keep(), OPEN, bounded=True)
    channel.receive(heartbeat(0), VICTIM, 0.0)
    assert told(channel) == 2100 // 43 * 43


def test_frames_in_both_versions_count_twice() -> None:
    """A forger may send both, and has every broadcast come twice."""
    channel = vehicle()
    for each in (version_1(m.Heartbeat(6, 8, 0, 0, 4, 3), 0, 253, 190), heartbeat(0, system=254)):
        channel.receive(each, VICTIM, 0.0)
    assert len(list(channel.send(Outgoing(STATUS)))) == 2
    assert told(channel) < 100 * (17 + 21)


def test_what_was_withheld_is_reported_as_dropped() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    size = len(next(channel.send(Outgoing(STATUS)))[0])
    sent = 1 + told(channel, times=100) // size
    assert channel.report(dropped=5).dropped == 5 + 101 - sent


def test_what_is_passed_on_for_others_counts_as_well() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), VICTIM, 0.0)
    size = len(frame(STATUS))
    passed = [channel.may_send(STATUS.id, size, VICTIM) for _ in range(100)]
    assert passed == [True] * (2100 // size) + [False] * (100 - 2100 // size)
    assert channel.report(dropped=0).dropped == passed.count(False)
    assert channel.may_send(STATUS.id, size, ("192.0.2.8", 14550)), "of an address that is not known nothing is kept"


def test_named_addresses_connections_stations_have_no_limit() -> None:
    for channel in (vehicle(target=VICTIM), vehicle(stream=True), vehicle(bounded=False)):
        channel.receive(heartbeat(0), VICTIM, 0.0)
        assert told(channel) > 100_000
        assert asked(channel, 0.0) == []


@pytest.mark.parametrize("wanted", [None, frozenset({m.Heartbeat.id})])
def test_a_program_that_handles_no_ping_answers_it(wanted: frozenset[int] | None) -> None:
    channel = Channel("udp", 0, system=255, component=190, wanted=wanted)
    channel.receive(frame(BEAT, 0, 7, 9), VICTIM, 0.0)
    channel.receive(frame(m.Ping(77, 3, 0, 0), 1, 7, 9), VICTIM, 0.0)
    channel.receive(frame(m.Ping(78, 3, 255, 190), 2, 7, 9), VICTIM, 0.0)
    [answer] = asked(channel, 0.0)
    assert isinstance(answer, m.Ping)
    assert (answer.time_usec, answer.seq, answer.target_system, answer.target_component) == (77, 3, 7, 9)
    assert asked(channel, 0.0) == []


def test_a_program_that_handles_ping_answers_it_itself() -> None:
    channel = vehicle(bounded=False)
    channel.receive(frame(m.Ping(77, 3, 0, 0), 1), VICTIM, 0.0)
    assert asked(channel, 0.0) == []


def test_32_answers_to_ping_wait_at_once() -> None:
    channel = Channel("udp", 0, system=255, component=190)
    for number in range(40):
        channel.receive(frame(m.Ping(number, number, 0, 0), number, 7, 9), VICTIM, 0.0)
    assert [each.time_usec for each in asked(channel, 0.0) if isinstance(each, m.Ping)] == list(range(32))


def test_a_message_that_is_no_answer_proves_nothing() -> None:
    budget = AddressBudget()
    ping, sync = budget.questions(0.0)
    budget.note_answer(BEAT)
    assert not budget.proven
    assert isinstance(ping, m.Ping)
    assert isinstance(sync, m.Timesync)
    budget.note_answer(m.Timesync(1, sync.ts1))
    assert budget.proven


def test_an_answer_with_another_number_proves_nothing() -> None:
    for wrong in (m.Timesync(7, 1), m.Timesync(0, 1), m.Ping(1, 1, 1, 1)):
        budget = AddressBudget()
        list(budget.questions(0.0))
        budget.note_answer(wrong)
        assert not budget.proven


def test_what_is_proven_stays_so() -> None:
    for later in (m.Timesync(7, 1), m.Ping(1, 1, 1, 1)):
        budget = AddressBudget()
        ping, _ = budget.questions(0.0)
        assert isinstance(ping, m.Ping)
        budget.note_answer(m.Ping(ping.time_usec, 1, 1, 1))
        budget.note_answer(later)
        assert budget.proven


def test_the_questions_are_to_everybody_and_no_answers() -> None:
    ping, sync = AddressBudget().questions(0.0)
    assert isinstance(ping, m.Ping)
    assert isinstance(sync, m.Timesync)
    assert (ping.seq, ping.target_system, ping.target_component) == (1, 0, 0)
    assert sync.tc1 == 0


def test_two_addresses_are_asked_with_numbers_that_differ() -> None:
    numbers = set()
    for _ in range(100):
        ping, sync = AddressBudget().questions(0.0)
        assert isinstance(ping, m.Ping)
        assert isinstance(sync, m.Timesync)
        assert ping.time_usec == sync.ts1
        numbers.add(ping.time_usec)
    assert len(numbers) == 100
    assert max(numbers) > 1 << 56, "nobody can guess them"


def test_the_last_byte_of_the_budget_may_be_sent() -> None:
    budget = AddressBudget()
    assert not budget.take(m.SysStatus.id, 1)
    budget.grant(m.Heartbeat.id, 3)
    assert not budget.take(m.SysStatus.id, 301)
    assert budget.take(m.SysStatus.id, 300)
    assert not budget.take(m.SysStatus.id, 1)
