"""One conversation: who is heard, who is answered, what is counted and what is too much."""

from __future__ import annotations

from fastcrc.crc16 import mcrf4xx
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v10 import ardupilotmega as mavlink

from dialects.messages import (
    Attitude,
    CommandAck,
    CommandLong,
    FileTransferProtocol,
    Heartbeat,
    ManualControl,
    Message,
    Ping,
    RoverStationEvent,
    SetupSigning,
    StatusText,
)
from link.core import Outgoing, Peer, Received
from link.protocol.channel import Channel
from link.protocol.framer import Framer
from link.protocol.log_tap import LogTap
from link.protocol.peer import MAX_SOURCES
from link.protocol.peer_table import MAX_PEERS, PEER_SILENCE, RESERVED_PLACES
from link.protocol.sent_frames import SentFrames
from tests.link.frames import demand, frame, heartbeat, version_1

HERE, THERE = ("127.0.0.1", 5001), ("127.0.0.1", 5002)
ARM = CommandLong(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
DISARM = CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0)


def vehicle(**options: object) -> Channel:
    return Channel("udpin:127.0.0.1:14550", 0, system=1, component=1, **options)  # type: ignore[arg-type]


def sent(channel: Channel, message: Message, **to: object) -> list[tuple[object, int]]:
    outgoing = Outgoing(message, **to)  # type: ignore[arg-type]
    return [(address, sequence) for _, address, sequence in channel.send(outgoing)]


def numbers(received: list[Received]) -> list[int]:
    return [each.sequence for each in received]


# ---- who is heard ----


def test_a_message_tells_who_sent_it() -> None:
    found = vehicle().receive(heartbeat(3), HERE, 0.0)[0]
    assert (found.system, found.component, found.sequence, found.peer.address) == (255, 190, 3, HERE)
    assert found.introduced


def test_a_new_address_introduces_itself_before_it_may_control() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    assert not channel.receive(demand(1), THERE, 0.1)[0].introduced
    channel.receive(heartbeat(2), THERE, 0.2)
    assert channel.receive(demand(3), THERE, 0.3)[0].introduced


def test_a_heartbeat_of_another_system_introduces_only_that_one() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0, system=254), HERE, 0.0)
    assert not channel.receive(demand(1), HERE, 0.1)[0].introduced


def test_system_0_and_our_own_ids_are_dropped() -> None:
    channel = vehicle()
    for system, component in ((0, 190), (0, 0), (1, 1)):
        assert channel.receive(heartbeat(0, system, component), HERE, 0.0) == []
    assert channel.report().own_id
    assert channel.receive(heartbeat(0, system=1, component=2), HERE, 0.0) != []


def test_our_own_frames_that_come_back_are_no_other_system() -> None:
    """A ground station with two endpoints forwards what it gets from one to the other."""
    sent = SentFrames()
    here, there = vehicle(sent=sent), vehicle(sent=sent)
    here.receive(heartbeat(0), HERE, 0.0)
    [(data, _, _)] = here.send(Outgoing(Heartbeat(10, 3, 0, 0, 3, 3)))
    for channel in (here, there):
        assert channel.receive(data, THERE, 0.1) == []
        assert not channel.report().own_id
    other = frame(Heartbeat(10, 3, 0, 0, 4, 3), data[4], system=1, component=1)
    assert there.receive(other, THERE, 0.2) == []
    assert (here.report().own_id, there.report().own_id) == (False, True)


def test_only_wanted_messages_are_decoded() -> None:
    channel = vehicle(wanted=frozenset({Heartbeat.id}))
    assert channel.receive(demand(0), HERE, 0.0) == []
    assert len(channel.receive(heartbeat(1), HERE, 0.0)) == 1
    assert channel.report().frames == 2


# ---- order ----


def test_a_repeated_frame_has_no_second_effect() -> None:
    channel = vehicle()
    assert numbers(channel.receive(demand(5) * 3, HERE, 0.0)) == [5]
    assert channel.report().duplicates == 2


def test_an_overtaken_demand_is_dropped_but_a_command_is_not() -> None:
    channel = vehicle()
    channel.receive(demand(10), HERE, 0.0)
    assert channel.receive(demand(9), HERE, 0.0) == []
    assert numbers(channel.receive(frame(ARM, 12), HERE, 0.0)) == [12]
    assert numbers(channel.receive(frame(DISARM, 11), HERE, 0.0)) == [11]
    assert channel.report().late == 2


