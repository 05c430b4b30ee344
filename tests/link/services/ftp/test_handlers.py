"""MAVLink FTP of the vehicle: every question is answered, and no path, size or word leads where it must not."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket
from tests.examples import examples
from tests.link.ftp_rig import LOG, MAX_OFFSET, FtpRig, error
from tests.link.services_world import PEER, from_gcs
from tests.rows import each_row

# ---- bad questions ----


@each_row("size", [240, 255])
@each_row("op", [FtpOpcode.OPEN, FtpOpcode.READ, FtpOpcode.BURST, FtpOpcode.WRITE, FtpOpcode.LIST])
def test_72_a_size_that_cannot_be_is_refused(size: int, op: FtpOpcode) -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    assert error(vehicle.ask(op, b"A" * 239, size=size)) is FtpError.INVALID_SIZE


@pytest.mark.parametrize("op", [16, 17, 100, 127, 130, 200, 255])
def test_73_unknown_questions_are_unknown(op: int) -> None:
    assert error(FtpRig().ask(op, b"/")) is FtpError.UNKNOWN_COMMAND


@pytest.mark.parametrize("op", [FtpOpcode.READ, FtpOpcode.BURST, FtpOpcode.WRITE])
def test_72_a_session_that_is_not_open(op: FtpOpcode) -> None:
    assert error(FtpRig().ask(op, session=200)) is FtpError.INVALID_SESSION


@pytest.mark.parametrize("op", [FtpOpcode.RENAME, FtpOpcode.MAKE_DIRECTORY, FtpOpcode.REMOVE_DIRECTORY])
def test_the_tree_keeps_its_shape(op: FtpOpcode) -> None:
    assert error(FtpRig().ask(op, b"/missions/new")) is FtpError.PROTECTED


def test_answers_are_never_answered() -> None:
    for op in (FtpOpcode.ACK, FtpOpcode.NAK):
        assert FtpRig().send(FtpPacket(1, op)) == []


def test_what_is_for_others_or_from_strangers_is_not_answered() -> None:
    vehicle = FtpRig()
    question = FtpPacket(1, FtpOpcode.LIST, data=b"/")
    for target in ((2, 1), (0, 0), (1, 42)):
        assert vehicle.server.receive(from_gcs(question.message(*target)), 0.0) == []
    assert vehicle.send(question, introduced=False) == []


@settings(max_examples=examples(300))
@given(st.lists(st.binary(min_size=251, max_size=251), max_size=8))
def test_any_bytes_are_answered_once_and_raise_nothing(payloads: list[bytes]) -> None:
    vehicle = FtpRig()
    for number, payload in enumerate(payloads):
        answers = vehicle.server.receive(from_gcs(m.FileTransferProtocol(0, 1, 1, payload)), number * 1.0)
        vehicle.server.tick(number * 1.0)
        assert len(answers) <= 1


@settings(max_examples=examples(200))
@given(
    st.lists(
        st.builds(
            FtpPacket,
            st.integers(0, 3),
            st.integers(0, 17),
            st.integers(0, 2),
            st.sampled_from([b"/logs/1.bin", b"/missions/a.plan", b"/missions/old.plan", b"{}", b"/"]),
            st.sampled_from([0, 1, 500, MAX_OFFSET]),
            size=st.sampled_from([None, 0, 239, 255]),
        ),
        max_size=30,
    )
)
def test_any_order_of_questions_is_safe_and_writes_only_plans(questions: list[FtpPacket]) -> None:
    vehicle = FtpRig()
    for number, question in enumerate(questions):
        vehicle.send(question, number * 0.5)
        vehicle.tick(number * 0.5)
    assert all(name.endswith(".plan") for name, _ in vehicle.written)
    assert vehicle.stored(b"/logs/1.bin") == LOG


# ---- on the wire ----


def test_answers_go_to_who_asked() -> None:
    vehicle = FtpRig()
    [outgoing] = vehicle.server.receive(from_gcs(FtpPacket(1, FtpOpcode.LIST, data=b"/").message(1, 0)), 0.0)
    message = outgoing.message
    assert isinstance(message, m.FileTransferProtocol)
    assert (message.target_system, message.target_component, outgoing.peer) == (255, 190, PEER)
