"""Exact ends of the windows of a verifier, and what it forgets with a key."""

from __future__ import annotations

import pytest

from link.signing.clock import FOLLOWED_MAX, TICKS, SigningClock
from link.signing.keys import KeyRing
from link.signing.signature import is_signed, link_and_stamp
from link.signing.signing import FrameSigner, Signing, SigningMemory
from link.signing.streams import SignedStream, Span, StreamTable
from link.signing.system_clock import is_right
from link.signing.verifier import Refusal, Verified, Verifier
from tests.link.signing.signed import DAY, DRIVER, NOON, NOW, STRANGER, WATCHER, keep, signed

MINE = DRIVER.fingerprint


def check(
    verifier: Verifier, stamp: int, now: float = 0.0, *, link: int = 0, system: int = 255, future: bool = False
) -> Refusal | None:
    """Return why a frame of the driver is refused, None if it is accepted."""
    ids = (system, 190)
    found = verifier.check(signed(stamp=stamp, link_id=link, ids=ids), *ids, now, any_future=future)
    return None if isinstance(found, Verified) else found


def unset() -> Verifier:
    """A verifier of a computer whose clock is not set."""
    return keep(DRIVER, WATCHER, wall=0.0).verifier


def test_a_running_stream_may_fall_behind() -> None:
    verifier = keep(DRIVER).verifier
    assert check(verifier, NOW) is None
    assert check(verifier, NOW + 1, 100.0) is None
    assert check(verifier, NOW + 2, 100.0, link=1) is Refusal.TOO_OLD


@pytest.mark.parametrize(("ahead", "refusal"), [(0, None), (DAY, None), (DAY + 1, Refusal.TOO_NEW)])
def test_a_right_clock_refuses_more_than_a_day_ahead(ahead: int, refusal: Refusal | None) -> None:
    right = Signing(KeyRing().add(DRIVER), wall=NOON, now=0.0, synchronized=True)
    assert check(right.verifier, NOW + ahead) is refusal
    right = Signing(KeyRing().add(DRIVER), wall=NOON, now=0.0, synchronized=True)
    assert check(right.verifier, NOW + ahead, future=True) is None
    assert check(keep(DRIVER).verifier, NOW + ahead) is None, "nobody knows the right time"


def test_the_time_of_a_key_follows_its_newest_frame() -> None:
    verifier = unset()
    assert check(verifier, NOW) is None
    assert check(verifier, NOW + 1, 10.0) is None
    assert check(verifier, NOW + 10 * TICKS - 60 * TICKS - 1, 10.0, link=1) is Refusal.TOO_OLD
    assert check(verifier, NOW + 10 * TICKS - 60 * TICKS, 10.0, link=1) is None
    assert check(verifier, NOW + 100 * TICKS, 10.0) is None
    assert check(verifier, NOW + 30 * TICKS, 10.0, link=2) is Refusal.TOO_OLD


def test_the_time_of_a_key_follows_up_to_2100() -> None:
    for ahead, refusal in ((0, Refusal.TOO_OLD), (1, None)):
        verifier = unset()
        assert check(verifier, FOLLOWED_MAX + ahead) is None
        assert check(verifier, FOLLOWED_MAX - 61 * TICKS, link=1) is refusal


def test_what_is_known_of_a_key_goes_with_it() -> None:
    verifier = unset()
    assert check(verifier, NOW) is None
    verifier.set_keys([DRIVER, WATCHER])
    assert check(verifier, NOW) is Refusal.REPLAYED
    assert check(verifier, NOW - 61 * TICKS, link=1) is Refusal.TOO_OLD
    verifier.set_keys([WATCHER])
    verifier.set_keys([DRIVER])
    assert check(verifier, NOW - 61 * TICKS, link=1) is None
    assert check(verifier, NOW) is None


def test_a_verifier_without_memory_begins_empty() -> None:
    assert check(Verifier([DRIVER], SigningClock(NOON, 0.0)), NOW) is None


@pytest.mark.parametrize(("now", "refusal"), [(59.99, Refusal.TOO_OLD), (60.0, None)])
@pytest.mark.parametrize("stored", [1, NOW - 100 * TICKS])
def test_after_a_crash_the_window_is_short_for_a_minute(stored: int, now: float, refusal: Refusal | None) -> None:
    crashed = keep(DRIVER, memory=SigningMemory(stored))
    assert check(crashed.verifier, NOW + int(now * TICKS) - 30 * TICKS, now) is refusal
    ended = keep(DRIVER, memory=SigningMemory(stored, ended=True))
    assert check(ended.verifier, NOW + int(now * TICKS) - 30 * TICKS, now) is None


def test_the_window_after_a_crash_is_5_s() -> None:
    for behind, refusal in ((5 * TICKS, None), (5 * TICKS + 1, Refusal.TOO_OLD)):
        assert check(keep(DRIVER, memory=SigningMemory(1)).verifier, NOW - behind) is refusal


def test_the_first_run_has_the_whole_window() -> None:
    assert check(keep(DRIVER).verifier, NOW - 30 * TICKS) is None


def test_a_clock_that_has_become_right_is_behind_no_more() -> None:
    verifier = keep(DRIVER).verifier
    assert check(verifier, NOW - 90 * TICKS) is Refusal.TOO_OLD
    assert verifier.behind == {255: 90.0}
    assert check(verifier, NOW) is None
    assert verifier.behind == {}


