"""Delays between attempts to connect."""

from __future__ import annotations

import pytest

from link.transport.backoff import Backoff


def test_delays_double_up_to_maximum_and_restart_after_success() -> None:
    backoff = Backoff()
    assert [backoff.next_delay() for _ in range(7)] == pytest.approx([0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0])
    backoff.reset()
    assert backoff.next_delay() == pytest.approx(0.2)
