"""What the log tap records, and what it leaves out."""

from __future__ import annotations

from typing import Any

import pytest

from dialects import codec
from dialects import messages as m
from dialects.messages import SetupSigning
from link.protocol.frame import Frame
from link.protocol.log_tap import COPY_WINDOW, MAX_REMEMBERED, LogTap, _Copies
from link.protocol.sent_frames import SentFrames
from tests.link.frames import demand


class Tapped:
    """A log tap and the frames it passes on."""

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.log_tap = LogTap(lambda now, frames: self.frames.extend(frames), system=1, component=1)

    def say(self, message: m.Message) -> None:
        self.log_tap.record_sent(type(message).id, codec.encode_payload(message), 1.0)


def framed(raw: bytes) -> Frame:
    return int.from_bytes(raw[7:10], "little"), raw[5], raw[6], raw[4], raw


def test_keys_are_never_recorded() -> None:
    tapped = Tapped()
    kind: Any = SetupSigning
    setup = kind(1, 1, b"k" * 32, 1)
    key = codec.frame(SetupSigning.id, codec.encode_payload(setup), 7, 255, 190)
    tapped.log_tap.record_received([framed(demand(1)), framed(key), framed(demand(2))], 0, 1.0)
    tapped.say(setup)
    assert tapped.frames == [demand(1), demand(2)]


@pytest.mark.parametrize(
    "bulk", [m.FileTransferProtocol(0, 255, 190, bytes(251)), m.LogData(0, 0, 90, bytes(90)), m.LogEntry(0, 1, 0, 0, 9)]
)
def test_a_log_does_not_grow_by_being_read(bulk: m.Message) -> None:
    tapped = Tapped()
    tapped.say(bulk)
    assert not tapped.frames


def test_notes_in_a_log_come_from_the_program_that_writes_it() -> None:
    tapped = Tapped()
    note = m.RoverStationEvent(12, 6, 0, 0, 0, b"recording begins")
    forged = codec.frame(type(note).id, codec.encode_payload(note), 7, 255, 190)
    tapped.log_tap.record_received([framed(demand(1)), framed(forged)], 0, 1.0)
    tapped.say(note)
    assert [int.from_bytes(raw[7:10], "little") for raw in tapped.frames] == [m.ManualControl.id, type(note).id]


def test_our_own_are_numbered_without_a_gap() -> None:
    tapped = Tapped()
    for number in range(300):
        tapped.say(m.Attitude(number, 0, 0, 0, 0, 0, 0))
    assert [raw[4] for raw in tapped.frames] == [number % 256 for number in range(300)]
    assert {(raw[5], raw[6]) for raw in tapped.frames} == {(1, 1)}


def test_a_frame_that_two_links_bring_is_recorded_once() -> None:
    tapped = Tapped()
    for now, number in enumerate(range(4)):
        tapped.log_tap.record_received([framed(demand(number))], 0, now)
        tapped.log_tap.record_received([framed(demand(number))], 1, now + 0.2)
    assert tapped.frames == [demand(number) for number in range(4)]


def test_a_vehicle_may_number_and_sign_each_link_for_itself() -> None:
    """Messages with its time count once; others, of which two may be alike, each time."""
    tapped = Tapped()
    for number in range(3):
        for message in (m.Attitude(number * 50, 0, 0, 0, 0, 0, 0), m.Heartbeat(0, 10, 3, 81, 4, 3)):
            payload = codec.encode_payload(message)
            first = codec.frame(type(message).id, payload, number, 1, 1)
            second = codec.frame(type(message).id, payload, 90 + number, 1, 1)
            of_another = codec.frame(type(message).id, payload, 90 + number, 2, 1)
            for link, raw in ((0, first), (1, second), (1, of_another), (0, first)):
                tapped.log_tap.record_received([framed(raw)], link, float(number))
    systems = [(int.from_bytes(raw[7:10], "little"), raw[5]) for raw in tapped.frames]
    attitude, heartbeat = m.Attitude.id, m.Heartbeat.id
    assert systems.count((attitude, 1)) == 2 * 3, "the repeat on one link is none of two links"
    assert systems.count((attitude, 2)) == 3
    assert systems.count((heartbeat, 1)) == 3 * 3


def test_repeat_on_one_link_and_late_one_on_another_are_recorded() -> None:
    tapped = Tapped()
    for link, now in ((0, 0.0), (0, 0.1), (1, 0.2), (1, 2 * COPY_WINDOW + 0.3)):
        tapped.log_tap.record_received([framed(demand(1))], link, now)
    assert tapped.frames.count(demand(1)) == 3


def test_the_memory_of_copies_is_bounded() -> None:
    copies = _Copies()
    for number in range(3 * MAX_REMEMBERED):
        copies.is_copy(number.to_bytes(4, "little"), 0, 0.0)
    assert len(copies._links) + len(copies._older) <= 2 * MAX_REMEMBERED


def test_another_programs_frame_is_recorded_but_not_our_echo() -> None:
    sent, frames = SentFrames(), list[bytes]()
    tap = LogTap(lambda now, new: frames.extend(new), system=255, component=190, sent=sent)
    sent.add(demand(1))
    tap.record_received([framed(demand(1)), framed(demand(2))], 0, 1.0)
    assert frames == [demand(2)]
