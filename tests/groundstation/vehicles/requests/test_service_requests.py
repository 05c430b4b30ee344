"""Requests about plans, files and logs: their order, their end in the book, cancelling."""

from __future__ import annotations

import random

from dialects.enums import MissionType
from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.requests.log_requests import LogRequests
from groundstation.vehicles.requests.plan_requests import PlanRequests
from groundstation.vehicles.requests.requests import RequestBook, RequestState
from link.services.ftp.client import FtpClient
from link.services.ftp.files import MemoryFolder
from link.services.log.client import LogClient, RemoteLog
from link.services.log.server import LogServer
from link.services.mission.client import MissionClient
from link.services.pacing import BulkPacer
from tests.link import ftp_rig, mission_rig
from tests.link.mission_rig import plain, waypoint
from tests.link.services_world import Pair

DATA = random.Random(2).randbytes(30_000)
ITEMS = [waypoint(number) for number in range(30)]


def ends(book: RequestBook) -> dict[int, RequestState]:
    return {report.number: report.state for report in book.pop_changes() if report.state.ended}


def test_plans_go_one_after_the_other() -> None:
    vehicle, book = mission_rig.MissionRig(), RequestBook()
    client = MissionClient(255, 190, target_system=1)
    plans = PlanRequests(client, book)
    pair = Pair(vehicle.server, client, plans)
    plans.upload(1, MissionType.MISSION, ITEMS, pair.now)
    plans.download(2, MissionType.MISSION, pair.now)
    plans.clear(3, MissionType.MISSION, pair.now)
    pair.run_until(lambda: len(book.running) == 1, 20.0)
    assert plain(plans.plans[MissionType.MISSION]) == plain(tuple(ITEMS))
    pair.run_until(lambda: not book.running, 20.0)
    assert set(ends(book).values()) == {RequestState.ACCEPTED}
    assert plans.plans[MissionType.MISSION] == vehicle.plan == ()


def test_cancelled_upload_changes_nothing_and_next_request_runs() -> None:
    vehicle, book = mission_rig.MissionRig(), RequestBook()
    client = MissionClient(255, 190, target_system=1)
    plans = PlanRequests(client, book)
    pair = Pair(vehicle.server, client, plans)
    plans.upload(1, MissionType.MISSION, ITEMS, pair.now)
    plans.upload(2, MissionType.MISSION, ITEMS[:5], pair.now)
    plans.download(3, MissionType.FENCE, pair.now)
    pair.run_until(lambda: any(report.done > 10 for report in book.running), 5.0)
    plans.cancel(2, pair.now)
    plans.cancel(1, pair.now)
    pair.run_until(lambda: not book.running, 20.0)
    assert ends(book) == {1: RequestState.CANCELLED, 2: RequestState.CANCELLED, 3: RequestState.ACCEPTED}
    assert vehicle.plan == ()


def test_a_download_that_was_not_answered_goes_on_where_it_ended() -> None:
    vehicle, book = mission_rig.MissionRig(), RequestBook()
    vehicle.upload(ITEMS)
    client = MissionClient(255, 190, target_system=1)
    plans = PlanRequests(client, book)
    pair = Pair(vehicle.server, client, plans)
    plans.download(1, MissionType.MISSION, pair.now)
    pair.run_until(lambda: any(report.done >= 20 for report in book.running), 5.0)
    for second in range(60):
        plans.tick(pair.now + second)
    client.messages_to_send()
    [failed] = [report for report in book.pop_changes() if report.state.ended]
    assert failed.text == "download mission: no answer, after 16 tries, 20 of 30 items arrived"
    sent = pair.sent_by_client
    plans.download(2, MissionType.MISSION, pair.now)
    pair.run_until(lambda: not book.running, 20.0)
    assert plain(plans.plans[MissionType.MISSION]) == plain(tuple(ITEMS))
    assert pair.sent_by_client - sent < 15


def test_files_are_cancelled_one_by_one() -> None:
    vehicle, book = ftp_rig.FtpRig(logs={"1.bin": DATA}, rate=50_000.0), RequestBook()
    client = FtpClient(255, 190, target_system=1)
    files = FileRequests(client, book)
    pair = Pair(vehicle.server, client, files)
    files.download(1, "/logs/1.bin", pair.now)
    files.checksum(2, "/logs/1.bin", pair.now)
    files.list_folder(3, "/logs", pair.now)
    pair.run_until(lambda: any(report.done > 5000 for report in book.running), 5.0)
    assert files.beginning_of(1) == DATA[: len(files.beginning_of(1))] != b""
    files.cancel(1, pair.now)
    files.cancel(2, pair.now)
    pair.run_until(lambda: not book.running, 20.0)
    assert ends(book) == {1: RequestState.CANCELLED, 2: RequestState.CANCELLED, 3: RequestState.ACCEPTED}
    outcome = files.pop_result(3)
    assert outcome is not None
    assert [entry.name for entry in outcome.entries] == ["1.bin"]
    assert files.pop_result(3) is None


def test_a_path_that_cannot_be_sent_is_refused_at_once() -> None:
    book = RequestBook()
    files = FileRequests(FtpClient(255, 190, target_system=1), book)
    files.download(1, "", 0.0)
    assert ends(book) == {1: RequestState.REFUSED}


def test_logs_are_cancelled_one_by_one() -> None:
    book = RequestBook()
    client = LogClient(255, 190, target_system=1)
    logs = LogRequests(client, book)
    server = LogServer(
        MemoryFolder({"1.bin": DATA}), system=1, component=1, pacer=BulkPacer(lambda peer: 50_000.0)
    )  # fmt: skip
    pair = Pair(server, client, logs)
    log = RemoteLog(0, 0, len(DATA))
    logs.download(1, log, pair.now)
    logs.download(2, log, pair.now)
    logs.download(3, log, pair.now)
    pair.run_until(lambda: len(logs.beginning_of(1)) > 5000, 5.0)
    logs.cancel(9, pair.now)
    logs.cancel(2, pair.now)
    logs.cancel(1, pair.now)
    pair.run_until(lambda: not book.running, 20.0)
    assert ends(book) == {1: RequestState.CANCELLED, 2: RequestState.CANCELLED, 3: RequestState.ACCEPTED}
    assert logs.pop_data(3) == DATA
