"""Token buckets and rate meters, in literal seconds."""

from __future__ import annotations

import pytest

from link.protocol.rate import RateMeter, SenderLimit, TokenBucket


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


def test_a_bucket_of_another_rate_keeps_the_tokens_that_fit() -> None:
    bucket = TokenBucket(rate=10, burst=5)
    assert bucket.consume(0.0)
    bucket.set_rate(1, 2)
    assert [bucket.consume(0.0) for _ in range(3)] == [True, True, False]
    assert [bucket.consume(1.0), bucket.consume(1.0)] == [True, False]


def test_rate_change_adds_no_tokens_and_drops_those_over_burst() -> None:
    empty = TokenBucket(rate=10, burst=5)
    assert [empty.consume(0.0) for _ in range(6)] == [True] * 5 + [False]
    empty.set_rate(10, 10)
    assert not empty.consume(0.0)
    full = TokenBucket(rate=10, burst=5)
    full.set_rate(1, 2)
    assert [full.consume(0.0) for _ in range(3)] == [True, True, False]


def test_each_sender_has_one_a_period_and_a_crowd_is_bounded() -> None:
    limit = SenderLimit(1.0, 3)
    assert [limit.allow("a", now) for now in (0.0, 0.5, 0.99, 1.0, 1.5)] == [True, False, False, True, False]
    assert [limit.allow(each, 1.6) for each in "bcd"] == [True, True, False]
    assert [limit.allow(each, 2.0) for each in "de"] == [True, False]
    assert limit.allow("e", 2.6)
