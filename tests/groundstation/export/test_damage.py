"""Damaged logs: every exporter writes what is left, nothing raises, and what is lost is named."""

from __future__ import annotations

import json
import random
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from dialects.codec import frame
from dialects.messages import MESSAGES
from groundstation.export.exporter import ExportError, NothingToExportError
from groundstation.export.table import FORMATS
from link.tlog.tlog import LATEST, encode_record, read_records
from tests.groundstation.export.logs import START, drive, run

LOG = drive()


def export_all(folder: Path, log: bytes) -> bool:
    """Export to all formats and read all files again; return whether the export said that nothing is missing."""
    source = folder / "log.tlog"
    source.write_bytes(log)
    outputs = [(name, folder / ("tables" if name == "csv" else f"out.{name}")) for name in FORMATS]
    before = set(folder.iterdir())
    try:
        result = run(source, *outputs)
    except (ExportError, NothingToExportError):
        assert set(folder.iterdir()) == before
        return False
    written = {each.format: (Path(each.path), each.count) for each in result.written}
    for name in ("gpx", "kml"):
        if name in written:
            ET.parse(written[name][0])
    whole = list(read_records(log))
    assert list(read_records(written["tlog"][0].read_bytes())) == whole
    if "jsonl" in written:
        lines = written["jsonl"][0].read_text().splitlines()
        assert len([json.loads(line) for line in lines]) == written["jsonl"][1] == written["csv"][1]
        with written["mcap"][0].open("rb") as file:
            assert len(list(make_reader(file, validate_crcs=True).iter_messages())) >= len(lines)
    return result.whole


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_any_damage(data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    log = bytearray(LOG)
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(log) - 1))
        log[at : at + data.draw(st.integers(0, 40))] = data.draw(st.binary(max_size=40))
    export_all(tmp_path_factory.mktemp("damaged"), bytes(log))


def test_messages_with_any_payload(tmp_path: Path) -> None:
    """Valid frames, with payloads that no program has sent; some of them, as each costs rosbags 10 ms."""
    chance = random.Random(1)
    frames = [
        frame(number, any_payload(chance, kind.unpacker.size), 0, 1, 1) for number, kind in sorted(MESSAGES.items())
    ]
    log = b"".join(encode_record(START + number, raw) for number, raw in enumerate(frames))
    assert export_all(tmp_path, LOG + log)


def any_payload(chance: random.Random, size: int) -> bytes:
    return chance.choice([chance.randbytes(size), b"\xff" * size, b"\x7f" * size, b"\0"])


def test_wild_times(tmp_path: Path) -> None:
    raw = [each.raw for each in read_records(LOG)]
    times = [START, 0, LATEST, (1 << 64) - 1, START - 10**15, 1, START]
    log = b"".join(encode_record(at, raw[number]) for number, at in enumerate(times))
    assert export_all(tmp_path, log)


def test_what_is_lost_is_named_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "log.tlog").write_bytes(LOG[:500] + b"damaged!" + LOG[500:])
    result = run(tmp_path / "log.tlog", ("jsonl", tmp_path / "out.jsonl"))
    lost = len(LOG) + 8 - sum(8 + len(each.raw) for each in read_records((tmp_path / "log.tlog").read_bytes()))
    assert (result.damaged_parts, result.damaged_bytes) == (1, lost)
    (damage,) = result.damage
    assert damage.offset <= 500 < damage.offset + damage.size
    assert damage.after == 100_000


@pytest.mark.parametrize("content", [b"", b"text of no log\n" * 50, bytes(1000), b"\xfd" * 1000])
def test_a_file_that_is_no_log(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "log.tlog").write_bytes(content)
    with pytest.raises(ExportError, match="this is not a telemetry log"):
        run(tmp_path / "log.tlog", ("jsonl", tmp_path / "out.jsonl"))
