"""Downloads, uploads and logs of a vehicle in virtual time, with loss, cut lines and full disks; the files are real."""

from __future__ import annotations

import random
import resource
import signal
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.files import (
    CompareFile,
    EraseLogs,
    GetFile,
    GetLog,
    ListFolder,
    ListLogs,
    PutFile,
    RemoveFile,
)
from groundstation.intents.services import CancelRequest, FetchParams
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm
from groundstation.views.files import FilesRequest, FilesView
from link.services.ftp.protocol import crc32
from tests.fakes.served import FileVehicle
from tests.groundstation.file_cockpit import FileCockpit

DATA = random.Random(3).randbytes(120_000)


def cockpit(*, loss: float = 0.0, rate: float = 50_000.0, autopilot: int = Autopilot.GENERIC) -> FileCockpit:
    vehicle = FileVehicle(rate=rate, autopilot=autopilot)
    vehicle.logs.files = {"1.tlog": DATA[:7000], "2.tlog": DATA, "3.tlog": b""}
    return FileCockpit(vehicle, loss=loss)


def get(number: int, here: Path, path: str = "/logs/2.tlog", name: str = "2.tlog", **changes: bool) -> GetFile:
    return GetFile(request=number, path=path, folder=str(here), name=name, **changes)


def names(here: Path) -> list[str]:
    return sorted(each.name for each in here.iterdir())


def seen(pit: FileCockpit, *folders: str) -> FilesView:
    view = pit.view(FilesRequest(folders))
    assert isinstance(view, FilesView)
    return view


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_a_file_is_downloaded_whole_or_not_at_all(tmp_path: Path, loss: float) -> None:
    pit = cockpit(loss=loss)
    pit.cockpit.do(get(1, tmp_path))
    pit.until(lambda: pit.cockpit.snapshot.transfers)
    assert "2.tlog" not in names(tmp_path)
    holes: set[str] = set()

    def ended() -> bool:
        line = pit.line(1)
        assert line is not None
        holes.update({line.detail} if "hole" in line.detail else ())
        return line.state != "running"

    pit.until(ended)
    line = pit.ended(1)
    assert (line.state, line.service, line.what) == ("accepted", "files", "download /logs/2.tlog")
    assert (tmp_path / "2.tlog").read_bytes() == DATA
    assert bool(holes) is bool(loss)
    assert names(tmp_path) == ["2.tlog"]
    assert pit.cockpit.snapshot.transfers is None


def test_a_lost_link_delays_a_download_and_loses_nothing(tmp_path: Path) -> None:
    pit = cockpit(rate=5000.0)
    pit.cockpit.do(get(1, tmp_path))
    pit.run(8.0)
    kept = (tmp_path / "2.tlog.part").read_bytes()
    assert 10_000 < len(kept) < len(DATA)
    assert DATA.startswith(kept)
    pit.vehicle.cut = True
    pit.run(30.0)
    line = pit.line(1)
    assert line is not None
    assert (line.state, line.waits) == ("running", "waits for the vehicle to be back")
    pit.vehicle.cut = False
    assert pit.ended(1).state == "accepted"
    assert (tmp_path / "2.tlog").read_bytes() == DATA
    reads = pit.vehicle.all(m.FileTransferProtocol)
    assert len(reads) < 900, "what had arrived was not fetched again"


def test_cancelled_download_resumes_and_foreign_start_is_noticed(tmp_path: Path) -> None:
    pit = cockpit(rate=5000.0)
    pit.cockpit.do(get(1, tmp_path))
    pit.run(4.0)
    pit.cockpit.do(CancelRequest(1))
    assert pit.ended(1).state == "cancelled"
    pit.run(0.2)
    part = tmp_path / "2.tlog.part"
    assert DATA.startswith(part.read_bytes())
    assert part.stat().st_size > 5000
    kept = part.stat().st_size
    pit.cockpit.do(get(2, tmp_path))
    pit.run(0.5)
    line = pit.line(2)
    assert line is not None
    assert line.done >= kept
    assert pit.ended(2).state == "accepted"
    part.write_bytes(b"something else" * 500)
    assert pit.end_of(get(3, tmp_path, overwrite=True)).state == "accepted"
    assert (tmp_path / "2.tlog").read_bytes() == DATA