def test_a_sender_that_restarts_is_heard_again() -> None:
    channel = vehicle()
    channel.receive(demand(200), HERE, 0.0)
    assert numbers(channel.receive(demand(0), HERE, 0.1)) == [0]  # 56 on: plainly new
    channel.receive(demand(90), HERE, 0.2)
    (found,) = channel.receive(demand(1), HERE, 0.3)
    assert (found.sequence, found.numbering, found.clash) == (1, 2, False)


def test_frames_of_two_programs_in_one_numbering_are_marked() -> None:
    channel = vehicle()
    channel.receive(demand(7), HERE, 0.0)
    (found,) = channel.receive(heartbeat(7), HERE, 0.0)
    assert (found.numbering, found.clash) == (1, True)
    assert found.digest != channel.receive(heartbeat(8), HERE, 0.0)[0].digest


def test_a_stop_is_never_a_repeat() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    assert len(channel.receive(frame(ARM, 5) * 2, HERE, 0.0)) == 1
    assert len(channel.receive(frame(DISARM, 6) * 2, HERE, 0.0)) == 2
    assert channel.report().duplicates == 2


def test_loss_is_counted_by_source() -> None:
    channel = vehicle()
    for number in (0, 1, 4, 5):
        channel.receive(demand(number), HERE, 0.0)
    channel.receive(heartbeat(9, system=254), HERE, 0.0)
    sources = channel.report().sources
    assert (sources[255, 190].received, sources[255, 190].lost) == (4, 2)
    assert (sources[254, 190].received, sources[254, 190].lost) == (1, 0)


@given(st.lists(st.integers(0, 255), max_size=300))
def test_demands_never_go_back_within_a_numbering(order: list[int]) -> None:
    channel = vehicle()
    newest: dict[int, int] = {}
    for now, number in enumerate(order):
        for found in channel.receive(demand(number), HERE, now / 20):
            ahead = (found.sequence - newest.get(found.numbering, found.sequence - 1)) & 0xFF
            assert 0 < ahead < 128  # within one numbering
            newest[found.numbering] = found.sequence


def test_system_is_reported_as_signing_while_its_newest_frame_is() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0, system=7), HERE, 0.0)
    assert channel.report().signing == frozenset()
    body = bytearray(heartbeat(1, system=7)[1:-2])
    body[1] = 1  # incompatibility flag: signed
    signed = b"\xfd" + bytes(body) + mcrf4xx(bytes(body) + b"\x32").to_bytes(2, "little") + bytes(13)
    channel.receive(signed, HERE, 0.1)
    channel.receive(heartbeat(0, system=8), THERE, 0.1)
    assert channel.report().signing == {7}
    channel.receive(heartbeat(2, system=7), HERE, 0.2)
    assert channel.report().signing == frozenset()


# ---- who is answered ----


def test_nobody_gets_telemetry_before_a_heartbeat() -> None:
    channel = vehicle()
    channel.receive(demand(0), HERE, 0.0)
    beat = Heartbeat(10, 0, 0, 0, 3, 3)
    assert sent(channel, beat) == []
    channel.receive(heartbeat(1), HERE, 0.0)
    assert sent(channel, beat) == [(HERE, 0)]


def test_an_address_that_the_user_named_is_sent_to_at_once() -> None:
    channel = vehicle(target="udpout:127.0.0.1:14550")
    assert sent(channel, Heartbeat(10, 0, 0, 0, 3, 3)) == [("udpout:127.0.0.1:14550", 0)]
    assert sent(channel, CommandAck(400, 0, target_system=255, target_component=190)) != []


def test_each_peer_has_its_own_sequence() -> None:
    channel = vehicle()
    one = channel.receive(heartbeat(0), HERE, 0.0)[0].peer
    channel.receive(heartbeat(0, system=254), THERE, 0.0)
    assert sent(channel, CommandAck(400, 0), peer=one) == [(HERE, 0)]
    assert sent(channel, Attitude(1, 0, 0, 0, 0, 0, 0)) == [(HERE, 1), (THERE, 0)]


def test_a_message_for_one_system_goes_where_that_system_is() -> None:
    channel = Channel("udpin:127.0.0.1:14550", 0, system=255, component=190)
    channel.receive(heartbeat(0, system=1, component=1), HERE, 0.0)
    channel.receive(heartbeat(0, system=2, component=1), THERE, 0.0)
    assert sent(channel, ManualControl(target=2, x=0, y=0, z=0, r=0, buttons=0)) == [(THERE, 0)]
    assert sent(channel, ARM) == [(HERE, 0)]


