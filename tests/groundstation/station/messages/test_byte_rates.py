"""Bytes a second of all links."""

from __future__ import annotations

from groundstation.station.messages.byte_rates import POINTS, ByteRates
from link.core import LinkReport


def report(index: int, received: int, sent: int = 0) -> LinkReport:
    return LinkReport("udpin:127.0.0.1:1", index=index, bytes_received=received, bytes_sent=sent)


def test_both_directions_of_all_links_count() -> None:
    rates = ByteRates()
    rates.observe([report(0, 1000), report(1, 50)], 10.0)
    rates.observe([report(0, 1600, 200), report(1, 250)], 12.0)
    assert rates.rates == (500,)


def test_a_link_that_opens_or_closes_makes_no_jump() -> None:
    rates = ByteRates()
    rates.observe([report(0, 1000)], 10.0)
    rates.observe([report(0, 1100), report(1, 9_000_000)], 11.0)
    rates.observe([report(1, 9_000_300)], 12.0)
    rates.observe([report(1, 0)], 13.0)
    assert rates.rates == (100, 300, 0)


def test_reports_that_come_at_once_count_with_the_next() -> None:
    rates = ByteRates()
    for now, received in ((10.0, 0), (11.0, 100), (11.01, 150), (12.0, 250)):
        rates.observe([report(0, received)], now)
    assert rates.rates == (100, 150)


def test_only_the_last_minute_is_kept() -> None:
    rates = ByteRates()
    for second in range(100):
        rates.observe([report(0, second * second)], float(second))
    assert len(rates.rates) == POINTS
    assert rates.rates[-1] == 99 * 99 - 98 * 98
