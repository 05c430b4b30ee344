"""A served folder of the disk: its own files, at any time, and nothing beside them; the loop never waits."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import pytest

from link.core import Outgoing
from link.services.ftp.files import Content, DirectoryEntry, FileTree, GeneratedFolder, NotReadyError
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket, parse_packet
from link.services.ftp.server import FtpServer
from link.services.pacing import BulkPacer
from tests.link.services_world import from_gcs, messages
from tests.waits import PATIENCE, wait_until
from vehicle.storage import disk_folder
from vehicle.storage.disk_folder import MAX_ENTRIES, MAX_PENDING, MAX_SIZE, PIECE, DiskFolder

T = TypeVar("T")
DATA = os.urandom(3 * PIECE + 77)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[DiskFolder]:
    place = tmp_path / "logs"
    place.mkdir()
    (place / "1.tlog").write_bytes(DATA)
    (place / "2.tlog").write_bytes(b"")
    served = DiskFolder(place, suffix=".tlog", removable=lambda name: name != "2.tlog")
    yield served
    served.close()


def soon(ask: Callable[[], T]) -> T:
    """The answer, some ticks later."""
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            return ask()
        except NotReadyError:
            assert time.monotonic() < deadline
            threading.Event().wait(0.002)


def here(content: Content, offset: int, size: int) -> bytes:
    """A part of a file, some ticks later."""
    deadline = time.monotonic() + PATIENCE
    while (data := content.read(offset, size)) is None:
        assert time.monotonic() < deadline
        threading.Event().wait(0.002)
    return data


def opened(folder: DiskFolder, name: str) -> Content | None:
    return soon(lambda: folder.open(name, {}))


def whole(content: Content) -> bytes:
    data = b""
    while piece := here(content, len(data), 239):
        data += piece
    return data


def test_files_are_listed_and_read(folder: DiskFolder) -> None:
    with pytest.raises(NotReadyError):
        folder.entries()
    assert soon(folder.entries) == [DirectoryEntry("1.tlog", len(DATA)), DirectoryEntry("2.tlog", 0)]
    content, empty = opened(folder, "1.tlog"), opened(folder, "2.tlog")
    assert content is not None
    assert empty is not None
    assert (content.size, empty.size) == (len(DATA), 0)
    assert whole(content) == DATA
    assert here(content, 5, 10) == DATA[5:15]
    assert here(content, 10, 2 * PIECE) == DATA[10 : 10 + 2 * PIECE]
    assert here(content, len(DATA) - 3, 239) == DATA[-3:]
    assert (content.read(len(DATA), 10), content.read(2**32, 10), empty.read(0, 10)) == (b"", b"", b"")


def test_a_file_that_grows_is_as_long_as_it_was(folder: DiskFolder, tmp_path: Path) -> None:
    before = opened(folder, "1.tlog")
    assert before is not None
    with (tmp_path / "logs/1.tlog").open("ab") as file:
        file.write(b"more")
    assert soon(folder.entries)[0].size == len(DATA) + 4
    assert whole(before) == DATA
    after = opened(folder, "1.tlog")
    assert after is not None
    assert whole(after) == DATA + b"more"


def test_a_file_that_goes_while_it_is_read_ends(folder: DiskFolder, tmp_path: Path) -> None:
    content = opened(folder, "1.tlog")
    assert content is not None
    assert here(content, 0, 10) == DATA[:10]
    (tmp_path / "logs/1.tlog").unlink()
    assert here(content, 2 * PIECE, 10) == b""
    assert soon(folder.entries) == [DirectoryEntry("2.tlog", 0)]


@pytest.mark.parametrize("name", ["link.tlog.tlog", "pipe.tlog", "folder.tlog", "gone.tlog"])
def test_71_what_is_no_file_of_this_folder_is_not_there(folder: DiskFolder, tmp_path: Path, name: str) -> None:
    secret = tmp_path / "secret.tlog"
    secret.write_bytes(b"root:x:0:0")
    place = tmp_path / "logs"
    (place / "link.tlog.tlog").symlink_to(secret)
    os.mkfifo(place / "pipe.tlog")
    (place / "folder.tlog").mkdir()
    (place / "gone.tlog").symlink_to(place / "nothing")
    assert opened(folder, name) is None
    assert soon(lambda: folder.remove(name)) is FtpError.NOT_FOUND
    assert name not in [entry.name for entry in soon(folder.entries)]
    assert secret.exists()


@pytest.mark.parametrize("name", ["../secret.tlog", "/etc/passwd", ".hidden.tlog", "1.txt", "", "a\tb.tlog", "ü.tlog",
                                  "x" * 200 + ".tlog"])  # fmt: skip
def test_other_names_lead_nowhere(folder: DiskFolder, tmp_path: Path, name: str) -> None:
    (tmp_path / "secret.tlog").write_bytes(b"secret")
    assert folder.open(name, {}) is None
    assert folder.remove(name) is FtpError.NOT_FOUND
    assert folder.open("1.tlog", {"start": "0"}) is None


def test_open_file_that_becomes_a_link_or_pipe_is_read_no_more(folder: DiskFolder, tmp_path: Path) -> None:
    log, secret = tmp_path / "logs/1.tlog", tmp_path / "secret"
    secret.write_bytes(b"s" * len(DATA))
    replacements: list[Callable[[], None]] = [lambda: log.symlink_to(secret), lambda: os.mkfifo(log)]
    for replace in replacements:
        content = opened(folder, "1.tlog")
        assert content is not None
        log.unlink()
        replace()
        assert here(content, 0, 10) == b""
        log.unlink()
        log.write_bytes(DATA)


def test_only_what_may_go_is_removed(folder: DiskFolder, tmp_path: Path) -> None:
    assert soon(lambda: folder.remove("1.tlog")) is None
    assert soon(lambda: folder.remove("1.tlog")) is FtpError.NOT_FOUND
    assert soon(lambda: folder.remove("2.tlog")) is FtpError.PROTECTED
    assert soon(folder.entries) == [DirectoryEntry("2.tlog", 0)]
    assert not folder.writable("1.tlog")
    assert folder.store("3.tlog", b"") is FtpError.PROTECTED


def test_all_at_once_but_for_what_must_stay(folder: DiskFolder, tmp_path: Path) -> None:
    (tmp_path / "logs/notes.txt").write_text("mine")
    folder.clear()
    assert soon(folder.entries) == [DirectoryEntry("2.tlog", 0)]
    assert (tmp_path / "logs/notes.txt").exists()


def test_a_folder_that_is_not_there_is_empty(tmp_path: Path) -> None:
    served = DiskFolder(tmp_path / "none", suffix=".tlog", removable=lambda name: True)
    assert soon(served.entries) == []
    assert soon(lambda: served.open("1.tlog", {})) is None
    served.close()


def test_of_very_many_files_the_last_are_listed(folder: DiskFolder, tmp_path: Path) -> None:
    for number in range(MAX_ENTRIES + 5):
        (tmp_path / f"logs/{number:08}.tlog").touch()
    entries = soon(folder.entries)
    assert len(entries) == MAX_ENTRIES
    assert entries[-3].name == f"{MAX_ENTRIES + 4:08}.tlog"


def test_a_disk_that_sleeps_is_asked_only_so_often(folder: DiskFolder) -> None:
    awake = threading.Event()
    folder._worker.submit(lambda: _ignore(awake.wait(PATIENCE)))
    for number in range(200):
        with pytest.raises(NotReadyError):
            folder.open(f"{number}.tlog", {})
    assert len(folder._pending) == MAX_PENDING
    awake.set()
    assert soon(folder.entries)


def test_an_unfetched_answer_does_not_answer_a_later_question(
    folder: DiskFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(NotReadyError):
        folder.entries()
    done = threading.Event()
    folder._worker.submit(done.set)
    assert done.wait(PATIENCE)
    (tmp_path / "logs/3.tlog").touch()
    monkeypatch.setattr(disk_folder, "RESULT_TIMEOUT", 0.0)
    with pytest.raises(NotReadyError):
        folder.entries()
    monkeypatch.undo()
    assert len(soon(folder.entries)) == 3


def _ignore(value: object) -> None:
    del value


# ---- by MAVLink FTP ----


class FolderRig:
    """A file server over the folder; its clock is the test's."""

    def __init__(self, folder: DiskFolder, *, allowed: bool = True) -> None:
        tree = FileTree(GeneratedFolder({}), {"logs": folder})
        pacer = BulkPacer(lambda peer: 1e9)
        self.server = FtpServer(tree, system=1, component=1, pacer=pacer, allowed=lambda received, now: allowed)
        self._sequence = 0

    def ask(self, op: FtpOpcode, data: bytes = b"", *, offset: int = 0, size: int | None = None) -> FtpPacket:
        """Its first answer, some ticks later. The other packets of a burst before it are left out."""
        self._sequence += 7
        packet = FtpPacket(self._sequence, op, 0, data, offset, size=size)
        answers = self._answers(self.server.receive(from_gcs(packet.message(1, 1)), 1.0), op)
        return answers[0] if answers else wait_until(lambda: self._answers(self.server.tick(1.0), op))[0]

    @staticmethod
    def _answers(outgoing: list[Outgoing], op: FtpOpcode) -> list[FtpPacket]:
        """Return the answers to a request with this opcode."""
        packets = [parse_packet(message) for message in messages(outgoing)]
        return [packet for packet in packets if packet.req_opcode == op]


