"""MAVLink FTP of the vehicle: files, listings, checksums and bursts."""

from __future__ import annotations

import pytest

from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket, crc32
from link.services.ftp.server import BURST_LENGTH, BURST_TIME
from link.services.pacing import LOCAL_FILE_RATE
from tests.link.ftp_rig import GENERAL, LOG, MAX_OFFSET, FtpRig, as_entries, error
from tests.link.services_world import PEER

# ---- reading ----


def test_a_file_is_opened_read_and_closed() -> None:
    vehicle = FtpRig()
    opened = vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin", session=7)
    assert (opened.op, opened.session) == (FtpOpcode.ACK, 7)
    assert int.from_bytes(opened.data, "little") == len(LOG)
    piece = vehicle.ask(FtpOpcode.READ, session=7, offset=100, size=50)
    assert (piece.data, piece.offset, piece.size) == (LOG[100:150], 100, 50)
    assert vehicle.ask(FtpOpcode.READ, session=7, offset=len(LOG) - 5, size=239).data == LOG[-5:]
    assert vehicle.ask(FtpOpcode.TERMINATE, session=7).op == FtpOpcode.ACK
    assert error(vehicle.ask(FtpOpcode.READ, session=7, size=50)) is FtpError.INVALID_SESSION


@pytest.mark.parametrize("offset", [len(LOG), len(LOG) + 1, MAX_OFFSET])
@pytest.mark.parametrize("op", [FtpOpcode.READ, FtpOpcode.BURST])
def test_72_behind_the_end_is_the_end(offset: int, op: FtpOpcode) -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    assert error(vehicle.ask(op, offset=offset, size=239)) is FtpError.END_OF_FILE


def test_an_empty_file_has_no_bytes() -> None:
    vehicle = FtpRig()
    assert vehicle.ask(FtpOpcode.OPEN, b"/logs/2.bin").data == bytes(4)
    assert error(vehicle.ask(FtpOpcode.READ, size=10)) is FtpError.END_OF_FILE


@pytest.mark.parametrize("path", [b"@PARAM/param.pck", b"/@PARAM/param.pck", b"@PARAM/param.pck\0"])
def test_made_files_are_made_when_opened(path: bytes) -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, path)
    assert vehicle.ask(FtpOpcode.READ, size=239).data == b"packed[]"


def test_what_stands_behind_the_question_mark_is_for_the_maker() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"@PARAM/param.pck?withdefaults=1&start=3")
    assert vehicle.ask(FtpOpcode.READ, size=239).data == b"packed[('start', '3'), ('withdefaults', '1')]"
    assert error(vehicle.ask(FtpOpcode.OPEN, b"@PARAM/param.pck?withdefaults=x")) is FtpError.NOT_FOUND


def test_the_checksum_is_mavlinks() -> None:
    assert crc32(b"123456789") == 0x2DFD2D88, "CRC-32 begun with 0 and not inverted"
    assert crc32(b"6789", crc32(b"12345")) == crc32(b"123456789")
    assert FtpRig().ask(FtpOpcode.CRC, b"/general.json.xz").data == crc32(GENERAL).to_bytes(4, "little")
    assert error(FtpRig().ask(FtpOpcode.CRC, b"/nothing")) is FtpError.NOT_FOUND


# ---- listings ----


def listing(vehicle: FtpRig, path: bytes) -> list[tuple[str, int | None]]:
    entries: list[tuple[str, int | None]] = []
    while (answer := vehicle.ask(FtpOpcode.LIST, path, offset=len(entries))).op == FtpOpcode.ACK:
        entries += as_entries(answer.data)
    assert error(answer) is FtpError.END_OF_FILE
    return entries


@pytest.mark.parametrize("path", [b"/", b"", b"\0"])
def test_the_root_has_the_folders_and_its_files(path: bytes) -> None:
    assert listing(FtpRig(), path) == [
        ("@PARAM", None),
        ("logs", None),
        ("missions", None),
        ("general.json.xz", len(GENERAL)),
    ]


@pytest.mark.parametrize("path", [b"/logs", b"logs", b"/logs/", b"/logs\0"])
def test_a_folder_has_its_files(path: bytes) -> None:
    assert listing(FtpRig(), path) == [("1.bin", len(LOG)), ("2.bin", 0)]


def test_a_long_listing_comes_in_parts() -> None:
    vehicle = FtpRig(logs={f"{number:05}.bin": b"x" * number for number in range(100)})
    assert listing(vehicle, b"/logs") == [(f"{number:05}.bin", number) for number in range(100)]


