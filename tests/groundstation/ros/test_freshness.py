"""Messages that were held up on the way."""

from __future__ import annotations

from groundstation.ros.freshness import MAX_LATENESS, MAX_PUBLISHERS, MEMORY, LatenessCheck

SECOND = 1_000_000_000
YEARS = 50 * 365 * 86400 * SECOND
"""Unix time, ns: the clocks have nothing in common."""


def test_a_steady_publisher_is_never_late() -> None:
    check = LatenessCheck()
    assert all(check.lateness(b"a", YEARS + n * SECOND // 10, 100 + n / 10) < 0.001 for n in range(1000))


def test_what_a_router_held_up_is_late() -> None:
    check = LatenessCheck()
    for n in range(20):
        check.lateness(b"a", YEARS + n * SECOND // 10, 100 + n / 10)
    stamps = [YEARS + 2 * SECOND + n * SECOND // 10 for n in range(50)]
    late = [check.lateness(b"a", stamp, 107.0) for stamp in stamps]
    assert all(each > MAX_LATENESS for each in late[:46])
    assert late[-1] <= MAX_LATENESS, "the last one has just been sent"


def test_a_clock_that_is_set_back_is_trusted_again_after_a_while() -> None:
    check = LatenessCheck()
    back = [check.lateness(b"a", YEARS + n * SECOND // 10 - (n >= 50) * 3600 * SECOND, n / 10) for n in range(300)]
    assert max(back[:50]) < 0.001
    assert min(back[50 : 50 + int(MEMORY * 10)]) > MAX_LATENESS
    assert max(back[-100:]) < 0.001


def test_a_clock_that_is_set_forward_is_trusted_at_once() -> None:
    check = LatenessCheck()
    check.lateness(b"a", YEARS, 0.0)
    assert check.lateness(b"a", YEARS + 3600 * SECOND, 0.1) == 0.0


def test_publishers_are_apart_and_bounded() -> None:
    check = LatenessCheck()
    check.lateness(b"a", YEARS, 0.0)
    assert check.lateness(b"b", 0, 0.0) == 0.0
    for number in range(3 * MAX_PUBLISHERS):
        check.lateness(str(number).encode(), 0, 0.0)
    assert len(check._publishers) <= MAX_PUBLISHERS
