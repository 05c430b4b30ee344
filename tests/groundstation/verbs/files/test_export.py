"""`mavhelm export`: its arguments, what it prints, its exit codes; no link is opened and no vehicle needed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from link.runtime.install_hint import install_command
from tests.groundstation.export.logs import ARDUROVER, drive
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f.tlog").write_bytes(drive())
    return tmp_path


def export(capsys: pytest.CaptureFixture[str], *arguments: str) -> VerbRun:
    return run_verb(capsys, "export", *arguments)


def test_several_outputs_at_once(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    outputs = ("--mcap", "f.mcap", "--csv", "tables", "--gpx", "f.gpx", "--kml", "f.kml", "--jsonl", "f.jsonl")
    run = export(capsys, "f.tlog", *outputs, "--tlog", "part.tlog", "--from", "+0.5", "--to", "0:01")
    assert (run.code, run.out) == (ExitCode.DONE, "")
    assert "mavhelm: 35 messages in part.tlog\n" in run.err
    assert "mavhelm: 5 points in f.gpx\n" in run.err
    assert {each.name for each in folder.iterdir()} == {
        "f.tlog", "f.mcap", "tables", "f.gpx", "f.kml", "f.jsonl", "part.tlog",
    }  # fmt: skip


def test_json_has_the_files_and_the_losses(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "f.tlog").write_bytes(drive()[:-4])
    run = export(capsys, "f.tlog", "--gpx", "f.gpx", "--json")
    (record,) = run.records
    assert run.code == ExitCode.PARTLY
    assert (record["ok"], record["files"]) == (False, [{"format": "gpx", "file": "f.gpx", "count": 20}])
    assert (record["damaged_parts"], record["damage"][0]["seconds"]) == (1, 1.9)
    assert "1 damaged part of the log, 42 bytes, left out; the first 0:01.9 from the start, at byte" in run.err


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ("f.tlog", "name what to write: --mcap FILE, --csv FILE"),
        ("none.tlog --gpx f.gpx", "none.tlog: no such file"),
        (". --gpx f.gpx", "not a file"),
        ("f.tlog --gpx f.tlog --yes", "f.tlog: this is the log itself"),
        ("f.tlog --gpx a --kml ./a", "a: this is the file of --gpx already"),
        ("f.tlog --gpx there", "there: exists already; --yes overwrites it"),
        ("f.tlog --csv there", "there: this is a file; name a folder for tables"),
        ("f.tlog --csv full", "full: this folder has files; --yes overwrites those of the same name"),
        ("f.tlog --csv no/where", "there is no folder"),
        ("f.tlog --csv a.csv", "one file has one kind of message: add --messages NAME"),
        ("f.tlog --gpx f.gpx --from soon", "'soon' is not a time in a log"),
        ("f.tlog --gpx f.gpx --from 0:02 --to 0:01", "--to is not after --from"),
        ("there --gpx f.gpx", "there: this is not a telemetry log"),
        ("a.ulg --gpx f.gpx", "a.ulg: is a flight log of PX4 (ULog), no telemetry log"),
        ("a.bin --gpx f.gpx", "a.bin: is a flight log of ArduPilot (DataFlash), no telemetry log"),
    ],
)
def test_a_mistake_is_one_line(arguments: str, text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "there").write_text("text")
    (folder / "a.ulg").write_bytes(b"ULog\x01\x12\x35\x01" + bytes(500))
    (folder / "a.bin").write_bytes(b"\xa3\x95\x80\x80" + bytes(500))
    (folder / "full").mkdir()
    (folder / "full" / "a.csv").write_text("")
    run = export(capsys, *arguments.split())
    assert run.code == ExitCode.USAGE
    assert text in run.err
    assert sorted(each.name for each in folder.iterdir()) == ["a.bin", "a.ulg", "f.tlog", "full", "there"]


@pytest.mark.parametrize(
    ("choice", "text"),
    [
        ("--from 5:00", "f.tlog: nothing to export between these times"),
        ("--messages VFR_HUD RC_*", "nothing to export of VFR_HUD or RC_*"),
        ("--system 9", "nothing to export of system 9"),
    ],
)
def test_nothing_there_is_code_7(choice: str, text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = export(capsys, "f.tlog", "--jsonl", "f.jsonl", *choice.split())
    assert (run.code, text in run.err) == (ExitCode.DIFFERS, True)
    assert not (folder / "f.jsonl").exists()


def test_files_are_replaced_when_that_was_said(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "tables").mkdir()
    (folder / "tables" / "mine.txt").write_text("kept")
    (folder / "tables" / "ATTITUDE.csv").write_text("old")
    assert export(capsys, "f.tlog", "--csv", "tables", "--yes").code == ExitCode.DONE
    assert (folder / "tables" / "mine.txt").read_text() == "kept"
    assert (folder / "tables" / "ATTITUDE.csv").read_text().startswith("time,seconds")


def test_unknown_messages_are_named_with_the_remedy(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = export(capsys, str(ARDUROVER), "--jsonl", "f.jsonl", "-q")
    assert run.code == ExitCode.PARTLY
    assert (
        "446 messages of unknown ids left out (152, 163, 164, 165, 173, 178, 194): --dialect FILE.xml names them"
        in run.err
    )


def test_a_dialect_names_all_of_them(folder: Path) -> None:
    """In a process of its own: a dialect stays until its process ends."""
    command = [sys.executable, "-m", "groundstation", "export", str(ARDUROVER), "--mcap", "f.mcap"]
    ended = subprocess.run([*command, "--dialect", "ardupilotmega.xml"], capture_output=True, text=True, timeout=50)
    assert (ended.returncode, ended.stderr) == (0, "mavhelm: 2590 messages in f.mcap\n")


def test_without_the_extra_one_line_says_which(folder: Path) -> None:
    (folder / "mcap.py").write_text("raise ModuleNotFoundError(\"No module named 'mcap'\", name='mcap')")
    code = "import sys; sys.path.insert(0, '.'); from groundstation.cli.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "export", "f.tlog", "--mcap", "f.mcap"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=50)
    expected = f"MCAP needs the package mcap, which is not installed: {install_command('bags')}"
    assert (ended.returncode, ended.stderr) == (2, f"mavhelm: {expected}\n")
