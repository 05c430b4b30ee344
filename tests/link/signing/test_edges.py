"""Edges of the stream table, the windows and the clock, each in a few frames."""

from __future__ import annotations

import pytest

from dialects import codec
from dialects.messages import RoverOperatorPresence
from link.signing.clock import FOLLOWED_MAX, TICKS, SigningClock, to_stamp
from link.signing.signature import STAMP_MAX, SecretHash, is_signed, strip_signature
from link.signing.signing import FrameSigner, Signing, SigningMemory
from link.signing.streams import SignedStream, Span, StreamTable
from link.signing.verifier import Refusal, Verified
from tests.link.frames import version_1
from tests.link.signing.signed import ARM, DAY, DRIVER, HEARTBEAT, NOON, NOW, WATCHER, keep, signed

MINE, THEIRS = DRIVER.fingerprint, WATCHER.fingerprint


def stream(number: int, key: str = MINE) -> SignedStream:
    return SignedStream(key, 1 + number // 250, number % 250, 0)


# ---- the table ----


def full(mine: int = 63, theirs: int = 1) -> StreamTable:
    table = StreamTable()
    for number in range(theirs):
        table.record(stream(number, THEIRS), 1 + number)
    for number in range(mine):
        table.record(stream(number), 1000 + number)
    return table


def test_65th_stream_takes_the_oldest_place_of_the_fullest_key() -> None:
    table = full()
    assert (len(table.newest), table.floors) == (64, {})
    table.record(stream(900), 5000)
    assert len(table.newest) == 64
    assert table.floors == {MINE: 1000}
    assert stream(0) not in table.newest
    assert stream(0, THEIRS) in table.newest
    assert table.is_replay(stream(0), 1000)
    assert not table.is_replay(stream(0), 1001)


def test_a_known_stream_takes_no_place_and_the_floor_only_rises() -> None:
    table = full()
    table.record(stream(5), 9000)
    assert (len(table.newest), table.floors) == (64, {})
    for number in range(900, 1000):
        table.record(stream(number), 10_000 - number)
    assert table.floors[MINE] >= 9000
    assert list(table.floors) == [MINE]


def test_the_counts_of_keys_decide_after_many_evictions() -> None:
    table = full(mine=40, theirs=24)
    for number in range(100):
        table.record(stream(500 + number, THEIRS), 20_000 + number)
    kept = [each.key for each in table.newest]
    assert len(kept) == 64
    assert abs(kept.count(MINE) - kept.count(THEIRS)) <= 1


def test_keys_that_are_gone_leave_nothing() -> None:
    table = full()
    table.record(stream(900), 5000)
    table.keep_keys([THEIRS])
    assert (list(table.newest), table.floors) == ([stream(0, THEIRS)], {})
    for number in range(64):
        table.record(stream(number, THEIRS), 100 + number)
    table.record(stream(70, THEIRS), 500)
    assert list(table.floors) == [THEIRS]


def test_the_newest_of_a_key_is_that_of_its_streams_and_floor() -> None:
    table = StreamTable({stream(0): 5, stream(1): 7, stream(2, THEIRS): 99}, {MINE: 6})
    assert (table.newest_of(MINE), table.newest_of(THEIRS), table.newest_of("none")) == (7, 99, -1)
    assert StreamTable({stream(0): 5}, {MINE: 6}).newest_of(MINE) == 6


def test_the_first_stamp_of_a_stream_may_be_0() -> None:
    assert not StreamTable().is_replay(stream(0), 0)
    assert StreamTable({stream(0): 0}).is_replay(stream(0), 0)


def test_a_stored_stream_runs_once_it_has_brought_a_frame() -> None:
    table = StreamTable({stream(0): 5})
    assert not table.is_running(stream(0))
    table.record(stream(0), 6)
    assert table.is_running(stream(0))
    assert not table.is_running(stream(1))


def test_a_span_refuses_the_stamps_of_its_key_alone() -> None:
    table = StreamTable(spans=[Span(THEIRS, 0, 10**9), Span(MINE, 100, 200), Span(MINE, 300, 400)])
    found = [table.is_replay(stream(0), stamp) for stamp in (100, 101, 200, 201, 300, 301, 400, 401)]
    assert found == [False, True, True, False, False, True, True, False]


def test_spans_that_touch_are_joined_and_others_are_not() -> None:
    month, key = 30 * DAY, stream(0)
    table = StreamTable({key: 100 * DAY})
    table.heal(0, DAY)
    assert table.spans == [Span(MINE, 100 * DAY - month, 100 * DAY)]
    table.newest[key] = 130 * DAY
    table.heal(0, DAY)
    assert table.spans == [Span(MINE, 70 * DAY, 130 * DAY)]
    table.newest[key] = 300 * DAY
    table.heal(0, DAY)
    assert table.spans == [Span(MINE, 70 * DAY, 130 * DAY), Span(MINE, 270 * DAY, 300 * DAY)]


# ---- windows ----


@pytest.mark.parametrize(
    ("ahead", "any_future", "passes"), [(DAY, False, True), (DAY + 1, False, False), (DAY + 1, True, True)]
)
def test_where_the_time_is_right_a_day_ahead_is_the_limit(ahead: int, any_future: bool, passes: bool) -> None:
    signing = Signing(keep(DRIVER).ring, wall=NOON, now=0.0, synchronized=True)
    found = signing.verifier.check(signed(stamp=NOW + ahead), 255, 190, 0.0, any_future=any_future)
    assert isinstance(found, Verified) if passes else found is Refusal.TOO_NEW


def test_stream_may_fall_behind_and_a_returning_key_begins_anew() -> None:
    signing = keep(DRIVER, wall=12.0)
    verifier = signing.verifier
    assert isinstance(verifier.check(signed(), 255, 190, 0.0), Verified)
    assert isinstance(verifier.check(signed(stamp=NOW + 1), 255, 190, 600.0), Verified)
    assert verifier.time_of(DRIVER, 600.0) == NOW + 600 * TICKS
    verifier.set_keys([WATCHER])
    verifier.set_keys([DRIVER])
    assert isinstance(verifier.check(signed(ARM, stamp=NOW - DAY), 255, 190, 600.0), Verified), "nothing is known of it"


def test_a_change_of_other_keys_keeps_the_time_of_a_key() -> None:
    verifier = keep(DRIVER, wall=12.0).verifier
    verifier.check(signed(), 255, 190, 0.0)
    verifier.set_keys([DRIVER, WATCHER])
    assert verifier.check(signed(ARM, stamp=NOW - 61 * TICKS, link_id=1), 255, 190, 0.0) is Refusal.TOO_OLD


def test_the_time_of_a_key_is_never_behind_clock_and_streams() -> None:
    signing = keep(DRIVER, WATCHER, wall=12.0, memory=SigningMemory(NOW))
    own = NOW + 60 * TICKS
    assert signing.verifier.time_of(DRIVER, 0.0) == own
    signing.verifier.check(signed(stamp=NOW + 30 * TICKS), 255, 190, 0.0)
    assert signing.verifier.time_of(DRIVER, 0.0) == own
    signing.verifier.check(signed(stamp=FOLLOWED_MAX + 1), 255, 190, 0.0)
    assert signing.verifier.time_of(DRIVER, 0.0) == FOLLOWED_MAX + 1
    assert isinstance(signing.verifier.check(signed(ARM, stamp=NOW + 31 * TICKS, link_id=1), 255, 190, 0.0), Verified)


def test_the_key_of_a_frame_is_found_or_not() -> None:
    verifier = keep(DRIVER).verifier
    assert verifier.find_key(signed()) is DRIVER
    assert verifier.find_key(signed(key=WATCHER)) is None


def test_a_sender_stays_pinned_for_10_s_at_any_time_of_day() -> None:
    verifier = keep(DRIVER, now=1000.0).verifier
    verifier.check(signed(), 255, 190, 1000.0)
    assert verifier.is_pinned(255, 190, 1010.0)
    assert not verifier.is_pinned(255, 190, 1010.1)


# ---- clock, memory, frames ----


def test_a_clock_a_little_ahead_of_the_stored_time_counts() -> None:
    clock = SigningClock(40.0 + 1_420_070_400.0, 7.0, stored=1)
    assert clock.stamp(7.0) == 60 * TICKS + 1
    later = SigningClock(100.0 + 1_420_070_400.0, 7.0, stored=1)
    assert later.stamp(7.0) == 100 * TICKS
    assert later.ahead(7.0) == 0.0


def test_trust_comes_with_a_plausible_time_and_stays() -> None:
    plausible = 1_767_225_600.0
    assert not SigningClock(plausible - 1.0, 0.0).trusted
    assert SigningClock(plausible, 0.0).trusted
    clock = SigningClock(0.0, 0.0)
    clock.update(plausible, 0.0)
    assert clock.trusted
    clock.update(0.0, 1.0)
    assert clock.trusted
    assert clock.stamp(1.0) == to_stamp(plausible) + TICKS
    assert clock.ahead(1.0) == pytest.approx(plausible - 1_420_070_400.0 + 1.0)


def test_the_computers_clock_lags_by_as_much_as_at_the_start() -> None:
    clock = SigningClock(NOON - 3600.0, 50.0, stored=NOW)
    assert clock.ahead(50.0) == 3660.0
    assert clock.ahead(60.0) == 3660.0


@pytest.mark.parametrize(("wall", "window"), [(NOON + 10.0, 5), (12.0, 60)])
def test_after_crash_the_window_is_short_where_the_clock_is_set(wall: float, window: int) -> None:
    after = keep(DRIVER, wall=wall, memory=SigningMemory(NOW))
    now = after.clock.stamp(0.0)
    assert isinstance(after.verifier.check(signed(stamp=now - window * TICKS), 255, 190, 0.0), Verified)
    late = signed(ARM, stamp=now - window * TICKS - 1, link_id=1)
    assert after.verifier.check(late, 255, 190, 0.0) is Refusal.TOO_OLD


def test_an_empty_memory_is_no_crash() -> None:
    assert (SigningMemory().stamp, SigningMemory().ended) == (0, False)
    first = keep(DRIVER, memory=SigningMemory())
    assert isinstance(first.verifier.check(signed(stamp=NOW - 60 * TICKS), 255, 190, 0.0), Verified)


def test_the_ring_in_use_is_the_newest() -> None:
    signing = keep(DRIVER)
    signing.set_ring(keep(WATCHER).ring)
    assert signing.ring.keys == (WATCHER,)


def test_the_last_timestamp_is_that_of_48_bits() -> None:
    assert STAMP_MAX == 2**48 - 1
    signer = FrameSigner(SigningClock(NOON, 0.0))
    frame = signer.sign(signed()[:-13], SecretHash(DRIVER.secret), 0, 1 << 48, 0.0)
    assert frame[-12:-6] == b"\xff" * 6


def test_mavlink_1_is_never_signed() -> None:
    for sequence in range(4):
        assert not is_signed(version_1(HEARTBEAT, sequence))


def test_the_signature_of_a_message_with_a_large_id_is_stripped() -> None:
    message = RoverOperatorPresence(1, 1, 1, 1, 1, 1, 1, 1)
    number = type(message).id
    assert number > 255
    plain = codec.frame(number, codec.encode_payload(message), 0, 255, 190)
    assert strip_signature(signed(message)) == plain
