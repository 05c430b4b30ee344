from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vehicle.sensors.ranging.frames import ld06_packet, ld06_turn
from vehicle.readings import Scan
from vehicle.sensors.ranging.ld06 import FAR, SECTORS, Ld06Parser, crc8


def turn_of(data: bytes) -> Scan:
    """The scan of the turn that ends with `data`: it is known when the next turn begins."""
    scan = Ld06Parser().feed(data + ld06_packet(0.0, [1000] * 12))
    assert scan is not None
    assert len(scan) == SECTORS
    return scan


def test_the_crc_is_that_of_the_manual() -> None:
    packet = bytes.fromhex(
        "542c 6808 ab7e e000 e4 dc00 e2 d900 e5 d500 e3 d300 e4 d000 e9 cd00 e4 ca00 e2 c700 e9 c500 e5 c200 e5 c000 e5"
        "be82 3a1a 50"
    )  # the example of the development manual
    assert crc8(packet[:-1]) == packet[-1]
    parser = Ld06Parser()
    assert parser.feed(packet) is None
    assert parser._nearest == {65: 0.213, 66: 0.199, 67: 0.192}


def test_each_sector_has_its_nearest_point() -> None:
    scan = turn_of(ld06_turn(lambda angle: 1.0 if 88 <= angle <= 92 else 5.0))
    assert scan[18].bearing == pytest.approx(math.pi / 2)
    assert scan[18].distance == 1.0
    assert scan[16].distance == scan[54].distance == 5.0
    assert scan[18].central


def test_a_direction_without_an_echo_is_clear() -> None:
    scan = turn_of(ld06_turn(lambda angle: 0.0 if angle > 180 else 3.0))
    assert scan[10].distance == 3.0
    assert scan[50].is_clear
    assert scan[50].distance == FAR


def test_a_turn_without_any_echo_is_blind() -> None:
    assert all(cone.distance is None for cone in turn_of(ld06_turn(lambda _: 0.0)))


def test_what_was_not_looked_at_is_not_measured() -> None:
    scan = turn_of(ld06_packet(0.0, [2000] * 12) + ld06_packet(300.0, [2000] * 12))
    assert scan[0].distance == 2.0
    assert scan[30].distance is None


def test_noise_and_broken_packets_are_skipped() -> None:
    turn = bytearray(ld06_turn(lambda _: 4.0))
    turn[47 * 3 + 8] ^= 0x40
    scan = turn_of(b"\x54\x2c\x54" + bytes(turn))
    assert {cone.distance for cone in scan} <= {4.0, None}
    assert scan[0].distance == 4.0


@given(st.lists(st.binary(max_size=100)))
def test_any_bytes_keep_the_buffer_short(pieces: list[bytes]) -> None:
    parser = Ld06Parser()
    for piece in pieces:
        parser.feed(piece)
    assert len(parser._buffer) <= 47
