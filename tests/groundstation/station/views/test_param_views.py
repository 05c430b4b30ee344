"""Views of the Parameters screen: the station and the simulated rover in virtual time."""

from __future__ import annotations

from typing import TypeVar

from groundstation.formats.docs_files import read_docs
from groundstation.intents.services import CompareParams, FetchParams, ResetParams, StoreParams, WriteParams
from groundstation.intents.watch import Watch
from groundstation.station.views.param_views import ParamViews
from groundstation.views.base import View, ViewRequest
from groundstation.views.params import (
    ParamDiff,
    ParamDiffRequest,
    ParamExport,
    ParamExportRequest,
    ParamInfoRequest,
    ParamInfos,
    ParamPage,
    ParamPageRequest,
)
from link.services.param.client import Param
from tests.groundstation.station.services.test_service_requests import connected, end_of
from tests.test_stops import Drive
from vehicle.params import PARAMETERS

Wanted = TypeVar("Wanted", bound=View)


def view(drive: Drive, request: ViewRequest, kind: type[Wanted]) -> Wanted:
    found: list[View] = []

    def take(each: View) -> bool:
        found.append(each)
        return True

    drive.tell(Watch((request,)))
    drive.station.views.send_due(take, drive.world.now + 10.0, 0.0)
    drive.tell(Watch(()))
    assert isinstance(found[-1], kind)
    return found[-1]


def fetched() -> Drive:
    drive = connected()
    drive.tell(FetchParams(1))
    end_of(drive, 1)
    return drive


def described() -> Drive:
    """A station that has the vehicle's own texts."""
    drive = fetched()
    drive.until(lambda: view(drive, ParamPageRequest(rows=1), ParamPage).texts == "the vehicle", 20.0)
    return drive


def test_the_vehicle_serves_the_texts_of_its_parameters() -> None:
    drive = described()
    page = view(drive, ParamPageRequest("FS_GCS_ENABLE", rows=5), ParamPage)
    assert [(row.name, row.unit, row.meaning) for row in page.rows] == [("FS_GCS_ENABLE", "", "HOLD")]
    assert (page.autopilot, page.missing, page.gaps) == ("other", 0, ())
    assert sum(group.count for group in page.groups) == page.known == len(PARAMETERS)
    [info] = view(drive, ParamInfoRequest(("FS_TIMEOUT", "NO_SUCH")), ParamInfos).infos
    assert (info.low, info.high, info.unit, info.not_armed) == (0.5, 10.0, "s", True)
    assert info.title == PARAMETERS["FS_TIMEOUT"].description
    found = view(drive, ParamPageRequest("thrust", rows=9), ParamPage)
    assert [row.name for row in found.rows] == ["MOT_THST_ASYM", "MOT_THST_EXPO"], "a word of their texts"


def test_the_users_file_serves_a_vehicle_without_own_texts() -> None:
    drive = fetched()
    damaged = read_docs(b"{", "parameters.json", None)
    mine = read_docs(b'{"parameters": [{"name": "FS_TIMEOUT", "units": "furlong"}]}', "mine.json", None)
    other = read_docs(b'{"parameters": [{"name": "FS_TIMEOUT", "units": "mile"}]}', "other.json", 12)
    request = ParamPageRequest("FS_TIMEOUT", rows=1)
    for files, unit, texts in (
        ((other, mine), "furlong", "mine.json"),
        ((other,), "", ""),
        ((damaged,), "", damaged.problem),
    ):
        views = ParamViews(drive.station.fleet, drive.station.services, files)
        page = views.sources[ParamPageRequest].build(request, 0.0, 0.0)
        assert isinstance(page, ParamPage)
        assert (page.rows[0].unit, page.texts) == (unit, texts)


