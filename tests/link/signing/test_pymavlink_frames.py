"""Signed frames of pymavlink are read by us, and ours by pymavlink; key, timestamp and link id are what both say."""

from __future__ import annotations

import pytest

from dialects import rover
from link.signing.signature import is_signed, link_and_stamp
from tests.link.signing.signed import ARM, DRIVER, HERE, NOW, STRANGER, keep, send, signed, station, vehicle


def peer(system: int, component: int, secret: bytes = DRIVER.secret, link_id: int = 7) -> rover.MAVLink:
    """pymavlink's own encoder and decoder, with a key."""
    link = rover.MAVLink(None, srcSystem=system, srcComponent=component)
    link.signing.secret_key, link.signing.sign_outgoing = secret, True
    link.signing.timestamp, link.signing.link_id = NOW, link_id
    return link


@pytest.mark.parametrize("data", [signed(), signed(ARM, link_id=255, stamp=NOW + 10_000_000)])
def test_pymavlink_accepts_ours(data: bytes) -> None:
    message = peer(1, 1).parse_char(data)
    assert message is not None
    assert message.get_signed()
    assert message.get_msgbuf() == data


def test_pymavlink_refuses_ours_with_another_key() -> None:
    link = peer(1, 1)
    link.robust_parsing = True
    message = link.parse_char(signed(key=STRANGER))
    assert message is not None
    assert message.get_type() == "BAD_DATA"


def test_we_accept_theirs() -> None:
    data = rover.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(peer(255, 190))
    assert is_signed(data)
    assert link_and_stamp(data) == (7, NOW)
    assert vehicle(keep(DRIVER)).receive(data, HERE, 0.0)[0].signed
    assert vehicle(keep(STRANGER)).receive(data, HERE, 0.0) == []


def test_a_conversation_of_a_minute_both_ways() -> None:
    """pymavlink counts up by one a frame; a receiver that has heard it goes on."""
    ours, theirs = station(keep(DRIVER)), peer(1, 1)
    heard = seen = 0
    for second in range(60):
        for data in send(ours, now=float(second)):
            seen += theirs.parse_char(data) is not None
        data = rover.MAVLink_heartbeat_message(10, 3, 0, 0, 4, 3).pack(theirs)
        heard += len(ours.receive(data, HERE, float(second)))
    assert (heard, seen) == (60, 60)
