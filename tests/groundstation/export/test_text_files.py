"""CSV, JSON lines, and a part of a log: what pymavlink's tools read of it, and what no file can hold."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.export.export import ExportChoice
from groundstation.export.exporter import ExportError, NothingToExportError
from groundstation.export.log_time import LogTime
from groundstation.export.text_files import shortest
from link.tlog.tlog import read_records
from tests.groundstation.export.logs import ARDUROVER, BEAT, START, STEP, drive, run, sent, session
from tests.link.routing.test_router import unknown


@pytest.fixture
def log(tmp_path: Path) -> Path:
    (tmp_path / "log.tlog").write_bytes(drive())
    return tmp_path / "log.tlog"


def second(begin: float, end: float) -> ExportChoice:
    return ExportChoice(LogTime(round(begin * 1e6), from_start=True), LogTime(round(end * 1e6), from_start=True))


def test_a_table_for_each_message(log: Path, tmp_path: Path) -> None:
    result = run(log, ("csv", tmp_path / "tables"))
    assert {each.name for each in (tmp_path / "tables").iterdir()} == {
        "HEARTBEAT.csv", "GPS_RAW_INT.csv", "GLOBAL_POSITION_INT.csv", "ATTITUDE.csv", "SCALED_IMU.csv",
        "LOCAL_POSITION_NED.csv", "BATTERY_STATUS.csv", "MANUAL_CONTROL.csv", "STATUSTEXT.csv",
    }  # fmt: skip
    with (tmp_path / "tables" / "BATTERY_STATUS.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 20
    assert rows[3]["time"] == "2026-11-18T11:06:40.300000Z"
    assert (rows[3]["seconds"], rows[3]["system"], rows[3]["component"]) == ("0.300000", "1", "1")
    assert (rows[3]["voltages[0]"], rows[3]["voltages[9]"], rows[3]["current_battery"]) == ("4100", "65535", "1234")
    assert result.written[0].count == len(list(read_records(log.read_bytes())))


def test_one_message_is_one_table(log: Path, tmp_path: Path) -> None:
    run(log, ("csv", tmp_path / "a.csv"), choice=ExportChoice(patterns=("ATTITUDE",)))
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["pitch"] for row in rows] == ["-0.2"] * 20
    with pytest.raises(ExportError, match=r"add --messages NAME, or name a folder"):
        run(log, ("csv", tmp_path / "b.csv"))


def test_objects_have_the_fields_of_mavlink(log: Path, tmp_path: Path) -> None:
    run(log, ("jsonl", tmp_path / "log.jsonl"))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert lines[0] == {
        "time": "2026-11-18T11:06:40.000000Z", "seconds": 0.0, "system": 1, "component": 1, "name": "HEARTBEAT",
        "fields": {"type": 10, "autopilot": 3, "base_mode": 193, "custom_mode": 4, "system_status": 4,
                   "mavlink_version": 3},
    }  # fmt: skip
    text = next(line for line in lines if line["name"] == "STATUSTEXT")
    assert (
        text["fields"]["text"]
        == "<Wheel> & \N{REPLACEMENT CHARACTER}[31mblocked" + "\N{REPLACEMENT CHARACTER} \N{REPLACEMENT CHARACTER}"
    )


def test_numbers_that_json_lacks_are_null_and_csv_says_nan(tmp_path: Path) -> None:
    (tmp_path / "log.tlog").write_bytes(BEAT + sent(1, m.Attitude(1, math.nan, math.inf, 0.1, 0, 0, 0)))
    run(tmp_path / "log.tlog", ("jsonl", tmp_path / "log.jsonl"), ("csv", tmp_path / "tables"))
    fields = json.loads((tmp_path / "log.jsonl").read_text().splitlines()[1])["fields"]
    assert (fields["roll"], fields["pitch"], fields["yaw"]) == (None, None, 0.1)
    row = (tmp_path / "tables" / "ATTITUDE.csv").read_text().splitlines()[1].split(",")
    assert row[5:8] == ["nan", "inf", "0.1"]


@pytest.mark.parametrize("value", [0.1, 1 / 3, 16_777_217.0, 3.4028234663852886e38, 1e-45, -0.0, 123456.789])
def test_a_float_has_the_digits_that_it_needs(value: float) -> None:
    import struct

    single = struct.unpack("<f", struct.pack("<f", value))[0]
    assert struct.pack("<f", shortest(single)) == struct.pack("<f", single)
    assert len(repr(shortest(single))) <= len(repr(single))


def test_a_part_is_a_log_with_the_same_bytes(log: Path, tmp_path: Path) -> None:
    run(log, ("tlog", tmp_path / "part.tlog"), choice=second(0.5, 1.0))
    expected = [each for each in read_records(log.read_bytes()) if 5 <= (each.microseconds - START) // STEP < 10]
    assert list(read_records((tmp_path / "part.tlog").read_bytes())) == expected
    assert len(expected) == 35


def test_unknown_messages_stay_in_a_log_and_are_named_elsewhere(tmp_path: Path) -> None:
    foreign = START.to_bytes(8, "big") + unknown(3)
    (tmp_path / "log.tlog").write_bytes(BEAT + foreign + sent(2, m.Heartbeat(10, 3, 0, 0, 4, 3)))
    whole = run(tmp_path / "log.tlog", ("tlog", tmp_path / "same.tlog"))
    assert whole.whole
    assert (tmp_path / "same.tlog").read_bytes() == (tmp_path / "log.tlog").read_bytes()
    result = run(tmp_path / "log.tlog", ("jsonl", tmp_path / "log.jsonl"))
    assert not result.whole
    assert sum(result.unknown.values()) == 1


def test_what_is_not_there_is_not_written(log: Path, tmp_path: Path) -> None:
    with pytest.raises(NothingToExportError):
        run(log, ("jsonl", tmp_path / "none.jsonl"), ("gpx", tmp_path / "none.gpx"), choice=second(60, 70))
    assert not list(tmp_path.glob("*none*"))
    result = run(log, ("jsonl", tmp_path / "a.jsonl"), ("gpx", tmp_path / "a.gpx"), choice=ExportChoice(system=255))
    assert [each.path for each in result.empty] == [str(tmp_path / "a.gpx")]
    assert {each.name for each in tmp_path.iterdir()} == {"log.tlog", "a.jsonl"}


def test_an_export_that_is_given_up_leaves_nothing(log: Path, tmp_path: Path) -> None:
    from groundstation.export.export import Export, ExportOutput
    from groundstation.export.table import FORMATS

    outputs = [ExportOutput(name, str(tmp_path / f"out.{name}")) for name in FORMATS if name != "csv"]
    steps = Export(str(log), [*outputs, ExportOutput("csv", str(tmp_path / "tables"))], ExportChoice()).steps()
    next(steps)
    assert len(list(tmp_path.iterdir())) == 1 + len(FORMATS)
    steps.close()
    assert [each.name for each in tmp_path.iterdir()] == ["log.tlog"]


@pytest.mark.parametrize("own", [False, True], ids=["ardurover", "own"])
@pytest.mark.parametrize(
    ("tool", "options", "expected"),
    [
        ("mavlogdump", ["--types", "GLOBAL_POSITION_INT"], "GLOBAL_POSITION_INT {"),
        ("mavsummarize", [], "Total distance"),
        ("mavtogpx", ["--type", "GLOBAL_POSITION_INT"], "Created"),
    ],
)
def test_tools_of_pymavlink_read_a_part(
    tool: str, options: list[str], expected: str, own: bool, tmp_path: Path
) -> None:
    (tmp_path / "own.tlog").write_bytes(session())
    log, choice = (tmp_path / "own.tlog", second(1.0, 9.0)) if own else (ARDUROVER, second(20, 90))
    run(log, ("tlog", tmp_path / "part.tlog"), ("jsonl", tmp_path / "part.jsonl"), choice=choice)
    script = Path(sys.executable).with_name(f"{tool}.py")
    command: list[str | Path] = [sys.executable, script, tmp_path / "part.tlog", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=50, check=False)
    assert done.returncode == 0, done.stderr
    assert expected in done.stdout
    places = (tmp_path / "part.jsonl").read_text().count('"GLOBAL_POSITION_INT"')
    if tool == "mavlogdump":
        assert done.stdout.count(expected) == places
    elif tool == "mavtogpx":
        assert (tmp_path / "part.tlog.gpx").read_text().count("<trkpt") == places - 1  # one is before the first fix
