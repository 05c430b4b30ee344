"""Conversations by themselves: who is who, and whose frames are known."""

from __future__ import annotations

import pytest

from link.core import Peer, Received
from tests.vehicle.bench import BEAT
from tests.vehicle.conversations import conversation
from vehicle.drive.conversation import (
    FRAMES_BEFORE,
    FRAMES_OF_A_PROGRAM,
    FRAMES_REMEMBERED,
    NEWCOMERS_MAX,
    Conversation,
    FrameMemory,
    Newcomer,
)

DRIVER, TWIN = conversation(255, numbering=1), conversation(255, numbering=2)


def frame(speaker: Conversation, digest: int) -> Received:
    return Received(
        BEAT, speaker.system, speaker.component, 0, speaker.peer, True, numbering=speaker.numbering, digest=digest
    )


def remembering(*digests: int) -> FrameMemory:
    """A memory of these frames of DRIVER."""
    memory = FrameMemory()
    memory.begin(DRIVER)
    for digest in digests:
        memory.record(frame(DRIVER, digest))
    return memory


def test_bounds() -> None:
    assert (FRAMES_REMEMBERED, FRAMES_BEFORE, NEWCOMERS_MAX, FRAMES_OF_A_PROGRAM) == (512, 256, 16, 3)


def test_ids_peer_and_numbering_make_a_conversation() -> None:
    speaker = Conversation(9, 1, Peer(2, "there"), 5)
    assert Conversation.of(frame(speaker, 1)) == speaker
    assert speaker.ids == (9, 1)
    assert speaker.may_ask


class TestMemory:
    def test_a_frame_of_the_driver_is_known_again(self) -> None:
        memory = remembering(1, 2)
        assert memory.is_repeat(frame(TWIN, 1))
        assert memory.is_repeat(frame(DRIVER, 2))
        assert not memory.is_repeat(frame(TWIN, 3))

    def test_a_frame_without_a_digest_is_never_a_repeat(self) -> None:
        assert not remembering(0, 0).is_repeat(frame(TWIN, 0))

    def test_the_newest_frames_are_kept(self) -> None:
        memory = remembering(*range(1, FRAMES_REMEMBERED + 1))
        assert memory.is_repeat(frame(TWIN, 1))
        memory.record(frame(DRIVER, 1))  # again, so it is the newest
        memory.record(frame(DRIVER, 9999))
        assert memory.is_repeat(frame(TWIN, 1))
        assert not memory.is_repeat(frame(TWIN, 2))
        assert memory.is_repeat(frame(TWIN, 3))

    def test_frames_of_other_ids_are_forgotten_with_another_driver(self) -> None:
        memory = remembering(1)
        memory.begin(TWIN)
        assert memory.is_repeat(frame(TWIN, 1))
        memory.begin(conversation(254))
        assert not memory.is_repeat(frame(TWIN, 1))

    def test_what_a_driver_said_before_it_took_control_is_known(self) -> None:
        memory = FrameMemory()
        for digest in range(1, FRAMES_BEFORE + 2):
            memory.note_newcomer(frame(DRIVER, digest), 1.0)
        assert not memory.is_repeat(frame(TWIN, 2))
        memory.begin(DRIVER)
        assert not memory.is_repeat(frame(TWIN, 1))
        assert memory.is_repeat(frame(TWIN, 2))
        assert memory.newcomer(DRIVER) is None


class TestNewcomer:
    @pytest.mark.parametrize(("frames", "is_copy", "program"), [(2, False, False), (3, False, True), (9, True, False)])
    def test_a_program_has_sent_three_frames_one_of_which_is_no_copy(
        self, frames: int, is_copy: bool, program: bool
    ) -> None:
        assert Newcomer(frames, is_copy).is_program is program

    def test_it_is_a_copy_until_it_says_something_else(self) -> None:
        memory = remembering(1, 2, 3)
        for digest in (1, 2, 3):
            newcomer = memory.note_newcomer(frame(TWIN, digest), 1.0)
        assert (newcomer.frames, newcomer.is_copy) == (3, True)
        assert not memory.note_newcomer(frame(TWIN, 4), 1.0).is_copy
        assert not memory.note_newcomer(frame(TWIN, 1), 1.0).is_copy
        assert memory.newcomer(TWIN) is newcomer
        assert memory.newcomer(DRIVER) is None

    def test_of_too_many_the_one_heard_longest_ago_is_forgotten(self) -> None:
        memory = remembering()
        speakers = [conversation(255, numbering=number) for number in range(NEWCOMERS_MAX + 1)]
        for speaker in speakers[:NEWCOMERS_MAX]:
            memory.note_newcomer(frame(speaker, 7), 1.0)
        memory.note_newcomer(frame(speakers[0], 7), 1.0)
        assert all(memory.newcomer(speaker) for speaker in speakers[:NEWCOMERS_MAX])
        memory.note_newcomer(frame(speakers[-1], 7), 1.0)
        assert [speaker.numbering for speaker in speakers if memory.newcomer(speaker) is None] == [1]