def test_what_cannot_be_written_is_refused_with_the_reason(tmp_path: Path) -> None:
    pit = cockpit()
    (tmp_path / "2.tlog").write_bytes(b"mine")
    assert "exists already" in pit.end_of(get(1, tmp_path)).detail
    for number, name in enumerate(("../2.tlog", "/etc/passwd", "..", "", "a/b", "x\\y"), start=10):
        assert "would leave the folder" in pit.end_of(get(number, tmp_path, name=name)).detail
    for number, name in enumerate((".bashrc", "-rf", "--", ".x.part"), start=20):
        assert "hidden or taken for an option" in pit.end_of(get(number, tmp_path, name=name)).detail
    assert "control characters" in pit.end_of(get(2, tmp_path, name="a\x1b[2J")).detail
    assert "no folder" in pit.end_of(get(3, tmp_path / "missing")).detail
    assert (tmp_path / "2.tlog").read_bytes() == b"mine"
    assert not pit.vehicle.all(m.FileTransferProtocol)
    assert "no such file" in pit.end_of(get(4, tmp_path, path="/logs/9.tlog", name="9.tlog")).detail
    assert names(tmp_path) == ["2.tlog"]


def test_a_full_disk_leaves_nothing_half_written(tmp_path: Path) -> None:
    pit = cockpit()
    full = Path("/dev/full")
    assert full.is_char_device()
    assert "No space left" in pit.end_of(GetFile(request=1, path="/logs/2.tlog", folder="/dev", name="full",
                                                 overwrite=True)).detail  # fmt: skip
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(
        resource.RLIMIT_FSIZE, (50_000, limit[1])
    )  # the kernel refuses larger files, as a full disk does
    try:
        refused = pit.end_of(get(2, tmp_path))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert "File too large" in refused.detail
    assert names(tmp_path) == []


def test_two_downloads_of_one_name_do_not_mix(tmp_path: Path) -> None:
    pit = cockpit(rate=5000.0)
    pit.cockpit.do(get(1, tmp_path), get(2, tmp_path))
    assert "is being downloaded already" in pit.ended(2).detail
    assert pit.ended(1).state == "accepted"


@pytest.mark.parametrize("autopilot", [Autopilot.GENERIC, Autopilot.ARDUPILOT])
def test_logs_come_by_ftp_from_ours_and_by_log_data_from_others(tmp_path: Path, autopilot: int) -> None:
    pit = cockpit(autopilot=autopilot, loss=0.05)
    assert seen(pit).logs is None
    assert pit.end_of(ListLogs(request=1)).state == "accepted"
    rows = seen(pit).logs
    assert rows is not None
    assert [(row.number, row.size, row.begun) for row in rows][:2] == [
        (0, 7000, 1_700_000_000),
        (1, 120_000, 1_700_000_000),
    ]
    line = pit.end_of(GetLog(request=2, log=1, folder=str(tmp_path), name="1-00001.bin"), 120.0)
    assert line.state == "accepted", line
    assert (tmp_path / "1-00001.bin").read_bytes() == DATA
    assert bool(pit.vehicle.all(m.LogRequestData)) is (autopilot == Autopilot.ARDUPILOT)
    assert "no log 9" in pit.end_of(GetLog(request=3, log=9, folder=str(tmp_path), name="x.bin")).detail


def test_all_logs_are_erased_or_the_refusal_is_seen() -> None:
    pit = cockpit()
    pit.end_of(ListLogs(request=1))
    pit.vehicle.erasable = False
    assert "3 logs are still there" in pit.end_of(EraseLogs(request=2)).detail
    pit.vehicle.erasable = True
    assert pit.end_of(EraseLogs(request=3)).state == "accepted"
    assert seen(pit).logs == ()


def test_folders_are_listed_files_uploaded_and_removed(tmp_path: Path) -> None:
    pit = cockpit(loss=0.1)
    assert pit.end_of(ListFolder(request=1, path="/")).state == "accepted"
    (root,) = seen(pit, "/", "/logs").folders
    assert {(row.name, row.size) for row in root.entries} >= {("logs", None), ("scripts", None)}
    mine = tmp_path / "a.lua"
    mine.write_bytes(DATA[:3000])
    assert pit.end_of(PutFile(request=2, path="/scripts/a.lua", file=str(mine))).state == "accepted"
    assert pit.vehicle.scripts.files == {"a.lua": DATA[:3000]}
    assert pit.end_of(RemoveFile(request=3, path="/scripts/a.lua")).state == "accepted"
    assert pit.vehicle.scripts.files == {}
    assert "No such file" in pit.end_of(PutFile(request=4, path="/scripts/b", file=str(tmp_path / "b"))).detail
    assert "protects" in pit.end_of(PutFile(request=5, path="/logs/b", file=str(mine))).detail


