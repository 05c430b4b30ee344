"""Rates and counts of messages by name and direction."""

from __future__ import annotations

import pytest

from dialects.messages import Heartbeat
from groundstation.station.message_rates import MessageRates
from tests.groundstation.fake_vehicle import Cockpit


def test_messages_come_with_rates() -> None:
    cockpit = Cockpit()
    cockpit.run(5.0)
    rates = {(rate.name, rate.sent): rate for rate in cockpit.snapshot.messages}
    assert rates["HEARTBEAT", False].rate == pytest.approx(1.0, abs=0.4)
    assert rates["HEARTBEAT", True].count >= 5


def test_rates_are_those_of_the_selected_vehicle() -> None:
    rates = MessageRates()
    beat = Heartbeat(10, 0, 0, 0, 3, 3)
    for tenth in range(100):
        for system in (1, 2, 3):
            rates.count(beat, tenth / 10, system=system)
    rates.count(beat, 9.9)
    received, sent = sorted(rates.build_rates(2, 9.9), key=lambda row: row.sent)
    assert (received.count, sent.count) == (100, 1)
    assert received.rate == pytest.approx(10.0, abs=0.5)
    assert [row.sent for row in rates.build_rates(9, 9.9)] == [True]
