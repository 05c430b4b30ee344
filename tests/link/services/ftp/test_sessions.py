"""MAVLink FTP of the vehicle: repeats have one effect, open files are bounded, writing needs leave."""

from __future__ import annotations

import pytest

from link.services.ftp.files import MemoryFolder, NotYetError, Tree
from link.services.ftp.protocol import MAX_OFFSET, FtpError, FtpPacket, Op
from link.services.ftp.server import FtpServer
from link.services.ftp.sessions import EXPIRY, IDLE, MAX_EACH, MAX_FILE, MAX_SESSIONS
from link.services.pacing import Pacer
from tests.link.ftp_vehicle import GENERAL, LOG, Vehicle, as_entries, error, only_plans
from tests.link.services_world import OTHER_PEER

# ---- repeats ----


def test_74_a_question_said_again_gets_the_stored_answer_and_has_no_second_effect() -> None:
    vehicle = Vehicle()
    remove = FtpPacket(9, Op.REMOVE, data=b"/missions/old.plan")
    first, second = vehicle.send(remove), vehicle.send(remove)
    assert first == second
    assert first[0].op == Op.ACK
    assert vehicle.written == [("old.plan", None)]


def test_the_same_sequence_with_another_question_is_another_question() -> None:
    vehicle = Vehicle()
    vehicle.send(FtpPacket(0, Op.OPEN, data=b"/logs/1.bin"))
    [listed] = vehicle.send(FtpPacket(0, Op.LIST, data=b"/logs"))
    assert as_entries(listed.data)[0].name == "1.bin"


def test_a_stored_answer_ends_with_the_file_that_it_opened() -> None:
    vehicle = Vehicle()
    question = FtpPacket(0, Op.OPEN, data=b"/logs/1.bin")
    vehicle.send(question)
    vehicle.tick(EXPIRY + 1.0)
    vehicle.send(question, EXPIRY + 2.0)
    assert vehicle.ask(Op.READ, size=9, now=EXPIRY + 3.0).data == LOG[:9]


def test_a_refusal_is_thought_over_when_asked_again() -> None:
    vehicle = Vehicle()
    for session in range(MAX_EACH):
        vehicle.ask(Op.OPEN, b"/logs/1.bin", session=session)
    question = FtpPacket(500, Op.OPEN, 99, b"/logs/1.bin")
    assert [error(each) for each in vehicle.send(question)] == [FtpError.NO_SESSIONS]
    vehicle.ask(Op.TERMINATE, session=0)
    assert [each.op for each in vehicle.send(question)] == [Op.ACK]


# ---- sessions ----


def test_clients_have_their_own_sessions() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.OPEN, b"/logs/1.bin", session=0)
    vehicle.ask(Op.OPEN, b"/general.json.xz", session=0, system=254)
    vehicle.ask(Op.OPEN, b"@PARAM/param.pck", session=0, peer=OTHER_PEER)
    assert vehicle.ask(Op.READ, session=0, size=4).data == LOG[:4]
    assert vehicle.ask(Op.READ, session=0, size=4, system=254).data == GENERAL[:4]
    vehicle.ask(Op.RESET, system=254)
    assert vehicle.ask(Op.READ, session=0, size=4).data == LOG[:4]
    assert error(vehicle.ask(Op.READ, session=0, size=4, system=254)) is FtpError.INVALID_SESSION


def test_a_client_that_lost_track_opens_in_place_of_the_old() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.OPEN, b"/logs/1.bin", session=0)
    assert vehicle.ask(Op.OPEN, b"/general.json.xz", session=0).session == 0
    assert vehicle.ask(Op.READ, session=0, size=4).data == GENERAL[:4]


def test_open_files_are_bounded_and_idle_ones_give_way() -> None:
    vehicle = Vehicle()
    for number in range(MAX_SESSIONS):
        opened = vehicle.ask(Op.OPEN, b"/logs/1.bin", session=number % MAX_EACH, system=100 + number // MAX_EACH)
        assert opened.op == Op.ACK
    late = FtpPacket(900, Op.OPEN, 0, b"/logs/1.bin")
    assert [error(each) for each in vehicle.send(late, 1.0, system=50)] == [FtpError.NO_SESSIONS]
    assert [each.op for each in vehicle.send(late, IDLE + 1.0, system=50)] == [Op.ACK]


def test_open_files_are_forgotten() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.OPEN, b"/logs/1.bin")
    vehicle.tick(EXPIRY - 1.0)
    assert vehicle.ask(Op.READ, size=4, now=EXPIRY - 1.0).op == Op.ACK
    vehicle.tick(2 * EXPIRY)
    assert error(vehicle.ask(Op.READ, size=4, now=2 * EXPIRY)) is FtpError.INVALID_SESSION


def test_closing_twice_is_no_error() -> None:
    assert Vehicle().ask(Op.TERMINATE, session=3).op == Op.ACK
    assert Vehicle().ask(Op.RESET).op == Op.ACK


# ---- writing ----


def write(vehicle: Vehicle, path: bytes, *pieces: tuple[int, bytes], op: Op = Op.CREATE) -> FtpPacket:
    opened = vehicle.ask(op, path)
    if opened.op == Op.NAK:
        return opened
    for offset, data in pieces:
        assert vehicle.ask(Op.WRITE, data, offset=offset).op == Op.ACK
    return vehicle.ask(Op.TERMINATE)


