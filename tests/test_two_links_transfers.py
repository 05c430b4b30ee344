"""Parameters, plans and files in transfer while one of two links is cut: they go on over the other one."""

from __future__ import annotations

from pathlib import Path as FilePath

import pytest

from dialects import messages as m
from dialects.messages import Message
from groundstation.disk.file_jobs import run_job
from groundstation.intents.files import GetFile
from groundstation.intents.plan import DownloadPlan, UploadPlan
from groundstation.intents.services import FetchParams, ServiceIntent
from groundstation.views.base import View
from groundstation.views.plan import PlanItem
from groundstation.views.requests import RequestLine, RequestsRequest
from tests.links_world import LinksDrive, Path

WAYPOINT, RELATIVE = 16, 6
ITEMS = tuple(
    PlanItem(WAYPOINT, RELATIVE, (0.0, 0.0, 0.0, 0.0), 473_977_420 + 90 * step, 85_455_940, 0.0) for step in range(80)
)
DELAY = 0.02

pytestmark = pytest.mark.slow


def line_of(drive: LinksDrive, number: int) -> RequestLine | None:
    """Return how a request stands."""
    views: list[View] = []

    def take(view: View) -> bool:
        views.append(view)
        return True

    drive.station.views.watch((RequestsRequest(),))
    drive.station.views.send_due(take, drive.now + 10.0, drive.now)
    drive.station.views.watch(())
    lines = [*getattr(views[-1], "running", ()), *getattr(views[-1], "ended", ())]
    return next((line for line in lines if line.number == number), None)


def run(drive: LinksDrive, seconds: float) -> None:
    """Let time pass; the disk answers every 0.05 s."""
    for _ in range(round(seconds / 0.05)):
        drive.run(0.05)
        for job in drive.station.services.pop_disk_jobs():
            drive.station.services.handle_disk(run_job(job), drive.now)


def used(drive: LinksDrive, kinds: tuple[type[Message], ...], since: float) -> set[int]:
    """Return the links that have carried the requests of a transfer."""
    return {link for at, link, message in drive.near.sent if at >= since and isinstance(message, kinds)}


def transfer(drive: LinksDrive, intent: ServiceIntent, kinds: tuple[type[Message], ...], cut_after: float) -> str:
    """Begin a transfer, cut the link that carries it meanwhile, and return its end."""
    began = drive.now
    drive.tell(intent)
    run(drive, cut_after)
    line = line_of(drive, intent.request)
    assert line is not None
    assert line.state == "running", "it ended before the cut: nothing is shown"
    [carrier] = used(drive, kinds, began)
    drive.paths[carrier].cut = True
    for _ in range(600):
        run(drive, 0.05)
        line = line_of(drive, intent.request)
        assert line is not None
        if line.state != "running":
            break
    assert 1 - carrier in used(drive, kinds, began)
    drive.paths[carrier].cut = False
    run(drive, 3.0)
    return f"{line.state} {line.detail}"


def connected(*, armed: bool = False) -> LinksDrive:
    drive = LinksDrive(Path(DELAY), Path(DELAY * 1.2))
    if armed:
        drive.arm()
    else:
        drive.until(lambda: drive.station.snapshot(drive.now, 0).vehicle is not None)
    run(drive, 3.0)
    return drive


MISSION = (m.MissionCount, m.MissionItemInt, m.MissionItem, m.MissionRequestInt, m.MissionRequestList)


@pytest.mark.parametrize("cut_after", [0.15, 1.0])
def test_a_plan_goes_on_over_the_other_link(cut_after: float) -> None:
    drive = connected()
    up = transfer(drive, UploadPlan(request=1, items=ITEMS), MISSION, cut_after)
    assert up.startswith("accepted"), up
    down = transfer(drive, DownloadPlan(request=2), MISSION, cut_after)
    assert down.startswith("accepted"), down


@pytest.mark.parametrize("cut_after", [0.1, 0.15])
def test_a_file_goes_on_over_the_other_link(tmp_path: FilePath, cut_after: float) -> None:
    drive = connected()
    name = "/parameter.json.xz"
    drive.tell(GetFile(request=1, path=name, folder=str(tmp_path), name="whole"))
    run(drive, 10.0)
    get = GetFile(request=2, path=name, folder=str(tmp_path), name="cut")
    got = transfer(drive, get, (m.FileTransferProtocol,), cut_after)
    assert got.startswith("accepted"), got
    assert (tmp_path / "cut").read_bytes() == (tmp_path / "whole").read_bytes()


def test_parameters_go_on_over_the_other_link() -> None:
    drive = connected()
    kinds: tuple[type[Message], ...] = (m.FileTransferProtocol, m.ParamRequestList, m.ParamRequestRead)
    got = transfer(drive, FetchParams(request=1), kinds, 0.1)
    assert got.startswith("accepted"), got
