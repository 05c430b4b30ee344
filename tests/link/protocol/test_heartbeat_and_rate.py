"""Silence, token buckets and rates, in literal seconds."""

from __future__ import annotations

import math

import pytest

from link.protocol.heartbeat import HeartbeatMonitor
from link.protocol.rate import RateMeter, TokenBucket


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


def test_a_bucket_lets_a_burst_and_then_its_rate_through() -> None:
    bucket = TokenBucket(rate=10, burst=3)
    assert [bucket.consume(0.0) for _ in range(5)] == [True, True, True, False, False]
    assert [bucket.consume(0.1), bucket.consume(0.1)] == [True, False]
    assert [bucket.consume(100.0) for _ in range(4)] == [True, True, True, False]


def test_a_meter_forgets_after_its_window() -> None:
    meter = RateMeter(window=2.0)
    for tenth in range(20):
        meter.add(tenth / 10)
    assert meter.rate(1.9) == pytest.approx(10)
    assert meter.rate(2.95) == pytest.approx(5)
    assert meter.rate(10.0) == 0
