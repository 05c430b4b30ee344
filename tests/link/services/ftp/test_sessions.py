"""MAVLink FTP of the vehicle: repeats have one effect, open files are bounded, writing needs leave."""

from __future__ import annotations

import pytest

from link.services.ftp.files import FileTree, MemoryFolder, NotReadyError
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket
from link.services.ftp.server import FtpServer
from link.services.ftp.sessions import EXPIRY, IDLE_AFTER, MAX_FILE, MAX_SESSIONS, MAX_SESSIONS_PER_CLIENT
from link.services.pacing import BulkPacer
from tests.link.ftp_rig import GENERAL, LOG, MAX_OFFSET, FtpRig, as_entries, error, only_plans
from tests.link.services_world import OTHER_PEER, PEER, from_gcs
from tests.rows import each_row

# ---- repeats ----


def test_74_a_repeated_question_gets_its_stored_answer() -> None:
    vehicle = FtpRig()
    remove = FtpPacket(9, FtpOpcode.REMOVE, data=b"/missions/old.plan")
    first, second = vehicle.send(remove), vehicle.send(remove)
    assert first == second
    assert first[0].op == FtpOpcode.ACK
    assert vehicle.written == [("old.plan", None)]


def test_same_sequence_with_another_question_is_a_new_question() -> None:
    vehicle = FtpRig()
    vehicle.send(FtpPacket(0, FtpOpcode.OPEN, data=b"/logs/1.bin"))
    [listed] = vehicle.send(FtpPacket(0, FtpOpcode.LIST, data=b"/logs"))
    assert as_entries(listed.data)[0].name == "1.bin"


def test_a_stored_answer_ends_with_the_file_that_it_opened() -> None:
    vehicle = FtpRig()
    question = FtpPacket(0, FtpOpcode.OPEN, data=b"/logs/1.bin")
    vehicle.send(question)
    vehicle.tick(EXPIRY + 1.0)
    vehicle.send(question, EXPIRY + 2.0)
    assert vehicle.ask(FtpOpcode.READ, size=9, now=EXPIRY + 3.0).data == LOG[:9]


def test_a_refusal_is_thought_over_when_asked_again() -> None:
    vehicle = FtpRig()
    for session in range(MAX_SESSIONS_PER_CLIENT):
        vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin", session=session)
    question = FtpPacket(500, FtpOpcode.OPEN, 99, b"/logs/1.bin")
    assert [error(each) for each in vehicle.send(question)] == [FtpError.NO_SESSIONS]
    vehicle.ask(FtpOpcode.TERMINATE, session=0)
    assert [each.op for each in vehicle.send(question)] == [FtpOpcode.ACK]


# ---- sessions ----


def test_clients_have_their_own_sessions() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin", session=0)
    vehicle.ask(FtpOpcode.OPEN, b"/general.json.xz", session=0, system=254)
    vehicle.ask(FtpOpcode.OPEN, b"@PARAM/param.pck", session=0, peer=OTHER_PEER)
    assert vehicle.ask(FtpOpcode.READ, session=0, size=4).data == LOG[:4]
    assert vehicle.ask(FtpOpcode.READ, session=0, size=4, system=254).data == GENERAL[:4]
    vehicle.ask(FtpOpcode.RESET, system=254)
    assert vehicle.ask(FtpOpcode.READ, session=0, size=4).data == LOG[:4]
    assert error(vehicle.ask(FtpOpcode.READ, session=0, size=4, system=254)) is FtpError.INVALID_SESSION


def test_a_client_that_lost_track_opens_in_place_of_the_old() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin", session=0)
    assert vehicle.ask(FtpOpcode.OPEN, b"/general.json.xz", session=0).session == 0
    assert vehicle.ask(FtpOpcode.READ, session=0, size=4).data == GENERAL[:4]


def test_open_files_are_bounded_and_idle_ones_give_way() -> None:
    vehicle = FtpRig()
    for number in range(MAX_SESSIONS):
        opened = vehicle.ask(
            FtpOpcode.OPEN,
            b"/logs/1.bin",
            session=number % MAX_SESSIONS_PER_CLIENT,
            system=100 + number // MAX_SESSIONS_PER_CLIENT,
        )
        assert opened.op == FtpOpcode.ACK
    late = FtpPacket(900, FtpOpcode.OPEN, 0, b"/logs/1.bin")
    assert [error(each) for each in vehicle.send(late, 1.0, system=50)] == [FtpError.NO_SESSIONS]
    assert [each.op for each in vehicle.send(late, IDLE_AFTER + 1.0, system=50)] == [FtpOpcode.ACK]


