"""What a program keeps of signing for its next run: on the disk, whole, private, and refused if it is damaged."""

from __future__ import annotations

import logging
import os
import stat
from pathlib import Path

import pytest

from link.link_signing import STORE_PERIOD, LinkSigning
from link.signing.memory_file import FILE, MemoryFileError, load_memory, save_memory
from link.signing.signing import SigningMemory
from link.signing.streams import MAX_STREAMS, SignedStream, Span
from link.signing.verifier import Refusal
from tests.link.signing.signed import ARM, DRIVER, NOON, NOW, keep, signed

MEMORY = SigningMemory(
    NOW, {SignedStream(DRIVER.fingerprint, 255, 190, 2): NOW + 5}, {DRIVER.fingerprint: NOW - 9}, ended=True
)
MANY = ",".join(['["ab",1,1,1,1]'] * (MAX_STREAMS + 1))


def test_what_is_written_is_read(tmp_path: Path) -> None:
    path = tmp_path / "new" / FILE
    assert load_memory(path) == SigningMemory()
    save_memory(path, MEMORY)
    assert load_memory(path) == MEMORY
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert DRIVER.secret.hex() not in path.read_text()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"stamp":-1,"streams":[],"floors":{}}',
        f'{{"stamp":{1 << 48},"streams":[],"floors":{{}}}}',
        '{"stamp":1,"streams":[["ab",1,1,1]],"floors":{}}',
        f'{{"stamp":1,"streams":[{MANY}],"floors":{{}}}}',
        '{"stamp":1,"streams":[["ab",1,1,1,-1]],"floors":{}}',
        '{"stamp":1,"streams":[],"floors":{"ab":-1}}',
        '{"stamp":1,"streams":[],"floors":{},"spans":[["ab",1,-1]]}',
        '{"stamp":1,"streams":[],"floors":{},"spans":[' + ",".join(['["ab",1,1]'] * 17) + "]}",
        '{"stamp":1,"streams":[],"floors":{},"more":1}',
        "\xff",
    ],
)
def test_a_damaged_file_is_named_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / FILE
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(MemoryFileError) as caught:
        load_memory(path)
    assert str(caught.value) == f"{path}: damaged; remove it, once the computer's clock is right"


def test_a_full_file_of_the_last_timestamps_is_read(tmp_path: Path) -> None:
    path, last = tmp_path / FILE, (1 << 48) - 1
    full = SigningMemory(
        last,
        {SignedStream("ab", 1, number, 0): number and last for number in range(64)},
        {"ab": 0},
        (Span("ab", 0, last),) * 16,
    )
    save_memory(path, full)
    assert load_memory(path) == full


def test_a_file_of_an_older_program_is_that_of_a_crash(tmp_path: Path) -> None:
    path = tmp_path / FILE
    path.write_text('{"stamp":5,"streams":[],"floors":{}}')
    assert load_memory(path) == SigningMemory(5, {}, {}, (), ended=False)


def test_a_file_of_64_kib_is_read_and_no_larger_one(tmp_path: Path) -> None:
    path, text = tmp_path / FILE, '{"stamp":5,"streams":[],"floors":{}}'
    path.write_text(text.rjust(65536))
    assert load_memory(path).stamp == 5
    path.write_text(text.rjust(65537))
    with pytest.raises(MemoryFileError):
        load_memory(path)


def test_its_folder_is_made_for_its_user_alone(tmp_path: Path) -> None:
    path = tmp_path / "new" / "deeper" / FILE
    save_memory(path, MEMORY)
    save_memory(path, MEMORY)
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a file away")
def test_a_file_of_root_belongs_to_the_owner_of_its_folder(tmp_path: Path) -> None:
    os.chown(tmp_path, 12345, 12345)
    save_memory(tmp_path / FILE, MEMORY)
    assert (tmp_path / FILE).stat().st_uid == 12345


def test_a_restart_replays_nothing(tmp_path: Path) -> None:
    path, frame = tmp_path / FILE, signed(ARM)
    for run in range(2):
        link_signing = LinkSigning(keep(DRIVER).ring, path, 0.0, wall=lambda: NOON)
        refused = link_signing.signing.verifier.check(frame, 255, 190, 0.0) is Refusal.REPLAYED
        assert refused is bool(run)
        link_signing.close(1.0)


def test_killed_program_has_stored_at_first_frame_and_each_30_s(tmp_path: Path) -> None:
    path = tmp_path / FILE
    link_signing = LinkSigning(keep(DRIVER).ring, path, 0.0, wall=lambda: NOON)
    stored = []
    for now, stamp in ((1.0, NOW), (2.0, NOW + 1), (STORE_PERIOD + 1.0, NOW + 2)):
        link_signing.signing.verifier.check(signed(stamp=stamp), 255, 190, now)
        link_signing.update(now)
        drain(link_signing)
        stored.append(max(load_memory(path).newest.values()))
    assert stored == [NOW, NOW, NOW + 2]


def test_a_disk_that_is_full_is_told_once_and_stops_nothing(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "file").write_text("")
    link_signing = LinkSigning(keep(DRIVER).ring, None, 0.0, wall=lambda: NOON)
    link_signing._path = tmp_path / "file" / FILE
    with caplog.at_level(logging.ERROR):
        link_signing.update(STORE_PERIOD)
        link_signing.update(2 * STORE_PERIOD)
        link_signing.close(2 * STORE_PERIOD)
    assert len(caplog.records) == 1
    assert "after a restart old signed frames may be accepted again" in caplog.text
    assert link_signing.signing.verifier.check(signed(), 255, 190, 61.0)


def drain(link_signing: LinkSigning) -> None:
    """Wait for the writes that were submitted."""
    link_signing._worker.close(5.0)
    link_signing._worker._thread = None


def test_a_file_that_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(MemoryFileError, match="Is a directory; run this as the user whose file this is"):
        load_memory(tmp_path)
