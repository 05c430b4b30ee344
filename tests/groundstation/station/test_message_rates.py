"""Rates and counts of messages by name and direction."""

from __future__ import annotations

import pytest

from tests.groundstation.fake_vehicle import Cockpit


def test_messages_come_with_rates() -> None:
    cockpit = Cockpit()
    cockpit.run(5.0)
    rates = {(rate.name, rate.sent): rate for rate in cockpit.snapshot.messages}
    assert rates["HEARTBEAT", False].rate == pytest.approx(1.0, abs=0.4)
    assert rates["HEARTBEAT", True].count >= 5
