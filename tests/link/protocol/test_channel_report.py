"""The figures that a channel reports, one by one, and who stays out of them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from fastcrc.crc16 import mcrf4xx

from dialects import codec
from dialects.messages import CommandLong, Heartbeat, ManualControl, StatusText
from link.protocol.channel import Channel
from link.protocol.frame import NOISE_HINT_BYTES, FramerCounts, Header, read_header, sum_counts
from link.protocol.peer import MAX_SOURCES
from link.protocol.peer_table import PEER_SILENCE
from link.protocol.sent_frames import SentFrames
from link.protocol.signing_guard import SigningPolicy
from tests.link.frames import demand, frame, heartbeat, version_1
from tests.link.signing.signed import ARM, DAY, DRIVER, HERE, NOW, STRANGER, THERE, keep, send, signed
from tests.link.signing.signed import vehicle as guarded

GREETS = SigningPolicy(unsigned=None, greets_late=True)
FORGED = bytes([0xFD, 255, 0, 0, 0, 1, 1, 69, 0, 0])
"""A header of a MANUAL_CONTROL that never ends."""


def vehicle(index: int = 0, **options: object) -> Channel:
    return Channel("udpin:127.0.0.1:14550", index, system=1, component=1, **options)  # type: ignore[arg-type]


def unknown(number: int, sequence: int = 0) -> bytes:
    """A frame of a message that is in no dialect of ours."""
    header = bytes([4, 0, 0, sequence, 255, 190]) + number.to_bytes(3, "little") + b"1234"
    return b"\xfd" + header + mcrf4xx(header + b"\x00").to_bytes(2, "little")


# ---- counts ----


def test_a_report_names_its_link_and_counts_peers_and_bytes() -> None:
    channel = vehicle(3)
    assert (channel.report().index, channel.report().bytes_received, channel.report().peers) == (3, 0, 0)
    data = heartbeat(0) + demand(1)
    channel.receive(data, HERE, 0.0)
    channel.receive(demand(0), THERE, 0.0)  # no HEARTBEAT
    report = channel.report()
    assert (report.index, report.bytes_received, report.peers) == (3, len(data + demand(0)), 1)


def test_ids_outside_the_dialect_are_counted_by_source() -> None:
    channel = vehicle(stream=True, target=HERE)
    channel.receive(unknown(55555) + unknown(55556, 1) + unknown(55555, 2) + heartbeat(3), HERE, 0.0)
    report = channel.report()
    assert report.unknown == 3
    assert report.unknown_ids == {(255, 190, 55555): (2, 16), (255, 190, 55556): (1, 16)}


def test_damage_is_counted_frame_by_frame() -> None:
    bad = bytearray(demand(0))
    bad[-1] ^= 1
    channel = vehicle(stream=True, target=HERE)
    channel.receive(bytes(bad) + heartbeat(0) + bytes(bad) + heartbeat(1), HERE, 0.0)
    assert channel.report().crc_errors == 2


def test_counts_of_several_framers_are_summed() -> None:
    one = FramerCounts(frames=1, crc_errors=2, resync_bytes=3, unknown=4, refused=5)
    total = sum_counts([one, one])
    assert (total.frames, total.crc_errors, total.resync_bytes, total.unknown, total.refused) == (2, 4, 6, 8, 10)


def test_each_demand_and_command_over_the_limit_is_counted_once() -> None:
    channel = vehicle()
    passed = sum(len(channel.receive(demand(number), HERE, 0.0)) for number in range(60))
    assert (passed, channel.report().rate_limited) == (50, 10)
    passed = sum(len(channel.receive(frame(ARM, number), THERE, 0.0)) for number in range(104))
    assert (passed, channel.report().rate_limited) == (100, 14)


def test_the_limit_of_all_other_messages() -> None:
    channel = vehicle()
    text = StatusText(6, b"x")
    passed = sum(len(channel.receive(frame(text, number % 256), HERE, 0.0)) for number in range(1010))
    assert (passed, channel.report().rate_limited) == (1000, 10)


@pytest.mark.parametrize(("message", "rate"), [(ManualControl(1, 0, 0, 0, 0, 0), 200), (ARM, 200)])
def test_messages_are_allowed_again_at_their_rate(message: ManualControl | CommandLong, rate: int) -> None:
    channel = vehicle()
    sequences = iter(range(10_000))

    def passed(times: int, now: float) -> int:
        return sum(len(channel.receive(frame(message, next(sequences) % 256), HERE, now)) for _ in range(times))

    passed(150, 0.0)
    assert passed(60, 0.2) == round(rate * 0.2)


# ---- noise, and our own frames ----


def test_frames_outside_the_dialect_are_no_noise() -> None:
    channel = vehicle(stream=True, target=HERE, capacity=5760.0)
    channel.receive(unknown(55555) + heartbeat(1) + b"\x80\xf8" * NOISE_HINT_BYTES, HERE, 0.0)
    report = channel.report()
    assert (report.frames, report.unknown, report.down) == (1, 1, None)


def test_bytes_are_noise_from_the_limit_on() -> None:
    channel = vehicle(stream=True, target=HERE, capacity=5760.0)
    channel.receive(b"\x80" * NOISE_HINT_BYTES, HERE, 0.0)
    assert "wrong baud rate?" in (channel.report().down or "")


def test_a_frame_of_system_0_is_not_ours() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0, system=0), HERE, 0.0)
    assert not channel.report().own_id


def test_another_program_with_our_ids_is_told_from_our_echo() -> None:
    sent = SentFrames()
    channel = vehicle(sent=sent)
    ours = frame(Heartbeat(10, 3, 0, 0, 3, 3), 7, 1, 1)
    sent.add(ours)
    channel.receive(frame(Heartbeat(10, 3, 0, 0, 4, 3), 9, 1, 1) + ours, HERE, 0.0)
    assert channel.report().own_id


# ---- places ----


def test_a_channel_has_as_many_places_as_it_is_given() -> None:
    channel = vehicle(places=1)
    assert channel.receive(heartbeat(0), HERE, 0.0) != []
    assert channel.receive(heartbeat(0, system=254), THERE, 0.0) == []


def test_the_place_of_the_longest_silent_peer_is_given_away() -> None:
    channel = vehicle(places=2)
    channel.receive(heartbeat(0, system=10), "old", 0.0)
    channel.receive(heartbeat(0, system=11), "older", -1.0)
    channel.receive(heartbeat(0), HERE, PEER_SILENCE + 1.0)
    assert {each.peer.address for each in channel._peers} == {"old", HERE}


def test_the_address_that_the_user_named_keeps_its_place() -> None:
    channel = vehicle(target="named", places=1)
    assert channel.receive(heartbeat(0), HERE, PEER_SILENCE * 2) == []


def test_a_reopened_connection_goes_on_with_its_numbers() -> None:
    channel = vehicle(stream=True, target="serial")
    assert [raw[4] for raw in send(channel)] == [0]
    channel.handle_disconnect("serial")
    assert [raw[4] for raw in send(channel)] == [1]


def test_a_peer_is_silent_after_more_than_the_limit() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    channel.expire_peers(PEER_SILENCE)
    assert channel.report().peers == 1


def test_a_source_beyond_the_limit_has_no_numbering() -> None:
    channel = vehicle()
    for system in range(2, 2 + MAX_SOURCES):
        channel.receive(heartbeat(0, system=system), HERE, 0.0)
    (found,) = channel.receive(heartbeat(0, system=200), HERE, 0.1)
    assert (found.numbering, found.clash) == (0, False)


def test_a_new_source_has_a_numbering_from_its_first_frame() -> None:
    (found,) = vehicle().receive(heartbeat(0), HERE, 0.0)
    assert (found.numbering, found.clash) == (1, False)


def test_overdue_frames_of_all_connections_are_found() -> None:
    for channel, data in ((vehicle(stream=True), demand(1)), (guarded(keep(DRIVER), stream=True), signed())):
        for address in (HERE, THERE):
            channel.receive(FORGED + data, address, 0.0)
            data = data if data == demand(1) else signed(stamp=NOW + 1, ids=(254, 190))
        assert len(channel.tick(1.0)) == 2


# ---- signing ----


def test_noise_takes_no_place_of_a_channel_that_signs() -> None:
    channel = guarded(keep(DRIVER))
    channel.receive(b"noise", HERE, 0.0)
    channel.receive(signed(key=STRANGER), HERE, 0.0)
    assert not list(channel._peers)


def test_a_system_whose_clock_is_behind_gets_our_frames() -> None:
    channel = guarded(keep(DRIVER), GREETS)
    assert channel.receive(signed(stamp=NOW - DAY), HERE, 0.0) == []
    assert len(send(channel)) == 1
    assert channel.report().peers == 1
    assert [sorted(each.systems) for each in channel._peers] == [[255]]
    channel.receive(signed(stamp=NOW - DAY + 1), HERE, PEER_SILENCE)
    channel.expire_peers(PEER_SILENCE + 1.0)
    assert channel.report().peers == 1, "the same peer, heard again"
    channel.expire_peers(2 * PEER_SILENCE + 1.0)
    assert channel.report().peers == 0


def test_systems_are_verified_while_they_sign_with_a_key_of_ours() -> None:
    signs = guarded(keep(DRIVER))
    signs.receive(signed(), HERE, 0.0)
    assert signs.report().verified == {255}
    knows_no_keys = vehicle()
    knows_no_keys.receive(signed(), HERE, 0.0)
    assert knows_no_keys.report().signing == {255}
    assert not knows_no_keys.report().verified


def test_without_a_guard_nothing_is_signed() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    assert channel.signing_way(HERE, 0.0) is None


# ---- headers ----


def headers() -> Iterator[tuple[bytes, Header]]:
    for number in (0, 69, 0x0103, 0x010203):
        payload = b"" if number > 255 else b"\x01"
        header = bytes([len(payload), 0, 0, 7, 255, 190]) + number.to_bytes(3, "little")
        yield b"\xfd" + header + payload + b"\0\0", Header(number, 255, 190, 7, 12 + len(payload))


@pytest.mark.parametrize(("data", "header"), [*headers()])
def test_a_header_has_ids_of_three_bytes(data: bytes, header: Header) -> None:
    assert read_header(data) == header


def test_the_shortest_frames_have_a_header_and_shorter_ones_none() -> None:
    shortest = b"\xfe\x00\x07\xff\xbe\x00\x00\x00"
    assert read_header(shortest) == Header(0, 255, 190, 7, len(shortest))
    assert read_header(codec.frame(0, b"\x01", 0, 1, 1)[:12]) is not None
    for data in (version_1(Heartbeat(6, 8, 0, 0, 4, 3))[:7], heartbeat(0)[:11]):
        assert read_header(b"longer than it is" + data, 17) is None


# ---- vehicles that are not looked at ----


def test_missing_numbers_are_lost_only_of_system_that_sends_all() -> None:
    channel = Channel("fleet", 0, system=255, component=190, stream=True)

    def lost(first: int, now: float) -> list[int]:
        """Skip a number of two systems; return what each has lost by then."""
        for system in (1, 2):
            channel.receive(heartbeat(first, system, 1) + heartbeat(first + 2, system, 1), f"rover{system}", now)
        return [channel.report().sources[system, 1].lost for system in (1, 2)]

    channel.set_interest(frozenset((1,)), 0.0)
    assert lost(0, 0.0) == [1, 0]
    channel.set_interest(frozenset((2,)), 0.1)
    assert lost(3, 0.1) == [1, 0], "both: what was asked for takes 2 s at most to come"
    assert lost(6, 2.05) == [1, 0]
    assert lost(9, 2.15) == [1, 1]
    channel.set_interest(None, 2.3)
    assert lost(12, 4.35) == [2, 2]