def test_it_is_served_as_every_other_folder(folder: DiskFolder) -> None:
    vehicle = FolderRig(folder)
    assert vehicle.ask(FtpOpcode.LIST, b"/logs").data == b"F1.tlog\t%d\0F2.tlog\t0\0" % len(DATA)
    assert int.from_bytes(vehicle.ask(FtpOpcode.OPEN, b"/logs/1.tlog").data, "little") == len(DATA)
    assert vehicle.ask(FtpOpcode.READ, offset=PIECE - 3, size=10).data == DATA[PIECE - 3 : PIECE + 7]
    assert vehicle.ask(FtpOpcode.BURST, offset=100, size=239).data == DATA[100:339]
    assert vehicle.ask(FtpOpcode.CRC, b"/logs/1.tlog").op == FtpOpcode.ACK
    assert vehicle.ask(FtpOpcode.OPEN, b"/logs/none.tlog").data == bytes([FtpError.NOT_FOUND])
    assert vehicle.ask(FtpOpcode.REMOVE, b"/logs/1.tlog").op == FtpOpcode.ACK
    assert vehicle.ask(FtpOpcode.LIST, b"/logs").data == b"F2.tlog\t0\0"


def test_only_who_may_write_removes(folder: DiskFolder) -> None:
    answer = FolderRig(folder, allowed=False).ask(FtpOpcode.REMOVE, b"/logs/1.tlog")
    assert (answer.op, answer.data) == (FtpOpcode.NAK, bytes([FtpError.PROTECTED]))
    assert len(soon(folder.entries)) == 2


