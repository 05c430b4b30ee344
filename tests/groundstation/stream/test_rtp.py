"""Whole units come out of RTP: in any order of packets, and never with a hole."""

from __future__ import annotations

from groundstation.stream.rtp import MAX_UNIT, MAX_WAITING, WAIT, AccessUnit, Depacketizer
from tests.groundstation.stream.streams import annex_b, packets, unit_of


def pictures(count: int, *, first: int = 65_500, size: int = 2500, source: int = 7) -> tuple[list[bytes], list[bytes]]:
    """Return the packets of pictures whose numbers wrap, and their units."""
    sent: list[bytes] = []
    units = []
    for number in range(count):
        nals = unit_of(number, key=number % 5 == 0, size=size)
        units.append(annex_b(nals))
        sent += packets(nals, first + len(sent), 6000 * number, source=source)
    return sent, units


def take_all(depacketizer: Depacketizer, sent: list[bytes], step: float = 0.001) -> list[AccessUnit]:
    return [unit for at, packet in enumerate(sent) for unit in depacketizer.take(packet, at * step)]


def test_units_come_whole_and_keys_are_marked() -> None:
    sent, units = pictures(20)
    found = take_all(Depacketizer(), [b"", b"\x80\xc8" + bytes(20), *sent])
    assert [each.data for each in found] == units  # the first one begins with its parameters
    assert [each.key for each in found] == [number % 5 == 0 for number in range(20)]
    assert [each.follows for each in found] == [False] + [True] * 19
    assert [packet for each in found for packet in each.packets] == sent
    late = take_all(Depacketizer(), sent[4:])
    assert [each.data for each in late] == units[2:]  # of the first one that comes the begin might be missing
    assert not late[0].follows


def test_packets_that_overtake_are_put_in_order() -> None:
    sent, units = pictures(10)
    swapped = sent.copy()
    for at in range(6, len(sent) - 1, 4):
        swapped[at], swapped[at + 1] = swapped[at + 1], swapped[at]
    found = take_all(Depacketizer(), [*swapped[:10], swapped[9], *swapped[10:]])  # one comes twice
    assert [each.data for each in found] == units


def test_a_unit_with_a_hole_is_dropped_and_no_other_one() -> None:
    sent, units = pictures(10)
    ends = [at for at, packet in enumerate(sent) if packet[1] & 0x80]
    for lost in (ends[3], ends[3] - 1, ends[2] + 1):  # its last packet, one in the middle, its first
        found = take_all(Depacketizer(), [each for at, each in enumerate(sent) if at != lost], step=WAIT)
        assert [each.data for each in found] == units[:3] + units[4:]
        assert [each.follows for each in found] == [False, True, True, False, *[True] * 5]
    hole = range(ends[3], ends[3] + 2)  # two in a row: the last of one, the first of the next
    found = take_all(Depacketizer(), [each for at, each in enumerate(sent) if at not in hole], step=WAIT)
    assert [each.data for each in found] == units[:3] + units[5:]
    many, units = pictures(MAX_WAITING)
    found = take_all(Depacketizer(), many[:9] + many[10:], step=0.0)  # as many wait as may, and no time passes
    assert [each.data for each in found] == units[:2] + units[3:]


def test_another_sender_begins_anew() -> None:
    first, units = pictures(4)
    second, others = pictures(4, first=9, source=8)
    again, more = pictures(4, first=30_000)
    found = take_all(Depacketizer(), first + second + again)
    assert [each.data for each in found] == units + others + more
    assert [each.follows for each in found] == [False, True, True, True] * 3


def test_damaged_packets_raise_nothing() -> None:
    sent, _ = pictures(12)
    depacketizer = Depacketizer()
    for at, packet in enumerate(sent):
        for cut in (13, 14, 16, len(packet) // 2):
            list(depacketizer.take(packet[:cut], at * 0.01))
        for change in (0, 1, 12, 13, 15):
            broken = bytearray(packet)
            broken[change % len(broken)] ^= 0xFF >> at % 8
            list(depacketizer.take(bytes(broken), at * 0.01))


def test_what_never_ends_is_not_kept() -> None:
    first = packets(unit_of(0, key=True, size=50), 0, 0)
    opened = [packet[:1] + bytes([packet[1] & 0x7F]) + packet[2:] for packet in first]
    depacketizer, size = Depacketizer(), 60_000
    take_all(depacketizer, opened)
    for number in range(len(opened), 200):
        head = opened[0][:2] + number.to_bytes(2, "big") + opened[0][4:12]
        assert not list(depacketizer.take(head + b"\x41" + bytes(size), 1.0))
    assert sum(len(each) for each in depacketizer._unit._packets + depacketizer._unit._parts) < 2 * MAX_UNIT