def test_a_vehicle_without_a_file_service_still_gives_its_logs(tmp_path: Path) -> None:
    vehicle = FileVehicle(ftp=False, autopilot=Autopilot.ARDUPILOT)
    vehicle.logs.files = {"1.bin": DATA[:9000]}
    pit = FileCockpit(vehicle)
    assert pit.end_of(ListFolder(request=1, path="/")).state == "no answer"
    assert "no answer" in seen(pit, "/").folders[0].problem or "tries" in seen(pit, "/").folders[0].problem
    pit.end_of(ListLogs(request=2))
    assert pit.end_of(GetLog(request=3, log=0, folder=str(tmp_path), name="0.bin")).state == "accepted"
    assert (tmp_path / "0.bin").read_bytes() == DATA[:9000]


def test_on_a_slow_line_transfers_wait_while_the_operator_drives(tmp_path: Path) -> None:
    pit = cockpit(rate=5000.0)
    drive = pit.cockpit
    drive.world.near.channel._capacity = 5760.0  # as of a radio
    drive.do(ReportKeyReleases(), Arm(held=1.0))
    pit.until(lambda: drive.view.armed and drive.operator.gate_open)
    pit.run(1.0)
    drive.do(get(1, tmp_path), FetchParams(2))
    pit.run(3.0)
    asked = len(pit.vehicle.all(m.FileTransferProtocol))
    assert asked
    drive.do(DriveKeyDown(key="i", throttle=1, steering=0))
    pit.until(lambda: drive.demands(drive.now - 0.2)[-1][1] > 0)
    asked = len(pit.vehicle.all(m.FileTransferProtocol)) + len(pit.vehicle.all(m.ParamRequestList))
    pit.run(20.0)
    assert drive.demands(drive.now - 0.2)[-1][1] > 0, "it drives all the time"
    assert len(pit.vehicle.all(m.FileTransferProtocol)) + len(pit.vehicle.all(m.ParamRequestList)) == asked
    line = pit.line(1)
    assert line is not None
    assert (line.state, line.waits) == ("running", "waits: you drive, and the line is slow")
    drive.do(DriveKeyUp(key="i"))
    assert pit.ended(1).state == "accepted"
    assert (tmp_path / "2.tlog").read_bytes() == DATA


def test_on_a_fast_line_they_do_not_wait(tmp_path: Path) -> None:
    pit = cockpit()
    drive = pit.cockpit
    drive.do(ReportKeyReleases(), Arm(held=1.0))
    pit.until(lambda: drive.view.armed and drive.operator.gate_open)
    drive.do(DriveKeyDown(key="i", throttle=1, steering=0))
    pit.until(lambda: drive.demands(drive.now - 0.2)[-1][1] > 0)
    assert pit.end_of(get(1, tmp_path)).state == "accepted"
    assert drive.demands(drive.now - 0.2)[-1][1] > 0


def test_a_file_here_is_compared_with_that_of_the_vehicle(tmp_path: Path) -> None:
    pit = cockpit()
    here = tmp_path / "copy.tlog"

    def compared(number: int, path: str = "/logs/2.tlog") -> tuple[str, str]:
        line = pit.end_of(CompareFile(request=number, path=path, file=str(here)))
        assert (line.service, line.what) == ("files", f"compare {path} with copy.tlog")
        return line.state, line.detail

    assert compared(1) == ("refused", f"{here}: No such file or directory")
    here.write_bytes(DATA)
    assert compared(2) == ("accepted", f"same: CRC {crc32(DATA):08x}")
    here.write_bytes(DATA[:-1] + b"?")
    assert compared(3) == (
        "accepted",
        f"differs: CRC {crc32(DATA):08x} there, {crc32(here.read_bytes()):08x} here",
    )
    assert compared(4, "/logs/9.tlog") == ("refused", "no such file on the vehicle")
    assert pit.vehicle.logs.files["2.tlog"] == DATA, "nothing was changed there"


def test_an_unanswered_comparison_fails_and_can_be_cancelled(tmp_path: Path) -> None:
    pit = FileCockpit(FileVehicle(ftp=False))
    (tmp_path / "a").write_bytes(DATA)
    pit.cockpit.do(CompareFile(request=1, path="/a", file=str(tmp_path / "a")))
    pit.run(5.0)
    pit.cockpit.do(CancelRequest(1))
    assert pit.ended(1).state == "cancelled"
    line = pit.end_of(CompareFile(request=2, path="/a", file=str(tmp_path / "a")))
    assert (line.state, line.detail) == ("no answer", "after 48 tries")