def test_open_files_are_forgotten() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    vehicle.tick(EXPIRY - 1.0)
    assert vehicle.ask(FtpOpcode.READ, size=4, now=EXPIRY - 1.0).op == FtpOpcode.ACK
    vehicle.tick(2 * EXPIRY)
    assert error(vehicle.ask(FtpOpcode.READ, size=4, now=2 * EXPIRY)) is FtpError.INVALID_SESSION


def test_closing_twice_is_no_error() -> None:
    assert FtpRig().ask(FtpOpcode.TERMINATE, session=3).op == FtpOpcode.ACK
    assert FtpRig().ask(FtpOpcode.RESET).op == FtpOpcode.ACK


# ---- writing ----


def write(vehicle: FtpRig, path: bytes, *pieces: tuple[int, bytes], op: FtpOpcode = FtpOpcode.CREATE) -> FtpPacket:
    opened = vehicle.ask(op, path)
    if opened.op == FtpOpcode.NAK:
        return opened
    for offset, data in pieces:
        assert vehicle.ask(FtpOpcode.WRITE, data, offset=offset).op == FtpOpcode.ACK
    return vehicle.ask(FtpOpcode.TERMINATE)


def test_a_file_is_written_when_it_is_closed() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.CREATE, b"/missions/new.plan")
    vehicle.ask(FtpOpcode.WRITE, b"56", offset=6)
    vehicle.ask(FtpOpcode.WRITE, b"{12345", offset=0)
    assert vehicle.written == []
    assert vehicle.ask(FtpOpcode.TERMINATE).op == FtpOpcode.ACK
    assert vehicle.written == [("new.plan", b"{1234556")]
    assert vehicle.stored(b"/missions/new.plan") == b"{1234556"


def test_a_reset_closes_too() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.CREATE, b"/missions/new.plan")
    vehicle.ask(FtpOpcode.WRITE, b"{}")
    vehicle.ask(FtpOpcode.RESET)
    assert vehicle.written == [("new.plan", b"{}")]


def test_half_a_file_is_none() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.CREATE, b"/missions/new.plan")
    vehicle.ask(FtpOpcode.WRITE, b"{}")
    vehicle.tick(EXPIRY + 1.0)
    assert error(vehicle.ask(FtpOpcode.OPEN, b"/missions/new.plan")) is FtpError.NOT_FOUND
    assert vehicle.written == []


def test_an_old_file_is_changed_in_place_and_cut() -> None:
    vehicle = FtpRig()
    write(vehicle, b"/missions/old.plan", (1, b"NEW"), op=FtpOpcode.OPEN_TO_WRITE)
    assert vehicle.stored(b"/missions/old.plan") == b"{NEW}"
    assert vehicle.ask(FtpOpcode.TRUNCATE, b"/missions/old.plan", offset=2).op == FtpOpcode.ACK
    assert vehicle.stored(b"/missions/old.plan") == b"{N"


@each_row("op", [FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE, FtpOpcode.REMOVE, FtpOpcode.TRUNCATE])
@each_row("path", [b"/logs/1.bin", b"/general.json.xz", b"@PARAM/param.pck", b"/new.plan"])
def test_what_is_only_read_is_protected(op: FtpOpcode, path: bytes) -> None:
    vehicle = FtpRig()
    assert error(vehicle.ask(op, path)) is FtpError.PROTECTED
    assert vehicle.stored(b"/logs/1.bin") == LOG


@pytest.mark.parametrize("op", [FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE, FtpOpcode.REMOVE, FtpOpcode.TRUNCATE])
def test_only_who_is_in_control_may_write(op: FtpOpcode) -> None:
    vehicle = FtpRig(allowed=False)
    assert error(vehicle.ask(op, b"/missions/old.plan")) is FtpError.PROTECTED
    assert vehicle.stored(b"/missions/old.plan") == b"{old}"


def test_a_folder_may_refuse_a_name_or_a_content() -> None:
    assert error(write(FtpRig(), b"/missions/evil.sh", (0, b"{"))) is FtpError.PROTECTED
    assert error(write(FtpRig(), b"/missions/bad.plan", (0, b"no plan"))) is FtpError.FAIL


