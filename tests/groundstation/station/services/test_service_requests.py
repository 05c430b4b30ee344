"""Requests of the screen to the services of a vehicle: the station and the simulated rover in virtual time."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.services import CancelRequest, FetchParams, WriteParams
from groundstation.intents.watch import Watch
from groundstation.natural_order import natural_key
from groundstation.views.params import ParamPage, ParamPageRequest
from groundstation.views.requests import RequestLine
from tests.test_stops import Drive
from vehicle.params import PARAMETERS

ALL = ParamPageRequest(rows=200)
NAMES = sorted(PARAMETERS, key=natural_key)


def connected(loss: float = 0.0) -> Drive:
    drive = Drive(loss=loss, seed=3)
    drive.until(lambda: drive.station.snapshot(drive.world.now, 0).vehicle is not None)
    drive.run(1.5)
    return drive


def page(drive: Drive, request: ParamPageRequest = ALL) -> ParamPage:
    views: list[ParamPage] = []
    drive.tell(Watch((request,)))

    def take(view: object) -> bool:
        assert isinstance(view, ParamPage)
        views.append(view)
        return True

    drive.station.views.send_due(take, drive.world.now + 10.0, 0.0)
    drive.tell(Watch(()))
    return views[-1]


def end_of(drive: Drive, number: int, within: float = 20.0) -> RequestLine:
    """Wait until a request has ended."""

    def lines() -> list[RequestLine]:
        return [line for line in page(drive).ended if line.number == number]

    drive.until(lambda: bool(lines()), within)
    [line] = lines()
    return line


def names(found: ParamPage) -> list[str]:
    return [row.name for row in found.rows]


def texts(drive: Drive) -> list[str]:
    return [line.text for line in drive.station.snapshot(drive.world.now, 0).texts]


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_parameters_come_with_defaults_and_are_sent_by_page(loss: float) -> None:
    drive = connected(loss)
    assert page(drive).known == 0
    drive.tell(FetchParams(1))
    assert end_of(drive, 1).detail == f"{len(PARAMETERS)} parameters"
    whole = page(drive)
    assert names(whole) == NAMES
    assert (whole.total, whole.has_defaults) == (len(PARAMETERS), True)
    part = page(drive, ParamPageRequest(first=15, rows=3))
    assert (names(part), part.first, part.matching) == (NAMES[15:18], 15, len(PARAMETERS))
    failsafes = page(drive, ParamPageRequest(filter="fs_ man_t", rows=50))
    assert names(failsafes) == [name for name in NAMES if "FS_" in name or "MAN_T" in name]
    assert page(drive, ParamPageRequest(first=500, rows=3)).rows != ()


def test_parameters_are_set_one_after_the_other() -> None:
    drive = connected()
    drive.tell(FetchParams(1))
    end_of(drive, 1)
    drive.tell(WriteParams(2, 1, (("FS_TIMEOUT", 2.0), ("FS_DISARM_T", 20.0))))
    assert (end_of(drive, 2).what, end_of(drive, 2).state) == ("set 2 parameters", "accepted")
    changed = page(drive, ParamPageRequest(changed_only=True, rows=10))
    assert [(row.name, row.value, row.default) for row in changed.rows] == [
        ("FS_DISARM_T", 20.0, 30.0),
        ("FS_TIMEOUT", 2.0, 1.5),
    ]
    assert drive.params["FS_TIMEOUT"] == 2.0
    assert "Rover 1: set FS_TIMEOUT to 2: accepted, was 1.5" in texts(drive)


def test_a_write_stops_at_the_first_refusal_with_its_words() -> None:
    drive = connected()
    changes = (("FS_DISARM_T", 20.0), ("FS_TIMEOUT", 99.0), ("FS_GCS_TIMEOUT", 6.0))
    drive.tell(WriteParams(7, 1, changes))
    line = end_of(drive, 7)
    assert line.state == "refused"
    assert line.detail == "FS_TIMEOUT not changed: 99 is not in 0.5 to 10 (1 of 3 set)"
    assert (line.done, line.total) == (1, 3)
    assert (drive.params["FS_DISARM_T"], drive.params["FS_GCS_TIMEOUT"]) == (20.0, 5.0)


def test_while_armed_the_vehicle_refuses_and_drives_on() -> None:
    drive = connected()
    drive.get_going()
    drive.tell(FetchParams(1), WriteParams(2, 1, (("FS_TIMEOUT", 3.0),)))
    assert "FS_TIMEOUT not changed: disarm first" in end_of(drive, 2).detail
    assert end_of(drive, 1).state == "accepted"
    assert drive.power > 0.5, "requests do not disturb the demand"
    drive.held = None
    drive.assert_stops(drive.world.now)


def test_nothing_is_sent_for_a_screen_that_is_frozen() -> None:
    drive = connected()
    drive.tell(FetchParams(1))
    end_of(drive, 1)
    drive.screen_lives = False
    drive.run(1.0)
    sent = len(drive.world.near.sent)
    drive.tell(FetchParams(2))
    drive.run(3.0)
    assert len(drive.world.near.sent) == sent
    drive.screen_lives = True
    assert end_of(drive, 2).state == "accepted"


def test_a_request_without_the_vehicle_ends_at_once() -> None:
    drive = Drive()
    drive.tell(FetchParams(1))
    assert "station: fetch parameters: refused, no vehicle yet" in texts(drive)
    drive = connected()
    drive.tell(WriteParams(2, 99, (("FS_TIMEOUT", 3.0),)))
    assert end_of(drive, 2).detail == "no vehicle yet"
    drive.run(1.0)
    assert not any(isinstance(message, m.ParamSet) for _, message in drive.world.near.sent)


def test_two_requests_at_once() -> None:
    drive = connected()
    drive.tell(FetchParams(1), FetchParams(2), WriteParams(3, 1, ()), FetchParams(1))
    assert end_of(drive, 2).detail == "parameters are being fetched already"
    assert "there is nothing to set" in end_of(drive, 3).detail
    drive.until(lambda: not page(drive).running)


def test_a_vehicle_that_is_only_driven_has_no_services() -> None:
    drive = connected()
    selected = drive.station.fleet.selected
    assert selected is not None
    assert selected.services is None
    assert page(drive).rows == ()
    assert selected.services is None


def test_a_request_can_be_cancelled() -> None:
    drive = connected()
    drive.tell(FetchParams(1))
    drive.run(0.01)
    drive.tell(CancelRequest(1))
    assert end_of(drive, 1, within=0.1).state == "cancelled"
    drive.tell(FetchParams(2))
    assert end_of(drive, 2).state == "accepted"
    changes = tuple((name, PARAMETERS[name].default * 0.9) for name in ("WP_SPEED", "WP_RADIUS", "SPEED_MAX"))
    drive.tell(WriteParams(3, 1, changes))
    drive.tell(CancelRequest(3))
    assert end_of(drive, 3).state == "cancelled"
    drive.run(2.0)
    assert drive.params["SPEED_MAX"] == PARAMETERS["SPEED_MAX"].default


def test_after_a_lost_link_the_values_are_forgotten() -> None:
    drive = connected()
    drive.tell(FetchParams(1))
    end_of(drive, 1)
    drive.world.cut()
    drive.run(4.0)
    assert page(drive).known == len(PARAMETERS)
    drive.world.cut(False)
    drive.until(lambda: page(drive).known == 0)
    drive.tell(FetchParams(2))
    assert end_of(drive, 2).state == "accepted"
