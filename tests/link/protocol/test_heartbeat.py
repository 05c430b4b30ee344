"""Liveness of a source, in literal seconds."""

from __future__ import annotations

import math

from link.protocol.heartbeat import HeartbeatMonitor


def test_silence_begins_with_the_last_word() -> None:
    monitor = HeartbeatMonitor(timeout=5.0)
    assert not monitor.ever_heard
    assert monitor.silence(1.0) == math.inf
    assert not monitor.is_alive(1.0)
    monitor.update(1.0)
    assert monitor.ever_heard
    assert monitor.is_alive(6.0)
    assert not monitor.is_alive(6.1)
    assert monitor.silence(3.5) == 2.5