@pytest.mark.parametrize("offset", [MAX_FILE, MAX_FILE - 1, MAX_OFFSET])
def test_a_file_that_is_written_is_bounded(offset: int) -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.CREATE, b"/missions/new.plan")
    assert error(vehicle.ask(FtpOpcode.WRITE, b"xx", offset=offset)) is FtpError.FAIL


def test_a_file_is_either_read_or_written() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/missions/old.plan")
    assert error(vehicle.ask(FtpOpcode.WRITE, b"x")) is FtpError.PROTECTED
    vehicle.ask(FtpOpcode.CREATE, b"/missions/new.plan", session=1)
    assert error(vehicle.ask(FtpOpcode.READ, session=1, size=9)) is FtpError.INVALID_SESSION


class SlowMissions(MemoryFolder):
    """Written by a disk that is asked `waits` times before it says how that went."""

    waits: int = 2

    def store(self, name: str, data: bytes) -> FtpError | None:
        if self.waits:
            self.waits -= 1
            raise NotReadyError
        return super().store(name, data)


@pytest.mark.parametrize("op", [FtpOpcode.TERMINATE, FtpOpcode.RESET])
@pytest.mark.parametrize(("data", "answer"), [(b"{new}", None), (b"rubbish", FtpError.FAIL)])
def test_closing_written_file_waits_for_disk_and_is_said_again(
    op: FtpOpcode, data: bytes, answer: FtpError | None
) -> None:
    missions = SlowMissions({"old.plan": b"{old}"}, accept=only_plans)
    vehicle = FtpRig()
    vehicle.server = FtpServer(FileTree(missions, {}), system=1, component=1, pacer=BulkPacer(lambda peer: 1e6))
    vehicle.ask(FtpOpcode.CREATE, b"new.plan")
    vehicle.ask(FtpOpcode.WRITE, data)
    closing = FtpPacket(vehicle.sequence + 1, op)
    assert vehicle.send(closing) == []
    assert vehicle.send(closing) == []  # said again meanwhile
    (told,) = vehicle.tick(0.1)
    assert told.op == (FtpOpcode.ACK if answer is None else FtpOpcode.NAK)
    assert answer is None or error(told) is answer
    assert ("new.plan" in missions.files) is (answer is None)
    assert vehicle.send(closing) == [told]  # the answer was lost


def test_an_open_file_goes_on_over_another_link_of_its_client() -> None:
    vehicle = FtpRig()
    question = FtpPacket(1, FtpOpcode.OPEN, data=b"/logs/1.bin")
    vehicle.send(question)
    vehicle.sequence = 1
    assert error(vehicle.ask(FtpOpcode.READ, size=9, peer=OTHER_PEER)) is FtpError.INVALID_SESSION  # somebody else
    vehicle.others = [PEER]
    assert vehicle.ask(FtpOpcode.READ, size=9, peer=OTHER_PEER).data == LOG[:9]
    vehicle.others = []
    assert error(vehicle.ask(FtpOpcode.READ, size=9)) is FtpError.INVALID_SESSION  # it has moved
    vehicle.others = [OTHER_PEER]
    burst = FtpPacket(50, FtpOpcode.BURST, data=b"")
    vehicle.send(burst)
    assert {each.peer for each in vehicle.server.tick(0.1)} == {PEER}


def test_an_answer_lost_with_its_link_comes_on_the_other_one() -> None:
    vehicle = FtpRig()
    remove = FtpPacket(9, FtpOpcode.REMOVE, data=b"/missions/old.plan")
    vehicle.send(remove)
    vehicle.others = [PEER]
    [again] = vehicle.server.receive(from_gcs(remove.message(1, 1), peer=OTHER_PEER), 0.2)
    assert again.peer == OTHER_PEER
    assert vehicle.written == [("old.plan", None)]  # it was removed once


def test_a_request_that_waits_is_answered_on_the_newest_link() -> None:
    vehicle = FtpRig(slow=True)
    crc = FtpPacket(9, FtpOpcode.CRC, data=b"/logs/1.bin")
    vehicle.send(crc)
    vehicle.others = [PEER]
    vehicle.server.receive(from_gcs(FtpPacket(9, FtpOpcode.ACK).message(1, 1), peer=OTHER_PEER), 0.1)  # no request
    vehicle.server.receive(from_gcs(crc.message(1, 1), peer=OTHER_PEER), 0.2)
    answers = [each for step in range(1, 200) for each in vehicle.server.tick(0.2 + step / 50)]
    assert {each.peer for each in answers} == {OTHER_PEER}
