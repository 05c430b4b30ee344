from __future__ import annotations

from link.protocol.sent_frames import FRAMES_MAX, SentFrames


def test_newest_frames_are_remembered_and_the_oldest_forgotten() -> None:
    sent = SentFrames()
    frames = [number.to_bytes(8, "little") for number in range(3 * FRAMES_MAX)]
    for frame in frames:
        sent.add(frame)
    assert [frame in sent for frame in (frames[0], frames[-FRAMES_MAX - 1])] == [False, False]
    assert all(frame in sent for frame in frames[-FRAMES_MAX:])


def test_a_frame_that_is_sent_twice_counts_once() -> None:
    sent = SentFrames()
    for _ in range(2 * FRAMES_MAX):
        sent.add(b"same")
    sent.add(b"other")
    assert b"same" in sent
    assert b"other" in sent
