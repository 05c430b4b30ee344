"""Recorded pictures are found by their time, also in files that are damaged, cut, missing or still written."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from groundstation.stream.names import find_parts, part_name
from groundstation.stream.recorded_video import RecordedVideo
from groundstation.stream.video_file import HEAD, encode_unit, read_head
from groundstation.stream.video_folder import FREE_SPACE_MIN, VideoFolder
from tests.groundstation.stream.streams import annex_b, unit_of, write_video

BEGIN = 1_764_320_000_000_000
PERIOD = 66_667


def opened(log: Path) -> RecordedVideo:
    video = RecordedVideo(log)
    video.refresh()
    return video


def test_pictures_are_found_by_time(tmp_path: Path) -> None:
    log = tmp_path / "2026-11-28_09-00-00.tlog"
    units = write_video(part_name(log, 1), BEGIN, 40)
    later = write_video(part_name(log, 2), BEGIN + 60_000_000, 20)
    write_video(tmp_path / "2026-11-28_09-00-00-2.h264", BEGIN, 3)  # of another log
    video = opened(log)
    assert len(video) == 60
    assert video.problem == ""
    assert video.find(BEGIN - 1) is None
    assert video.find(BEGIN) == 0
    assert video.find(BEGIN + 20 * PERIOD + 5) == 20
    assert video.find(BEGIN + 30_000_000) == 39
    assert [video.key_before(each) for each in (0, 14, 15, 39, 41)] == [0, 0, 15, 30, 40]
    assert [each.data for each in video.units()] == units + later
    assert [each.key for each in video.units()].count(True) == 5
    assert video.read(20)[HEAD:] == units[20]
    video.close()


def test_a_file_that_grows_is_followed(tmp_path: Path) -> None:
    log = tmp_path / "a.tlog"
    write_video(part_name(log, 1), BEGIN, 4)
    data = part_name(log, 1).read_bytes()
    part_name(log, 1).write_bytes(data[:-10])
    video = opened(log)
    assert len(video) == 3
    assert video.tail > 0
    assert video.problem == ""
    part_name(log, 1).write_bytes(data)
    video.refresh()
    assert (len(video), video.tail) == (4, 0)


@pytest.mark.parametrize("where", range(0, 600, 37))
def test_damage_costs_the_pictures_that_it_hits(tmp_path: Path, where: int) -> None:
    log = tmp_path / "a.tlog"
    units = write_video(part_name(log, 1), BEGIN, 8)
    data = bytearray(part_name(log, 1).read_bytes())
    data[where] ^= 0x55
    part_name(log, 1).write_bytes(data)
    video = opened(log)
    found = [each.data for each in video.units()]
    assert len(units) - 1 <= len(found) < len(units)
    assert set(found) < set(units)
    assert "damaged bytes of a.h264 are left out" in video.problem
    cut = bytes(data[: where + 100]) + bytes(data[where + 300 :])
    part_name(log, 1).write_bytes(cut)
    assert {each.data for each in opened(log).units()} < set(units)


def test_what_is_no_recording_is_said_in_one_line(tmp_path: Path) -> None:
    log = tmp_path / "a.tlog"
    assert opened(log).problem == "no pictures were recorded beside this log: there is no a.h264"
    part_name(log, 1).write_bytes(b"")
    assert opened(log).problem == "a.h264: has no picture that mavhelm recorded"
    part_name(log, 1).write_bytes(os.urandom(100_000) + annex_b(unit_of(1, key=True)) * 50)
    assert opened(log).problem == "a.h264: has no picture that mavhelm recorded"
    lying = encode_unit(BEGIN, b"x", key=True, stamped=True).replace(b"00000001", b"ffffffff", 1)
    part_name(log, 1).write_bytes(lying + bytes(500))
    assert opened(log).problem == "a.h264: has no picture that mavhelm recorded"
    head = read_head(encode_unit(BEGIN, b"x", key=True, stamped=True))
    assert head is not None
    assert (head.time, head.key, head.stamped, head.fits(b"x"), head.fits(b"y")) == (BEGIN, True, True, True, False)


def test_the_folder_is_bounded_and_parts_begin_with_a_key(tmp_path: Path) -> None:
    folder, log = VideoFolder(40_000), tmp_path / "2026-11-28_09-00-00.tlog"
    other = tmp_path / "holiday.h264"
    other.write_bytes(bytes(50_000))
    old = tmp_path / "2025-01-01_00-00-00.h264"
    old.write_bytes(bytes(20_000))
    folder.write(log, b"no key", key=False)
    assert find_parts(log) == []
    for number in range(200):
        key = number % 10 == 0
        data = encode_unit(BEGIN + number * PERIOD, annex_b(unit_of(number, key=key, size=700)), key=key, stamped=True)
        folder.write(log, data, key=key)
        assert sum(each.stat().st_size for each in tmp_path.glob("2*.h264")) <= 40_000 + 10 * 900
    parts = find_parts(log)
    assert not old.exists()
    assert other.exists()
    assert len(parts) >= 2
    assert part_name(log, 1) not in parts  # it was the oldest one
    video = opened(log)
    assert video.problem == ""
    assert video.key_before(0) == 0
    assert video.time(len(video) - 1) == BEGIN + 199 * PERIOD
    folder.write(tmp_path / "2026-11-28_10-00-00.tlog", b"no key", key=False)
    assert folder.path is None, "the next log begins with a key picture, too"


def test_a_full_disk_and_a_removed_file_are_refused(tmp_path: Path) -> None:
    log, room = tmp_path / "a.tlog", FREE_SPACE_MIN
    folder = VideoFolder(40_000, free=lambda _: room)
    folder.write(log, b"data", key=True)
    room = FREE_SPACE_MIN - 1
    folder.close()
    with pytest.raises(OSError, match="MiB free"):
        folder.write(log, b"data", key=True)
    with pytest.raises(OSError, match="No such file"):
        VideoFolder(40_000).write(tmp_path / "gone" / "a.tlog", b"data", key=True)
