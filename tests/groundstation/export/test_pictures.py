"""Recorded pictures in MCAP: CompressedVideo of Foxglove, read back by the mcap library and by rosbags."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from groundstation.export.export import ExportChoice, ExportResult
from groundstation.export.exporter import ExportError, NothingToExportError
from groundstation.export.log_time import parse_log_time
from groundstation.stream.names import part_name
from tests.groundstation.export.logs import START, drive, run
from tests.groundstation.stream.streams import write_video

PERIOD = 66_667
TOPIC = "/camera"


def exported(folder: Path, choice: ExportChoice | None = None) -> tuple[ExportResult, Path]:
    log = folder / "log.tlog"
    log.write_bytes(drive())
    return run(log, ("mcap", folder / "log.mcap"), choice=choice), folder / "log.mcap"


def pictures_of(path: Path) -> list[tuple[int, bytes, str, str]]:
    """Return time (ns), data, format and frame of the pictures, as rosbags decodes them."""
    with AnyReader([path]) as reader:
        wanted = [each for each in reader.connections if each.topic == TOPIC]
        found = []
        for connection, at, raw in reader.messages(connections=wanted) if wanted else ():
            message: Any = reader.deserialize(raw, connection.msgtype)
            assert message.timestamp.sec * 10**9 + message.timestamp.nanosec == at
            found.append((at, message.data.tobytes(), message.format, message.frame_id))
        return found


def test_each_picture_is_a_message_of_its_time(tmp_path: Path) -> None:
    units = write_video(part_name(tmp_path / "log.tlog", 1), START + 100_000, 25)
    result, path = exported(tmp_path)
    assert result.pictures == 25
    assert result.whole
    assert [each[1:] for each in pictures_of(path)] == [(unit, "h264", "camera") for unit in units]
    assert pictures_of(path)[3][0] == (START + 100_000 + 3 * PERIOD) * 1000
    with path.open("rb") as file:
        [[schema, channel]] = {
            (schema.name, channel.message_encoding)
            for schema, channel, _ in make_reader(file).iter_messages(topics=[TOPIC])
            if schema is not None
        }
    assert (schema, channel) == ("foxglove_msgs/msg/CompressedVideo", "cdr")
    keys = [data for _, data, _, _ in pictures_of(path)][::15]
    assert all(b"\0\0\0\1\x67" in data and b"\0\0\0\1\x65" in data for data in keys), "SPS with each key picture"


def test_a_part_begins_with_a_key_picture(tmp_path: Path) -> None:
    units = write_video(part_name(tmp_path / "log.tlog", 1), START, 60)
    result, path = exported(tmp_path, ExportChoice(parse_log_time("0:00.2"), parse_log_time("0:01.5")))
    assert [each[1] for each in pictures_of(path)] == units[15:23]
    assert result.pictures == 8


def test_pictures_are_left_out_where_other_things_are_chosen(tmp_path: Path) -> None:
    write_video(part_name(tmp_path / "log.tlog", 1), START, 5)
    for choice in (ExportChoice(patterns=("ATTITUDE",)), ExportChoice(system=1)):
        result, path = exported(tmp_path, choice)
        assert result.pictures == 0
        assert pictures_of(path) == []
    result, path = exported(tmp_path, ExportChoice(patterns=("CAMERA",)))
    assert len(pictures_of(path)) == result.written[0].count == 5
    part_name(tmp_path / "log.tlog", 1).unlink()
    with pytest.raises(NothingToExportError):
        exported(tmp_path, ExportChoice(patterns=("CAMERA",)))


def test_damaged_pictures_are_left_out_and_named(tmp_path: Path) -> None:
    video = part_name(tmp_path / "log.tlog", 1)
    units = write_video(video, START, 10)
    data = bytearray(video.read_bytes())
    data[500] ^= 1
    video.write_bytes(data[:-5])
    result, path = exported(tmp_path)
    assert result.pictures == 8
    assert {each[1] for each in pictures_of(path)} < set(units)
    assert result.damaged_pictures > 0
    assert not result.whole
    video.write_bytes(b"no video")
    with pytest.raises(ExportError, match=r"log\.h264: has no picture that mavhelm recorded: remove it, or"):
        exported(tmp_path)
