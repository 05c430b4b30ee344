"""Requests for messages to the simulated rover, in virtual time: their rate, one of them, refusals."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.intents.services import RequestMessage, ServiceIntent, SetMessageRate
from groundstation.intents.watch import Watch
from groundstation.views.messages import MessageRequest, MessagesPage, MessagesRequest, MessageView
from groundstation.views.requests import RequestLine, RequestsRequest, RequestsView
from tests.groundstation.cockpits import Cockpit
from tests.test_stops import Drive

ATTITUDE = m.Attitude.id


def connected() -> Drive:
    drive = Drive(loss=0.0, seed=3)
    drive.until(lambda: drive.station.snapshot(drive.world.now, 0).vehicle is not None)
    drive.run(1.5)
    return drive


def line(drive: Drive, number: int) -> RequestLine | None:
    views: list[RequestsView] = []
    drive.tell(Watch((RequestsRequest(),)))

    def take(view: object) -> bool:
        assert isinstance(view, RequestsView)
        views.append(view)
        return True

    drive.station.views.send_due(take, drive.world.now + 10.0, 0.0)
    drive.tell(Watch(()))
    return next((each for each in views[-1].ended if each.number == number), None)


def end_of(drive: Drive, intent: ServiceIntent) -> tuple[str, str]:
    """Make a request and wait for its end: its state and what was requested."""
    drive.tell(intent)
    drive.until(lambda: line(drive, intent.request) is not None, 20.0)
    found = line(drive, intent.request)
    assert found is not None
    return found.state, found.what


def rate(drive: Drive) -> float:
    """Hz of ATTITUDE over the last 3 s."""
    drive.run(4.0)
    pages: list[MessagesPage] = []

    def take(view: object) -> bool:
        assert isinstance(view, MessagesPage)
        pages.append(view)
        return True

    drive.tell(Watch((MessagesRequest(count=200),)))
    drive.station.views.send_due(take, drive.world.now, 0.0)
    drive.tell(Watch(()))
    return next(each.rate for each in pages[-1].rows if each.name == "ATTITUDE" and not each.sent)


def test_a_rate_is_set_ended_and_the_default_again() -> None:
    drive = connected()
    default = rate(drive)
    assert default > 0
    assert end_of(drive, SetMessageRate(1, 0, 1, ATTITUDE, "ATTITUDE", 2.0)) == ("accepted", "send ATTITUDE at 2 Hz")
    assert rate(drive) == pytest.approx(2.0, abs=0.4)
    assert end_of(drive, SetMessageRate(2, 0, 1, ATTITUDE, "ATTITUDE", -1.0)) == ("accepted", "send ATTITUDE no more")
    assert rate(drive) == 0.0
    assert end_of(drive, SetMessageRate(3, 0, 1, ATTITUDE, "ATTITUDE", 0.0))[0] == "accepted"
    assert rate(drive) == pytest.approx(default, abs=1.0)


def test_one_message_is_requested() -> None:
    drive = connected()
    request = MessageRequest(1, 1, False, "AUTOPILOT_VERSION")
    drive.tell(Watch((request,)))
    assert end_of(drive, RequestMessage(1, 0, 1, m.AutopilotVersion.id, "AUTOPILOT_VERSION"))[0] == "accepted"
    views: list[object] = []
    drive.tell(Watch((request,)))
    drive.run(0.5)

    def take(view: object) -> bool:
        views.append(view)
        return True

    drive.station.views.send_due(take, drive.world.now + 10.0, 0.0)
    assert isinstance(views[-1], MessageView)


def test_a_message_the_vehicle_lacks_is_refused_in_its_words() -> None:
    drive = connected()
    state, _ = end_of(drive, SetMessageRate(1, 0, 1, 9999, "NO_SUCH", 2.0))
    assert state == "refused"


@pytest.mark.parametrize("wrong", [math.inf, math.nan, 1e9])
def test_a_rate_that_is_none_is_refused_and_not_sent(wrong: float) -> None:
    drive = connected()
    assert end_of(drive, SetMessageRate(1, 0, 1, ATTITUDE, "ATTITUDE", wrong))[0] == "refused"


def test_other_components_are_not_asked() -> None:
    drive = connected()
    assert end_of(drive, SetMessageRate(1, 0, 154, ATTITUDE, "ATTITUDE", 2.0))[0] == "refused"
    assert end_of(drive, RequestMessage(2, 0, 154, ATTITUDE, "ATTITUDE"))[0] == "refused"


def test_a_silent_vehicle_ends_a_request_without_an_answer() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    cockpit.vehicle.silent_on = {Command.SET_MESSAGE_INTERVAL}
    cockpit.do(SetMessageRate(1, 0, 1, ATTITUDE, "ATTITUDE", 2.0))
    for _ in range(200):
        cockpit.run(0.1)
    texts = [each.text for each in cockpit.snapshot.texts]
    assert any("send ATTITUDE at 2 Hz: no answer" in text for text in texts)