@pytest.mark.parametrize("op", [FtpOpcode.READ, FtpOpcode.BURST])
def test_a_file_that_goes_while_fetched_is_a_failure_not_silence(
    folder: DiskFolder, tmp_path: Path, op: FtpOpcode
) -> None:
    vehicle = FolderRig(folder)
    assert vehicle.ask(FtpOpcode.OPEN, b"/logs/1.tlog").op == FtpOpcode.ACK
    (tmp_path / "logs/1.tlog").unlink()
    answer = vehicle.ask(op, offset=0, size=239)
    assert (answer.op, answer.data, answer.req_opcode) == (FtpOpcode.NAK, bytes([FtpError.FAIL]), op)
    assert vehicle.server.tick(2.0) == []


def test_a_checksum_of_a_file_that_is_cut_meanwhile_is_a_failure(folder: DiskFolder, tmp_path: Path) -> None:
    def cut(name: str, offset: int, size: int, receive: Callable[[bytes], None]) -> bool:
        receive(b"")
        return True

    folder.fetch = cut  # type: ignore[method-assign]
    assert FolderRig(folder).ask(FtpOpcode.CRC, b"/logs/1.tlog").data == bytes([FtpError.FAIL])


def test_disk_that_answers_at_once_does_not_delay_the_next_read(
    folder: DiskFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = opened(folder, "1.tlog")
    assert content is not None

    def at_once(name: str, offset: int, size: int, take: Callable[[bytes], None]) -> bool:
        take(DATA[offset : offset + size])
        return True

    monkeypatch.setattr(folder, "fetch", at_once)
    for offset in (0, PIECE, 2 * PIECE):
        assert content.read(offset, 100) is None
        assert content.read(offset, 100) == DATA[offset : offset + 100]


def test_a_file_too_long_for_the_protocols_is_not_served(folder: DiskFolder, tmp_path: Path) -> None:
    for name, size in (("3.tlog", MAX_SIZE), ("4.tlog", MAX_SIZE + 1)):
        (tmp_path / "logs" / name).touch()
        os.truncate(tmp_path / "logs" / name, size)  # holes: they take no room
    assert [(each.name, each.size) for each in soon(folder.entries)][2:] == [("3.tlog", MAX_SIZE)]
    content = opened(folder, "3.tlog")
    assert content is not None
    assert content.size.to_bytes(4, "little")
    assert opened(folder, "4.tlog") is None
