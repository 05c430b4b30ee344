"""From Zenoh's threads to the loop: woken at once for what must not wait, once for much telemetry."""

from __future__ import annotations

from link.fleet.arrivals import MAX_WAITING, TURN, Arrivals


def test_the_loop_is_told_once_until_it_takes() -> None:
    arrivals = Arrivals()
    assert arrivals.put("a", b"1", 0.1, may_wait=True)
    assert not arrivals.put("a", b"2", 0.2, may_wait=True)
    assert not arrivals.put("a", b"3", 0.3, may_wait=False)
    assert arrivals.take() == [("a", b"1", 0.1), ("a", b"2", 0.2), ("a", b"3", 0.3)]
    assert arrivals.put("a", b"4", 0.4, may_wait=True)


def test_only_telemetry_waits_for_a_loop_that_looks_soon() -> None:
    arrivals = Arrivals()
    arrivals.expect(now=False)
    assert not arrivals.put("a", b"telemetry", 0.0, may_wait=True)
    assert arrivals.put("a", b"demand", 0.0, may_wait=False)
    assert not arrivals.put("a", b"demand", 0.0, may_wait=False)
    arrivals.expect(now=True)
    assert not arrivals.put("a", b"demand", 0.0, may_wait=False)


def test_a_flood_is_bounded_and_the_oldest_goes_first() -> None:
    arrivals = Arrivals()
    for number in range(MAX_WAITING + 5):
        arrivals.put("a", b"%d" % number, 0.0, may_wait=True)
    assert arrivals.dropped == 5
    assert [data for _, data, _ in arrivals.take()] == [b"%d" % number for number in range(5, 5 + TURN)]
    assert not arrivals.is_empty
    while arrivals.take():
        pass
    assert arrivals.is_empty
