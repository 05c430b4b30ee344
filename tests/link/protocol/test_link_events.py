"""What of a link's problems is news: each beginning and each end, once."""

from __future__ import annotations

from typing import Any

import pytest

from dialects.enums import Severity
from link.core import GuardReport, LinkReport, SigningCounts
from link.protocol.channel import Channel
from link.protocol.link_events import PROVEN_AFTER, LinkEvent, LinkEvents, UpDownEvents, link_problem


def report(received: int, **changes: Any) -> LinkReport:
    return LinkReport("udpin:127.0.0.1:14550", frames=received, **changes)


def test_a_link_is_told_each_time_it_goes_down_and_comes_back() -> None:
    troubles = LinkEvents()
    gone = report(0, down="udpin:127.0.0.1:14550: lost the port (hung up); waiting for it")
    told = [troubles.update(each) for each in (report(0), gone, gone, report(1), report(2), gone)]
    lost = LinkEvent("lost the port (hung up); waiting for it", Severity.ERROR)
    assert told == [None, lost, None, LinkEvent("it is back", Severity.NOTICE), None, lost]


def test_connecting_is_no_news_and_a_newcomer_is_not_back() -> None:
    troubles = LinkEvents()
    whys = ("connecting", "not connected (refused)", None, "lost", "not connected (refused)", None)
    told = [troubles.update(report(0, down=why)) for why in whys]
    assert [each and each.text for each in told] == [
        None, "not connected (refused)", "connected", "lost", "not connected (refused)", "it is back"
    ]  # fmt: skip
    assert [each and each.severity for each in told[1:3]] == [Severity.ERROR, Severity.NOTICE]


def test_what_connects_at_once_is_told_once() -> None:
    troubles = LinkEvents()
    told = [troubles.update(report(0, down=why)) for why in ("connecting", "connecting", None, None)]
    assert [each and each.text for each in told] == [None, None, "connected", None]


def test_links_are_told_apart() -> None:
    troubles = UpDownEvents()
    assert troubles.update("one", None) is None
    assert troubles.update("two", "missing") == LinkEvent("missing", Severity.ERROR)
    assert troubles.update("one", "missing") == LinkEvent("missing", Severity.ERROR)
    assert troubles.update("two", None) == LinkEvent("connected", Severity.NOTICE)
    assert troubles.update("one", None) == LinkEvent("it is back", Severity.NOTICE)


def test_a_new_reason_is_told_too() -> None:
    troubles = LinkEvents()
    told = [troubles.update(report(0, down=why)) for why in ("lost", "not there", "not there")]
    assert [each and each.text for each in told] == ["lost", "not there", None]


def test_a_wrong_dialect_is_told_once() -> None:
    troubles = LinkEvents()
    wrong = report(0, dialect_mismatch=("HEARTBEAT",))
    told = [troubles.update(each) for each in (wrong, report(1), wrong)]
    assert [each is not None for each in told] == [True, False, False]


def test_a_wrong_dialect_is_told_with_what_helps() -> None:
    texts = [link_problem(report(0, dialect_mismatch=names)) or "" for names in (("DEBUG_VECT",), ("HEARTBEAT",))]
    assert texts == [
        "messages arrive with another dialect's checksum and are dropped: DEBUG_VECT; start with --dialect FILE.xml",
        "messages arrive with another dialect's checksum and are dropped: HEARTBEAT; "
        "the vehicle must send the standard definition",
    ]


def test_a_wrong_baud_rate_is_told_once_in_any_amount_of_noise() -> None:
    troubles, channel = (
        LinkEvents(),
        Channel("serial:/dev/ttyS0:57600", 0, system=1, component=1, stream=True, capacity=5760),
    )
    told = []
    for second in range(5):
        channel.receive(bytes(2000), "port", float(second))
        told.append(troubles.update(channel.report(now=float(second))))
    assert [each.text for each in told if each] == ["bytes arrive, but no MAVLink frame; wrong baud rate?"]


def test_another_program_with_our_ids_is_told_with_what_helps() -> None:
    assert "change --system of one of them" in (link_problem(report(1, own_id=True)) or "")


@pytest.mark.parametrize(
    ("counts", "advice"),
    [
        (SigningCounts(bad=PROVEN_AFTER), "compare the fingerprints"),
        (SigningCounts(too_old=PROVEN_AFTER), "set the clock"),
        (SigningCounts(unsigned=PROVEN_AFTER), "give the other end a key"),
        (SigningCounts(unsigned=PROVEN_AFTER - 1, bad=PROVEN_AFTER - 1), ""),
    ],
)
def test_frames_that_are_refused_are_told_with_what_helps(counts: SigningCounts, advice: str) -> None:
    assert advice in (link_problem(report(9, refused=counts)) or "")
    assert link_problem(report(9, refused=counts, verified=frozenset({1}))) is None
    assert bool(advice) is (link_problem(report(9, refused=counts)) is not None)


def test_a_link_that_comes_back_with_a_problem_is_back_first() -> None:
    troubles = LinkEvents()
    told = [troubles.update(each) for each in (report(0, down="lost"), report(1, own_id=True), report(1, own_id=True))]
    assert [each and each.text for each in told[:2]] == ["lost", "connected"]
    assert "--system" in (told[2].text if told[2] else "")


def test_a_clock_that_is_followed_for_more_than_a_day_is_named() -> None:
    for ahead, named in ((86_400.0, False), (86_401.0, True)):
        guard = GuardReport("laptop", ahead={1: ahead, 2: 5.0})
        report = LinkReport("udpin:x", refused=SigningCounts(), verified=frozenset({1}), guard=guard)
        text = link_problem(report)
        assert (text == "system 1 signs 1 days ahead of our clock, and we sign with its time: set both clocks") is named
    assert link_problem(LinkReport("udpin:x", refused=SigningCounts(), verified=frozenset({1}))) is None
