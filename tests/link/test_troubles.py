"""What of a link's problems is news: each beginning and each end, once."""

from __future__ import annotations

from typing import Any

from dialects.enums import Severity
from link.channel import Channel
from link.core import LinkReport
from link.troubles import News, Troubles


def report(received: int, **changes: Any) -> LinkReport:
    return LinkReport("udpin:127.0.0.1:14550", frames=received, **changes)


def test_a_link_that_goes_down_comes_back_and_goes_down_again_is_told_each_time() -> None:
    troubles = Troubles()
    gone = report(0, down="udpin:127.0.0.1:14550: lost the port (hung up); waiting for it")
    told = [troubles.news(each) for each in (report(0), gone, gone, report(1), report(2), gone)]
    lost = News("lost the port (hung up); waiting for it", Severity.ERROR)
    assert told == [None, lost, None, News("it is back", Severity.NOTICE), None, lost]


def test_a_new_reason_is_told_too() -> None:
    troubles = Troubles()
    told = [troubles.news(report(0, down=why)) for why in ("lost", "not there", "not there")]
    assert [each and each.text for each in told] == ["lost", "not there", None]


def test_a_wrong_dialect_is_told_once() -> None:
    troubles = Troubles()
    wrong = report(0, dialect_mismatch=("HEARTBEAT",))
    told = [troubles.news(each) for each in (wrong, report(1), wrong)]
    assert [each is not None for each in told] == [True, False, False]


def test_a_wrong_baud_rate_is_told_once_however_much_noise_there_is() -> None:
    troubles, channel = (
        Troubles(),
        Channel("serial:/dev/ttyS0:57600", 0, system=1, component=1, stream=True, capacity=5760),
    )
    told = []
    for second in range(5):
        channel.receive(bytes(2000), "port", float(second))
        told.append(troubles.news(channel.report(now=float(second))))
    assert [each.text for each in told if each] == ["bytes and no MAVLink frame among them; wrong baud rate?"]