def test_a_known_sender_takes_no_place_of_another() -> None:
    verifier = keep(DRIVER).verifier
    for system in range(1, 65):
        assert check(verifier, NOW + system, system=system) is None
    assert check(verifier, NOW + 100, system=64) is None
    assert all(verifier.is_pinned(system, 190, 0.0) for system in range(1, 65))
    assert check(verifier, NOW + 101, system=65) is None
    assert [system for system in range(1, 66) if not verifier.is_pinned(system, 190, 0.0)] == [1]


def test_by_default_nothing_is_ahead_and_no_run_has_crashed() -> None:
    right = Signing(KeyRing().add(DRIVER), wall=NOON, now=0.0, synchronized=True)
    assert right.verifier.check(signed(stamp=NOW + DAY + 1), 255, 190, 0.0) is Refusal.TOO_NEW
    right.update(NOON + 1.0, 1.0)
    assert not right.clock.synchronized
    assert check(Verifier([DRIVER], SigningClock(NOON, 0.0)), NOW - 30 * TICKS) is None
    assert SigningMemory() == SigningMemory(0, {}, {}, (), ended=False)
    assert not right.memory(1.0).ended


# ---- the table of streams ----


def streams(count: int) -> dict[SignedStream, int]:
    return {SignedStream(MINE, 1, number, 0): 1000 + number for number in range(count)}


def test_a_floor_never_falls() -> None:
    table = StreamTable(streams(64), {MINE: 5000})
    table.record(SignedStream(MINE, 2, 1, 0), 6000)
    assert table.floors == {MINE: 5000}


def test_a_stream_that_began_at_0_leaves_that_floor() -> None:
    table = StreamTable({each: number for number, each in enumerate(streams(64))})
    table.record(SignedStream(MINE, 2, 1, 0), 6000)
    assert table.floors == {MINE: 0}
    assert not table.is_replay(SignedStream(MINE, 1, 0, 0), 1)


def test_a_key_that_is_gone_does_not_count() -> None:
    table = StreamTable(streams(64))
    table.keep_keys([STRANGER.fingerprint])
    for number in range(65):
        table.record(SignedStream(STRANGER.fingerprint, 3, number, 0), number)
    assert len(table.newest) == 64


def test_a_floor_of_years_ahead_is_healed() -> None:
    table = StreamTable({}, {MINE: NOW + 10 * DAY})
    table.heal(NOW, DAY)
    assert table.floors == {MINE: NOW}
    assert table.spans == [Span(MINE, NOW + DAY, NOW + 10 * DAY)]


@pytest.mark.parametrize(
    ("kept", "spans"),
    [
        (Span(MINE, NOW + 21 * DAY, NOW + 22 * DAY), 2),
        (Span(MINE, NOW + 10 * DAY, NOW + 22 * DAY), 1),
        (Span(MINE, NOW - 9 * DAY, NOW + DAY), 1),
        (Span(MINE, NOW - 9 * DAY, NOW), 2),
        (Span("another", NOW + DAY, NOW + 22 * DAY), 2),
    ],
)
def test_spans_that_touch_are_joined(kept: Span, spans: int) -> None:
    table = StreamTable({SignedStream(MINE, 1, 1, 0): NOW + 10 * DAY}, spans=[kept])
    table.heal(NOW, DAY)
    assert len(table.spans) == spans
    low, high = min(each.after for each in table.spans), max(each.until for each in table.spans)
    assert (low, high) == (min(kept.after, NOW + DAY), max(kept.until, NOW + 10 * DAY))


# ---- clock and signer ----


def test_a_clock_in_1970_begins_at_0() -> None:
    assert SigningClock(0.0, 0.0).stamp(0.0) == 0


def test_a_clock_that_catches_up_is_trusted_at_that_moment() -> None:
    clock = SigningClock(0.0, 0.0, NOW)
    assert (clock.stamp(0.0), clock.trusted) == (NOW + 60 * TICKS, False)
    clock.update(NOON + 59.0, 0.0)
    assert not clock.trusted
    clock.update(NOON + 60.0, 0.0, synchronized=True)
    assert clock.trusted
    assert clock.synchronized
    clock.update(NOON + 61.0, 1.0)
    assert not clock.synchronized


def test_a_clock_in_1970_is_not_right_whatever_the_system_says() -> None:
    clock = SigningClock(0.0, 0.0, synchronized=True)
    assert not clock.synchronized
    for wall in (100.0, 1_600_000_000.0):
        clock.update(wall, 1.0, synchronized=True)
        assert not clock.synchronized


def test_a_clock_is_never_ahead_by_less_than_nothing() -> None:
    assert SigningClock(NOON, 0.0).ahead(0.000_005) == 0.0


def test_the_first_timestamp_of_a_signer_is_1() -> None:
    signer = FrameSigner(SigningClock(0.0, 0.0))
    ring = keep(DRIVER)
    by = ring.hash_of(DRIVER)
    assert by is not None
    frame = signed(stamp=5)[:-13]
    found = [signer.sign(frame, by, 3, 0, 0.0) for _ in range(2)]
    assert all(is_signed(each) for each in found)
    assert [link_and_stamp(each) for each in found] == [(3, 1), (3, 2)]


@pytest.mark.parametrize(("state", "right"), [(-1, False), (0, True), (1, True), (4, True), (5, False), (6, False)])
def test_states_of_the_kernels_clock(state: int, right: bool) -> None:
    """TIME_OK to TIME_WAIT are those of a clock that is kept right; 5 is TIME_ERROR."""
    assert is_right(state) is right