def test_a_note_of_a_log_is_never_sent() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    assert sent(channel, RoverStationEvent(1, 6, 1, 600, 0, b"i")) == []
    assert sent(channel, Heartbeat(10, 0, 0, 0, 3, 3)) == [(HERE, 0)]


def test_a_message_with_a_field_called_id_goes_out_as_what_it_is() -> None:
    channel = vehicle(target="there")
    data, _, _ = next(iter(channel.send(Outgoing(StatusText(severity=4, text=b"hello", id=7)))))
    assert Framer(stream=False).feed(data, 0.0)[0][0] == StatusText.id


def test_a_message_for_some_goes_to_those_alone() -> None:
    channel = vehicle()
    here = channel.receive(heartbeat(0), HERE, 0.0)[0].peer
    channel.receive(heartbeat(0, system=254), THERE, 0.0)
    third = channel.receive(heartbeat(0, system=253), ("127.0.0.1", 5003), 0.0)[0].peer
    elsewhere = here._replace(link=1)
    attitude = Attitude(1, 0, 0, 0, 0, 0, 0)
    assert [address for address, _ in sent(channel, attitude, among=(third, elsewhere, here))] == [third.address, HERE]
    assert sent(channel, attitude, among=()) == []


# ---- conversations ----


def audience(channel: Channel) -> tuple[Peer, ...]:
    return channel.report().audience


def test_the_audience_is_who_sent_a_heartbeat_or_was_named() -> None:
    channel = vehicle(target=THERE)
    assert [peer.address for peer in audience(channel)] == [THERE]
    channel.receive(demand(0), HERE, 0.0)
    assert [peer.address for peer in audience(channel)] == [THERE]
    here = channel.receive(heartbeat(1), HERE, 0.0)[0].peer
    assert audience(channel)[1:] == (here,)
    everybody = [address for address, _ in sent(channel, Attitude(1, 0, 0, 0, 0, 0, 0))]
    assert everybody == [peer.address for peer in audience(channel)]


def test_who_was_silent_for_long_and_is_back_is_another_peer() -> None:
    channel = vehicle()
    first = channel.receive(heartbeat(0), HERE, 0.0)[0].peer
    channel.expire_peers(PEER_SILENCE + 0.1)
    assert audience(channel) == ()
    second = channel.receive(heartbeat(1), HERE, 20.0)[0].peer
    assert second != first
    assert sent(channel, CommandAck(400, 0), peer=first) == [], "an answer to who is gone"
    assert sent(channel, CommandAck(400, 0), peer=second) == [(HERE, 0)]


def test_a_named_address_that_was_silent_long_is_a_new_peer_once() -> None:
    channel = vehicle(target=HERE)
    first = audience(channel)
    channel.expire_peers(100.0)
    assert audience(channel) == first, "nobody has spoken yet"
    channel.receive(heartbeat(0), HERE, 100.0)
    assert audience(channel) == first
    channel.expire_peers(100.0 + PEER_SILENCE + 0.1)
    second = audience(channel)
    assert second != first
    channel.expire_peers(200.0)
    assert audience(channel) == second
    assert channel.receive(demand(1), HERE, 201.0)[0].peer == second[0]


def test_a_connection_that_ends_ends_the_conversation() -> None:
    channel = vehicle(stream=True, target="serial")
    channel.receive(heartbeat(0), "serial", 0.0)
    first = audience(channel)
    channel.handle_disconnect("serial")
    assert [peer.address for peer in audience(channel)] == ["serial"]
    assert audience(channel) != first


def test_a_connection_is_sent_to_before_it_speaks_until_it_ends() -> None:
    channel = vehicle(stream=True)
    assert channel.receive(b"", HERE, 0.0) == []
    [peer] = audience(channel)
    channel.expire_peers(1000.0)
    assert audience(channel) == (peer,), "a program that only listens"
    [question] = channel.receive(demand(0), HERE, 1000.0)
    assert (question.may_ask, question.introduced) == (True, False)
    channel.handle_disconnect(HERE)
    assert audience(channel) == ()


def test_a_datagram_without_anything_in_it_makes_no_peer() -> None:
    channel = vehicle()
    channel.receive(b"", HERE, 0.0)
    assert audience(channel) == ()