def test_a_file_is_compared_until_it_is_closed() -> None:
    drive = fetched()
    drive.tell(CompareParams(2, 1, "a.param", "FS_TIMEOUT 3\nWP_SPEED 0.8\nNO_SUCH 1\n"))
    assert end_of(drive, 2).detail == "3 parameters"
    found = view(drive, ParamDiffRequest(), ParamDiff)
    assert (found.file, found.same, found.only_file) == ("a.param", 1, ("NO_SUCH",))
    assert found.different == (("FS_TIMEOUT", 1.5, 3.0),)
    assert found.only_vehicle == len(PARAMETERS) - 2
    assert view(drive, ParamPageRequest("FS_TIMEOUT", rows=1), ParamPage).rows[0].file == 3.0
    drive.tell(CompareParams(3, 1, "b.param", "FS_TIMEOUT 3\nFS_TIMEOUT 4\n"))
    line = end_of(drive, 3)
    assert (line.state, line.detail) == (
        "refused", "b.param:2: FS_TIMEOUT is given twice, first in line 1: remove one",
    )  # fmt: skip
    assert view(drive, ParamDiffRequest(), ParamDiff).file == "a.param", "the one before stands"
    drive.tell(CompareParams(4, 1))
    end_of(drive, 4)
    assert view(drive, ParamDiffRequest(), ParamDiff).file == ""


def test_a_file_is_made_of_all_of_a_group_or_of_what_has_changed() -> None:
    drive = fetched()
    every = view(drive, ParamExportRequest(1, "mavproxy"), ParamExport)
    assert (every.number, every.count, len(every.text.splitlines())) == (1, len(PARAMETERS), len(PARAMETERS))
    group = view(drive, ParamExportRequest(2, "mp", group="WP"), ParamExport)
    assert group.text.splitlines()[-1] == "WP_SPEED,0.8"
    assert group.count == 4
    drive.tell(WriteParams(5, 1, (("WP_SPEED", 0.5),)))
    end_of(drive, 5)
    changed = view(drive, ParamExportRequest(3, "qgc", changed_only=True), ParamExport)
    assert "1\t1\tWP_SPEED\t0.5" in changed.text
    assert changed.count < len(PARAMETERS)


def test_the_vehicle_stores_and_resets_its_parameters() -> None:
    drive = fetched()
    drive.tell(WriteParams(2, 1, (("WP_SPEED", 0.5),)))
    end_of(drive, 2)
    drive.tell(ResetParams(3, 1))
    assert end_of(drive, 3).state == "accepted"
    drive.tell(FetchParams(4))
    end_of(drive, 4)
    assert view(drive, ParamPageRequest("WP_SPEED", rows=1), ParamPage).rows[0].value == 0.8
    drive.tell(StoreParams(5, 1))
    assert end_of(drive, 5).state in ("accepted", "refused"), "refused where nothing is saved"


def test_a_file_that_no_packet_holds_is_refused() -> None:
    drive = fetched()
    contact = drive.station.fleet.selected
    assert contact is not None
    assert contact.services is not None
    client = contact.services.params.client
    client.load(Param(f"PARAMETER_{number:05}", 0.1, 9, number) for number in range(8000))
    found = view(drive, ParamExportRequest(1, "qgc"), ParamExport)
    assert (found.text, found.count) == ("", 0)
    assert "mavhelm param save" in found.problem


def test_kept_rows_are_made_anew_for_each_thing_that_changes() -> None:
    drive = fetched()
    request = ParamPageRequest("FS_TIMEOUT", rows=1)
    kept = [view(drive, request, ParamPage).rows for _ in range(2)]
    assert kept[0] is kept[1]
    drive.tell(WriteParams(2, 1, (("FS_TIMEOUT", 2.5),)))
    end_of(drive, 2)
    assert view(drive, request, ParamPage).rows[0].value == 2.5
    drive.tell(CompareParams(3, 1, "a.param", "FS_TIMEOUT 3\n"))
    end_of(drive, 3)
    assert view(drive, request, ParamPage).rows[0].file == 3.0
    drive.until(lambda: view(drive, request, ParamPage).rows[0].unit == "s", 20.0)
    drive.tell(FetchParams(4))
    for first in range(40):
        view(drive, ParamPageRequest(first=first, rows=1), ParamPage)
    assert view(drive, request, ParamPage).rows[0].value == 2.5, "also after many others"