@pytest.mark.parametrize("path", [b"/nowhere", b"/general.json.xz", b"/logs/1.bin"])
def test_what_is_no_folder_is_not_found(path: bytes) -> None:
    assert error(FtpRig().ask(FtpOpcode.LIST, path)) is FtpError.NOT_FOUND


# ---- bursts ----


def burst(vehicle: FtpRig, offset: int = 0, size: int = 239, now: float = 1.0) -> list[FtpPacket]:
    """The whole run of answers, in ticks of 20 ms."""
    assert vehicle.send(FtpPacket(1000, FtpOpcode.BURST, 0, b"", offset, size=size), now) == []
    pieces: list[FtpPacket] = []
    for step in range(1, 2000):
        pieces += vehicle.tick(now + step * 0.02)
        if pieces and pieces[-1].burst_complete:
            break
    return pieces


def test_a_burst_brings_the_file_in_order_and_reports_its_end() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    pieces = burst(vehicle)
    assert b"".join(piece.data for piece in pieces) == LOG
    assert [piece.sequence for piece in pieces] == list(range(1001, 1001 + len(pieces)))
    assert [piece.offset for piece in pieces] == [239 * number for number in range(len(pieces))]
    assert [piece.burst_complete for piece in pieces] == [False] * (len(pieces) - 1) + [True]
    assert vehicle.tick(60.0) == []


def test_a_burst_of_small_pieces_from_the_middle() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    pieces = burst(vehicle, offset=10_000, size=80)
    assert {len(piece.data) for piece in pieces} == {80}
    assert b"".join(piece.data for piece in pieces) == LOG[10_000:]


def test_a_burst_ends_for_a_client_that_has_gone() -> None:
    vehicle = FtpRig(logs={"1.bin": bytes(10**6)}, rate=10_000.0)
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    pieces = burst(vehicle)
    assert len(pieces) == BURST_LENGTH
    assert pieces[-1].burst_complete


def test_a_burst_on_a_fast_link_is_longer_but_ends_as_well() -> None:
    vehicle = FtpRig(logs={"1.bin": bytes(10**6)}, rate=LOCAL_FILE_RATE)
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    assert len(burst(vehicle)) == int(LOCAL_FILE_RATE * BURST_TIME / 280)


def test_what_is_read_after_a_burst_was_lost() -> None:
    vehicle = FtpRig()
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    vehicle.ask(FtpOpcode.READ, size=10)
    assert not vehicle.pacer.is_lossy(PEER)
    burst(vehicle)
    vehicle.ask(FtpOpcode.READ, size=10)
    assert vehicle.pacer.is_lossy(PEER)


def test_a_burst_asked_for_again_goes_on_from_there() -> None:
    vehicle = FtpRig(rate=10_000.0)
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    vehicle.send(FtpPacket(1000, FtpOpcode.BURST, 0, size=239), 1.0)
    vehicle.tick(1.02)
    vehicle.send(FtpPacket(1000, FtpOpcode.BURST, 0, b"", 4780, size=239), 1.03)
    [piece, *_] = vehicle.tick(2.0)
    assert (piece.offset, piece.sequence) == (4780, 1001)


def test_a_burst_keeps_to_the_links_pace() -> None:
    vehicle = FtpRig(rate=10_000.0)
    vehicle.ask(FtpOpcode.OPEN, b"/logs/1.bin")
    vehicle.send(FtpPacket(1000, FtpOpcode.BURST, 0, size=239), 1.0)
    pieces = [piece for step in range(50) for piece in vehicle.tick(1.02 + step * 0.02)]
    assert 9_000 <= len(pieces) * (239 + 27) <= 10_500


# ---- a slow disk ----


def test_what_is_not_here_yet_is_answered_later() -> None:
    vehicle = FtpRig(slow=True)
    vehicle.send(FtpPacket(1, FtpOpcode.OPEN, 0, b"/logs/1.bin"))
    assert vehicle.send(FtpPacket(2, FtpOpcode.READ, 0, size=10)) == []
    [piece] = vehicle.tick(0.02)
    assert (piece.sequence, piece.data) == (3, LOG[:10])
    assert vehicle.tick(0.04) == []
    assert b"".join(piece.data for piece in burst(vehicle)) == LOG


def test_a_checksum_of_a_slow_file_takes_ticks() -> None:
    vehicle = FtpRig(slow=True, logs={"1.bin": bytes(200_000)})
    vehicle.send(FtpPacket(1, FtpOpcode.CRC, 0, b"/logs/1.bin"))
    answers = [answer for step in range(20) for answer in vehicle.tick(step * 0.02)]
    assert [answer.data for answer in answers] == [crc32(bytes(200_000)).to_bytes(4, "little")]