def test_a_silent_connection_keeps_no_place_that_another_needs() -> None:
    channel = vehicle(stream=True)
    for port in range(MAX_PEERS):
        channel.receive(b"", ("10.0.0.1", port), 0.001 * port)
    assert channel.receive(heartbeat(0), HERE, 1.0) != []
    assert len(audience(channel)) == MAX_PEERS


# ---- too much ----


def test_the_ids_in_control_get_a_place_when_all_are_taken() -> None:
    channel = vehicle()
    for port in range(MAX_PEERS):
        channel.receive(heartbeat(0, system=100), f"10.0.0.9:{port}", 0.0)
    assert channel.receive(heartbeat(0), HERE, 0.1) == []
    channel.reserve((255, 190))
    (found,) = channel.receive(heartbeat(1), HERE, 0.2)
    assert found.introduced
    assert channel.receive(heartbeat(0, system=100), "10.0.0.9:99", 0.2) == []  # nobody else does
    for port in range(1, RESERVED_PLACES + 2):
        channel.receive(heartbeat(0), f"10.0.0.7:{port}", 0.3)
    assert len(audience(channel)) == MAX_PEERS + RESERVED_PLACES
    channel.reserve(None)
    assert channel.receive(heartbeat(0), "10.0.0.7:99", 0.4) == []


def test_22_peers_are_limited_and_a_real_one_keeps_its_place() -> None:
    channel = vehicle()
    real = channel.receive(heartbeat(0), HERE, 0.0)[0].peer
    for port in range(5000):
        channel.receive(demand(port % 256), ("10.0.0.1", port), 0.001 * port)
    assert len(list(channel._peers)) <= MAX_PEERS
    assert sent(channel, CommandAck(400, 0), peer=real) == [(HERE, 0)]
    assert channel.receive(heartbeat(1), HERE, 5.0) != []


def test_introduced_peers_refuse_the_next_until_one_is_silent() -> None:
    channel = vehicle()
    for port in range(MAX_PEERS + 1):
        channel.receive(heartbeat(0, system=100 + port), ("10.0.0.1", port), 0.0)
    assert channel.report().refused_peers == 1
    assert channel.receive(heartbeat(0), HERE, PEER_SILENCE + 0.1) != []


def test_a_silent_peer_is_forgotten_but_not_its_count() -> None:
    channel = vehicle()
    channel.receive(b"noise" + heartbeat(0), HERE, 0.0)
    channel.receive(b"noise" + heartbeat(1), HERE, 0.0)
    channel.expire_peers(PEER_SILENCE + 0.1)
    report = channel.report()
    assert (report.peers, report.frames, report.resync_bytes) == (0, 2, 10)


def test_a_flood_is_limited_and_a_stop_still_passes() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    flood = [channel.receive(frame(ARM, number % 256), HERE, number / 50_000) for number in range(1, 5001)]
    assert 1 <= sum(map(len, flood)) < 150
    assert channel.report().rate_limited > 4000
    assert len(channel.receive(frame(DISARM, 5001 % 256), HERE, 0.1)) == 1


def test_station_takes_files_faster_than_a_vehicle_but_no_others() -> None:
    piece = FileTransferProtocol(0, 1, 1, bytes(range(251)))
    for options, kind, least, most in (
        ({"downloads": True}, piece, 5000, 5000),
        ({}, piece, 1000, 2300),
        ({"downloads": True}, Ping(0, 1, 1, 1), 1000, 2300),
    ):
        channel = vehicle(**options)
        channel.receive(heartbeat(0), HERE, 0.0)
        taken = [channel.receive(frame(kind, number % 256), HERE, number / 10_000) for number in range(1, 5001)]
        assert least <= sum(map(len, taken)) <= most


def test_script_that_asks_as_fast_as_answered_is_always_answered() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    for number in range(1, 1000):
        assert len(channel.receive(frame(ARM, number % 256), HERE, number * 0.0055)) == 1


def test_a_flood_of_one_peer_leaves_the_others_alone() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    channel.receive(heartbeat(0, system=254), THERE, 0.0)
    for number in range(1, 5001):
        channel.receive(demand(number % 256), HERE, number / 50_000)
    assert len(channel.receive(frame(ARM, 1, system=254), THERE, 0.1)) == 1


def test_noise_makes_no_peer_and_is_counted() -> None:
    channel = vehicle()
    assert channel.receive(b"Init ArduRover V4.7.0-dev\n", HERE, 0.0) == []
    assert channel.report().resync_bytes == 26
    assert not list(channel._peers)


