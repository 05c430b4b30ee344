"""A recording as a power cut leaves it: it opens, what is lost is named, and the next session records.

What a file system may leave: ext4 with delayed allocation writes blocks in any order, and the length before or after
them, so that the end is missing, or zeros. https://docs.kernel.org/admin-guide/ext4.html (auto_da_alloc, delalloc)
"""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.export.export import Export, ExportChoice, ExportOutput
from groundstation.host.replay_process import ReplayError, open_log
from groundstation.recording.log_folder import MEGABYTE, LogFolder, LogLimits
from groundstation.replay.log_check import LogCheck
from groundstation.replay.log_index import LogIndex
from link.tlog.tlog import read_records
from tests.groundstation.replay.logs import drive_log, indexed

DATA = bytes(drive_log(20).data)
BLOCK = 4096
LAST = len(DATA) // BLOCK * BLOCK
"""Where the last block begins."""

LEFT = {
    "the last block was not written": DATA[:LAST],
    "the last block is zeros": DATA[:LAST] + bytes(len(DATA) - LAST),
    "two blocks are zeros at the end": DATA + bytes(2 * BLOCK),
    "much is zeros at the end": DATA + bytes(300_000),
    "a block in the middle is zeros": DATA[:BLOCK] + bytes(BLOCK) + DATA[2 * BLOCK :],
    "the last block is of another file": DATA[:LAST] + b"\xfd\x09old log \xfe\x00\xfd" * 100,
}


def check(index: LogIndex) -> LogCheck:
    """Return the second pass over a log."""
    passed = LogCheck(index)
    while passed.advance():
        pass
    return passed


@pytest.mark.parametrize("what", LEFT)
def test_what_a_power_cut_leaves_opens_and_names_the_loss(what: str) -> None:
    data = LEFT[what]
    index = indexed(data)
    kept = sum(8 + len(each.raw) for each in read_records(data))
    assert index.frames == len(list(read_records(data)))
    assert kept >= len(DATA) - 2 * BLOCK
    lost = index.damaged + check(index).damaged
    assert lost + index.tail == len(data) - kept
    damage = [each.text.partition(":")[0] for each in index.findings.finder.events if each.kind == "DAMAG"]
    assert damage == ([f"{lost} bytes left out"] if lost else [])
    for event in index.findings.finder.events:
        assert 0 <= event.time <= index.duration


def test_a_cut_at_any_byte_of_the_last_records_loses_one_record() -> None:
    whole = list(read_records(DATA))
    for length in range(len(DATA) - 200, len(DATA)):
        index = indexed(DATA[:length])
        found = list(read_records(DATA[:length]))
        assert found == whole[: len(found)]
        assert index.tail == length - sum(8 + len(each.raw) for each in found) < 300
        assert index.damaged == 0


def test_an_export_of_it_names_the_loss(tmp_path: Path) -> None:
    log, out = tmp_path / "cut.tlog", tmp_path / "whole.tlog"
    log.write_bytes(LEFT["the last block is zeros"])
    export = Export(str(log), [ExportOutput("tlog", str(out))], ExportChoice())
    list(export.steps())
    (damage,) = export.result.damage
    assert log.stat().st_size - out.stat().st_size == export.result.damaged_bytes == damage.size
    assert damage.offset == out.stat().st_size


def test_the_next_session_records_beside_what_is_left(tmp_path: Path) -> None:
    empty, cut = tmp_path / "2026-11-22_14-05-09.tlog", tmp_path / "2026-11-22_14-05-10.tlog"
    empty.write_bytes(b"")
    cut.write_bytes(LEFT["two blocks are zeros at the end"])
    with pytest.raises(ReplayError, match="is empty"):
        open_log(empty)
    assert open_log(cut).size == cut.stat().st_size
    folder = LogFolder(tmp_path, LogLimits(MEGABYTE, 10 * MEGABYTE), clock=lambda: 1_795_356_309.0)
    log = folder.open()
    log.write(DATA)
    log.close()
    assert {each.stat().st_size for each in tmp_path.iterdir()} == {0, len(DATA) + 2 * BLOCK, len(DATA)}
    assert len(list(tmp_path.iterdir())) == 3