def test_a_file_is_written_when_it_is_closed() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.CREATE, b"/missions/new.plan")
    vehicle.ask(Op.WRITE, b"56", offset=6)
    vehicle.ask(Op.WRITE, b"{12345", offset=0)
    assert vehicle.written == []
    assert vehicle.ask(Op.TERMINATE).op == Op.ACK
    assert vehicle.written == [("new.plan", b"{1234556")]
    assert vehicle.stored(b"/missions/new.plan") == b"{1234556"


def test_a_reset_closes_too() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.CREATE, b"/missions/new.plan")
    vehicle.ask(Op.WRITE, b"{}")
    vehicle.ask(Op.RESET)
    assert vehicle.written == [("new.plan", b"{}")]


def test_half_a_file_is_none() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.CREATE, b"/missions/new.plan")
    vehicle.ask(Op.WRITE, b"{}")
    vehicle.tick(EXPIRY + 1.0)
    assert error(vehicle.ask(Op.OPEN, b"/missions/new.plan")) is FtpError.NOT_FOUND
    assert vehicle.written == []


def test_an_old_file_is_changed_in_place_and_cut() -> None:
    vehicle = Vehicle()
    write(vehicle, b"/missions/old.plan", (1, b"NEW"), op=Op.OPEN_TO_WRITE)
    assert vehicle.stored(b"/missions/old.plan") == b"{NEW}"
    assert vehicle.ask(Op.TRUNCATE, b"/missions/old.plan", offset=2).op == Op.ACK
    assert vehicle.stored(b"/missions/old.plan") == b"{N"


@pytest.mark.parametrize("op", [Op.CREATE, Op.OPEN_TO_WRITE, Op.REMOVE, Op.TRUNCATE])
@pytest.mark.parametrize("path", [b"/logs/1.bin", b"/general.json.xz", b"@PARAM/param.pck", b"/new.plan"])
def test_what_is_only_read_is_protected(op: Op, path: bytes) -> None:
    vehicle = Vehicle()
    assert error(vehicle.ask(op, path)) is FtpError.PROTECTED
    assert vehicle.stored(b"/logs/1.bin") == LOG


@pytest.mark.parametrize("op", [Op.CREATE, Op.OPEN_TO_WRITE, Op.REMOVE, Op.TRUNCATE])
def test_only_who_is_in_control_may_write(op: Op) -> None:
    vehicle = Vehicle(allowed=False)
    assert error(vehicle.ask(op, b"/missions/old.plan")) is FtpError.PROTECTED
    assert vehicle.stored(b"/missions/old.plan") == b"{old}"


def test_a_folder_may_refuse_a_name_or_a_content() -> None:
    assert error(write(Vehicle(), b"/missions/evil.sh", (0, b"{"))) is FtpError.PROTECTED
    assert error(write(Vehicle(), b"/missions/bad.plan", (0, b"no plan"))) is FtpError.FAIL


@pytest.mark.parametrize("offset", [MAX_FILE, MAX_FILE - 1, MAX_OFFSET])
def test_a_file_that_is_written_is_bounded(offset: int) -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.CREATE, b"/missions/new.plan")
    assert error(vehicle.ask(Op.WRITE, b"xx", offset=offset)) is FtpError.FAIL


def test_a_file_is_either_read_or_written() -> None:
    vehicle = Vehicle()
    vehicle.ask(Op.OPEN, b"/missions/old.plan")
    assert error(vehicle.ask(Op.WRITE, b"x")) is FtpError.PROTECTED
    vehicle.ask(Op.CREATE, b"/missions/new.plan", session=1)
    assert error(vehicle.ask(Op.READ, session=1, size=9)) is FtpError.INVALID_SESSION


class SlowMissions(MemoryFolder):
    """Written by a disk that is asked `waits` times before it says how that went."""

    waits = 2

    def store(self, name: str, data: bytes) -> FtpError | None:
        if self.waits:
            self.waits -= 1
            raise NotYetError
        return super().store(name, data)


@pytest.mark.parametrize("op", [Op.TERMINATE, Op.RESET])
@pytest.mark.parametrize(("data", "answer"), [(b"{new}", None), (b"rubbish", FtpError.FAIL)])
def test_closing_what_was_written_waits_for_the_disk_and_is_said_again(
    op: Op, data: bytes, answer: FtpError | None
) -> None:
    missions = SlowMissions({"old.plan": b"{old}"}, accept=only_plans)
    vehicle = Vehicle()
    vehicle.server = FtpServer(Tree(missions, {}), system=1, component=1, pacer=Pacer(lambda peer: 1e6))
    vehicle.ask(Op.CREATE, b"new.plan")
    vehicle.ask(Op.WRITE, data)
    closing = FtpPacket(vehicle.sequence + 1, op)
    assert vehicle.send(closing) == []
    assert vehicle.send(closing) == []  # said again meanwhile
    (told,) = vehicle.tick(0.1)
    assert told.op == (Op.ACK if answer is None else Op.NAK)
    assert answer is None or error(told) is answer
    assert ("new.plan" in missions.files) is (answer is None)
    assert vehicle.send(closing) == [told]  # the answer was lost