def test_a_foreign_dialect_is_named_after_three_frames() -> None:
    channel = vehicle()
    foreign = bytearray(heartbeat(0))
    foreign[-1] ^= 0x55
    for times in range(3):
        assert channel.report().dialect_mismatch == ()
        channel.receive(bytes(foreign), HERE, float(times))
    assert channel.report().dialect_mismatch == ("HEARTBEAT",)


def test_damage_of_a_known_message_is_no_foreign_dialect() -> None:
    channel = vehicle()
    damaged = bytearray(heartbeat(0))
    damaged[-1] ^= 0x55
    for times in range(3):
        channel.receive(heartbeat(times), HERE, float(times))
        channel.receive(bytes(damaged), HERE, float(times))
    assert channel.report().dialect_mismatch == ()
    channel.expire_peers(100.0)
    assert not list(channel._peers)
    assert channel.report().dialect_mismatch == (), "still known after the sender has gone"


def test_a_stream_gives_up_a_forged_header_while_nothing_arrives() -> None:
    channel = vehicle(stream=True, target="serial")
    channel.receive(heartbeat(0), "serial", 0.0)
    assert channel.receive(bytes([0xFD, 255, 0, 0, 0, 1, 1, 69, 0, 0]) + demand(1), "serial", 0.0) == []
    assert numbers(channel.tick(0.2)) == [1]


# ---- stops ----

HOLD = CommandLong(1, 1, 176, 0, 1, 4, 0, 0, 0, 0, 0)
TERMINATE = CommandLong(1, 1, 185, 0, 1, 0, 0, 0, 0, 0, 0)


def full(**options: object) -> Channel:
    """A channel whose places are all taken by ground stations with a HEARTBEAT, each of another host."""
    channel = vehicle(**options)
    for host in range(MAX_PEERS):
        channel.receive(heartbeat(0), (f"10.1.0.{host}", 14550), 0.0)
    return channel


def test_a_stop_is_handed_on_without_a_place_and_can_be_answered() -> None:
    channel = full()
    for number, stop in enumerate((DISARM, HOLD, TERMINATE)):
        (found,) = channel.receive(frame(stop, number), HERE, 1.0)
        assert isinstance(found.message, CommandLong)
        assert (found.message.command, found.introduced, found.may_ask) == (stop.command, False, False)
        assert sent(channel, CommandAck(stop.command, 0), peer=found.peer) == [(HERE, number)]
    assert HERE not in [peer.address for peer in channel.report().audience]
    assert channel.report().refused_peers == 3


def test_without_a_place_nothing_else_is_handed_on() -> None:
    channel = full()
    assert channel.receive(frame(ARM) + demand(1) + heartbeat(2), HERE, 1.0) == []
    assert channel.receive(frame(DISARM, 3, system=0), HERE, 1.0) == []
    assert channel.receive(frame(DISARM, 4, system=1, component=1), HERE, 1.0) == []
    assert numbers(channel.receive(frame(ARM, 5) + frame(DISARM, 6), HERE, 1.0)) == [6]


def test_there_is_one_place_for_senders_of_stops() -> None:
    channel = full()
    (first,) = channel.receive(frame(DISARM), HERE, 1.0)
    (second,) = channel.receive(frame(DISARM), THERE, 1.0)
    assert sent(channel, CommandAck(400, 0), peer=first.peer) == []
    assert [address for address, _ in sent(channel, CommandAck(400, 0), peer=second.peer)] == [THERE]
    assert len(list(channel._peers)) == MAX_PEERS


def test_a_stop_without_a_place_is_in_the_telemetry_log() -> None:
    recorded: list[bytes] = []
    channel = full()
    channel.log_tap = LogTap(lambda now, frames: recorded.extend(frames), system=1, component=1)
    channel.receive(frame(DISARM, 7), HERE, 1.0)
    assert recorded == [frame(DISARM, 7)]


def test_an_unwanted_stop_is_not_handed_on() -> None:
    assert full(wanted=frozenset({Heartbeat.id})).receive(frame(DISARM), HERE, 1.0) == []


# ---- ends of the tables ----


def test_a_channel_of_datagrams_has_no_partial_frames() -> None:
    channel = vehicle()
    channel.receive(demand(0)[:10], HERE, 0.0)
    assert channel.tick(1.0) == []


def test_a_connection_that_nobody_knew_ends_without_a_trace() -> None:
    channel = vehicle(stream=True)
    channel.handle_disconnect(HERE)
    assert channel.report().peers == 0


