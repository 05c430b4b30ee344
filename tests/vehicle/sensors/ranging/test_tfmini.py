from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from tests.vehicle.sensors.ranging.frames import tfmini_frame
from vehicle.sensors.ranging.tfmini import BEAM, TfminiParser


def distance_of(*frames: bytes) -> float | None:
    scan = TfminiParser().feed(b"".join(frames))
    assert scan is not None
    [cone] = scan
    return cone.distance


def test_the_newest_frame_counts() -> None:
    assert distance_of(tfmini_frame(123), tfmini_frame(345)) == 3.45


def test_nearer_than_it_measures_is_0_and_farther_is_clear() -> None:
    assert distance_of(tfmini_frame(9)) == 0.0
    assert distance_of(tfmini_frame(1150)) == BEAM.far


def test_a_weak_signal_is_nothing_in_range() -> None:
    assert distance_of(tfmini_frame(65535, strength=20)) == BEAM.far
    assert distance_of(tfmini_frame(0, strength=20)) == BEAM.far


def test_a_dazzled_sensor_does_not_measure() -> None:
    assert distance_of(tfmini_frame(300, strength=0xFFFF)) is None
    assert distance_of(tfmini_frame(65534)) is None
    assert distance_of(tfmini_frame(65532)) is None


def test_frames_are_found_in_pieces_and_noise() -> None:
    parser, stream = TfminiParser(), b"\x59\x00\x59\x59" + tfmini_frame(200) + b"\x59"
    scans = [scan for at in range(len(stream)) if (scan := parser.feed(stream[at : at + 1])) is not None]
    assert [cone.distance for [cone] in scans] == [2.0]
    assert parser.feed(tfmini_frame(150)[:5]) is None
    [cone] = parser.feed(tfmini_frame(150)[5:]) or ()
    assert cone.distance == 1.5


def test_a_frame_with_a_wrong_sum_is_skipped() -> None:
    broken = tfmini_frame(100)[:-1] + b"\x00"
    assert TfminiParser().feed(broken) is None
    assert distance_of(broken, tfmini_frame(222)) == 2.22


@given(st.lists(st.binary(max_size=40)))
def test_any_bytes_keep_the_buffer_short(pieces: list[bytes]) -> None:
    parser = TfminiParser()
    for piece in pieces:
        scan = parser.feed(piece)
        assert scan is None or scan[0].distance is None or 0.0 <= scan[0].distance <= BEAM.far
    assert len(parser._buffer) < 9 + 1