def test_of_too_many_sources_at_one_address_no_numbers_are_kept() -> None:
    channel = vehicle()
    for system in range(2, 2 + MAX_SOURCES):
        channel.receive(heartbeat(0, system=system), HERE, 0.0)
    assert len(channel.receive(heartbeat(0, system=200), HERE, 0.1)) == 1
    assert len(channel.receive(heartbeat(0, system=200), HERE, 0.2)) == 1  # not known as a repeat
    assert (200, 190) not in channel.report().sources


def test_addresses_of_a_fleet_are_names() -> None:
    for address, name in (("rover1", "rover1"), ("alice/3f2a", ""), ("[b]", "")):
        channel = Channel("zenoh:x", 0, system=255, component=190, stream=True, named=True)
        assert [each.peer.name for each in channel.receive(heartbeat(0, 1, 1), address, 0.0)] == [name]
    channel = Channel("tcpin:x", 0, system=255, component=190, stream=True)
    assert [each.peer.name for each in channel.receive(heartbeat(0, 1, 1), "rover1", 0.0)] == [""]


# ---- MAVLink 1 ----

MAGIC_V1, MAGIC_V2 = 0xFE, 0xFD


def magics(channel: Channel, message: Message) -> list[int]:
    return [data[0] for data, _, _ in channel.send(Outgoing(message))]


def station_that_heard(*frames: bytes) -> Channel:
    channel = Channel("udpin:127.0.0.1:14550", 0, system=255, component=190)
    for each in frames:
        channel.receive(each, HERE, 0.0)
    return channel


def test_what_speaks_version_1_is_answered_in_it() -> None:
    channel = station_that_heard(version_1(Heartbeat(10, 3, 81, 0, 4, 3), 0, 1, 1))
    [(data, address, sequence)] = channel.send(Outgoing(ARM))
    assert (data[0], address, sequence) == (MAGIC_V1, HERE, 0)
    [found] = mavlink.MAVLink(None).parse_buffer(data) or []
    assert (found.get_type(), found.get_srcSystem(), found.to_dict()["command"]) == ("COMMAND_LONG", 255, 400)
    assert magics(channel, ManualControl(1, 0, 0, 500, 0, 0)) == [MAGIC_V1]
    assert channel.report().version_1 == {1}
    assert channel.speaks_version_1(HERE, 1)
    channel.receive(frame(Heartbeat(10, 3, 81, 0, 4, 3), 1, 1, 1), HERE, 1.0)
    assert not channel.speaks_version_1(HERE, 1)
    assert not channel.speaks_version_1(THERE, 1)


def test_a_heartbeat_goes_in_both_versions_so_that_it_may_change() -> None:
    channel = station_that_heard(version_1(Heartbeat(10, 3, 81, 0, 4, 3), 0, 1, 1))
    assert magics(channel, Heartbeat(6, 8, 0, 0, 4, 3)) == [MAGIC_V2, MAGIC_V1]
    channel.receive(frame(Heartbeat(10, 3, 81, 0, 4, 3), 1, 1, 1), HERE, 1.0)
    assert magics(channel, Heartbeat(6, 8, 0, 0, 4, 3)) == [MAGIC_V2]
    assert magics(channel, ARM) == [MAGIC_V2]
    channel.receive(version_1(Heartbeat(10, 3, 81, 0, 4, 3), 2, 1, 191), HERE, 2.0)  # an old camera beside it
    assert magics(channel, ARM) == [MAGIC_V2]
    assert channel.report().version_1 == set()


def test_two_systems_behind_one_address_get_their_versions() -> None:
    channel = station_that_heard(
        version_1(Heartbeat(10, 3, 81, 0, 4, 3), 0, 1, 1), frame(Heartbeat(10, 3, 81, 0, 4, 3), 0, 2, 1)
    )
    assert magics(channel, ARM) == [MAGIC_V1]
    assert magics(channel, CommandLong(2, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)) == [MAGIC_V2]
    assert magics(channel, StatusText(6, b"all")) == [MAGIC_V2, MAGIC_V1]


def test_what_version_1_cannot_carry_stays_version_2() -> None:
    channel = station_that_heard(version_1(Heartbeat(10, 3, 81, 0, 4, 3), 0, 1, 1))
    assert magics(channel, SetupSigning(1, 1, bytes(32), 0)) == [MAGIC_V2]
