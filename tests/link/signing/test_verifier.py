"""Which signed frames are genuine and new: forged, replayed, of another time, of another key, in any order."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.signing.clock import TICKS, to_stamp
from link.signing.keys import KeyRing, SigningKey
from link.signing.role import SigningRole
from link.signing.signature import STAMP_MAX
from link.signing.signing import Signing, SigningMemory
from link.signing.streams import MAX_STREAMS, SignedStream
from link.signing.verifier import Refusal, Verified
from tests.link.signing.signed import ARM, DAY, DRIVER, NOON, NOW, STRANGER, WATCHER, keep, signed
from tests.rows import each_row

GROUND = (255, 190)


def check(signing: Signing, frame: bytes, now: float = 0.0) -> SigningKey | Refusal:
    """Return whose frame it is, or why not."""
    found = signing.verifier.check(frame, frame[5], frame[6], now)
    return found.key if isinstance(found, Verified) else found


def test_a_genuine_frame_names_its_key_and_role() -> None:
    signing = keep(DRIVER, WATCHER)
    assert check(signing, signed()) is DRIVER
    assert check(signing, signed(key=WATCHER)) is WATCHER
    assert WATCHER.role is SigningRole.WATCH


@pytest.mark.parametrize("stamp", [STAMP_MAX, NOW, NOW - DAY, 0])
def test_75_a_forged_frame_of_any_time_changes_nothing(stamp: int) -> None:
    """pymavlink stores the time of a forged frame, and then refuses every genuine one for good."""
    signing = keep(DRIVER)
    check(signing, signed(stamp=NOW))
    before = signing.memory(0.0)
    assert check(signing, signed(ARM, STRANGER, stamp)) is Refusal.BAD_SIGNATURE
    assert signing.memory(0.0) == before
    assert check(signing, signed(stamp=NOW + 1)) is DRIVER


@given(st.binary(min_size=21, max_size=300), st.integers(0, 255), st.integers(0, 255))
def test_no_bytes_change_anything_without_the_key(noise: bytes, system: int, component: int) -> None:
    signing = keep(DRIVER, WATCHER)
    before = signing.memory(0.0)
    assert signing.verifier.check(noise, system, component, 0.0) is Refusal.BAD_SIGNATURE
    assert signing.memory(0.0) == before
    assert check(signing, signed()) is DRIVER


@given(st.integers(0, len(signed()) - 1), st.integers(0, 7))
def test_a_frame_with_one_wrong_bit_is_refused(byte: int, bit: int) -> None:
    frame = bytearray(signed())
    frame[byte] ^= 1 << bit
    assert keep(DRIVER).verifier.check(bytes(frame), 255, 190, 0.0) is Refusal.BAD_SIGNATURE


@each_row("byte", range(-13, 0))
def test_each_bit_of_the_signature_counts(byte: int) -> None:
    """Link id, 6 bytes of time and all 48 bits of the digest: of 16 bits every 65,536th guess would do."""
    for bit in range(8):
        frame = bytearray(signed())
        frame[byte] ^= 1 << bit
        assert keep(DRIVER).verifier.check(bytes(frame), 255, 190, 0.0) is Refusal.BAD_SIGNATURE


def test_76_a_frame_is_accepted_once() -> None:
    signing = keep(DRIVER)
    frames = [signed(ARM, stamp=NOW + n) for n in range(3)]
    assert [check(signing, frame) for frame in frames] == [DRIVER] * 3
    assert [check(signing, frame) for frame in frames] == [Refusal.REPLAYED] * 3


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 40)), max_size=120))
def test_no_frame_is_accepted_twice_in_any_order(arrivals: list[tuple[int, int]]) -> None:
    signing, accepted = keep(DRIVER), []
    for link_id, stamp in arrivals:
        if check(signing, signed(ARM, stamp=NOW + stamp, link_id=link_id)) is DRIVER:
            accepted.append((link_id, stamp))
    assert len(accepted) == len(set(accepted))
    for wanted in range(3):
        stamps = [stamp for link_id, stamp in accepted if link_id == wanted]
        assert stamps == sorted(stamps)


@settings(max_examples=20)
@given(st.lists(st.tuples(st.integers(0, 255), st.integers(0, 3)), min_size=MAX_STREAMS, max_size=3 * MAX_STREAMS))
def test_no_frame_is_accepted_twice_among_many_streams(arrivals: list[tuple[int, int]]) -> None:
    """A stream that loses its place leaves a time behind, before which its key begins none."""
    signing = keep(DRIVER)
    frames = [signed(ARM, stamp=NOW + n, link_id=link, ids=(255, 190 + row)) for n, (link, row) in enumerate(arrivals)]
    assert all(check(signing, frame) is DRIVER for frame in frames)
    assert not any(check(signing, frame) is DRIVER for frame in frames)


def test_77_a_frame_of_one_link_is_a_replay_on_every_other() -> None:
    """All links of a program ask one verifier; only another link id, which is signed, makes another stream."""
    signing, frame = keep(DRIVER), signed(ARM, link_id=3)
    assert check(signing, frame) is DRIVER
    assert check(signing, frame) is Refusal.REPLAYED
    assert check(signing, signed(ARM, stamp=NOW - 1, link_id=4)) is DRIVER


def test_yesterdays_frames_are_refused_on_every_link_id() -> None:
    signing = keep(DRIVER)
    for link_id in range(256):
        assert check(signing, signed(ARM, stamp=NOW - DAY, link_id=link_id)) is Refusal.TOO_OLD
    assert signing.verifier.behind[255] == pytest.approx(86_400)


@pytest.mark.parametrize(("late", "accepted"), [(6_000_000, True), (6_000_001, False)])
def test_a_stream_may_begin_a_minute_behind_our_clock(late: int, accepted: bool) -> None:
    assert (check(keep(DRIVER), signed(stamp=NOW - late)) is DRIVER) is accepted


def test_78_a_peer_whose_clock_is_years_ahead_locks_nobody_out() -> None:
    """Its frames are genuine, but its time is not taken over while ours is right: not even for its own key."""
    signing = keep(DRIVER, WATCHER)
    for key in (WATCHER, DRIVER):
        assert check(signing, signed(stamp=NOW + 3650 * DAY, key=key, ids=(254, 190))) is key
    assert signing.clock.stamp(1.0) == NOW + 100_000
    assert check(signing, signed(), 1.0) is DRIVER
    assert check(signing, signed(ids=(250, 1)), 1.0) is DRIVER


def test_another_key_with_same_ids_and_future_locks_nobody_out() -> None:
    signing = keep(DRIVER, WATCHER)
    assert check(signing, signed(key=WATCHER, stamp=STAMP_MAX)) is WATCHER
    assert check(signing, signed(ARM)) is DRIVER


def test_79_a_boot_in_1970_goes_on_after_the_last_run() -> None:
    before = keep(DRIVER)
    yesterday = [signed(ARM, stamp=NOW + n) for n in range(3)]
    for frame in yesterday:
        check(before, frame)
    after = keep(DRIVER, wall=12.0, memory=before.memory(30.0), now=5.0)
    assert not after.clock.trusted
    assert after.clock.stamp(5.0) == NOW + 30 * 100_000 + 60 * 100_000
    assert [check(after, frame, 5.0) for frame in yesterday] == [Refusal.REPLAYED] * 3
    assert check(after, signed(ARM, stamp=NOW - 1, link_id=9), 5.0) is Refusal.TOO_OLD
    assert check(after, signed(stamp=NOW + DAY), 5.0) is DRIVER
    assert after.verifier.time_of(DRIVER, 6.0) == NOW + DAY + 100_000, "this key has shown a later time"
    assert check(after, signed(ARM, stamp=NOW + 120 * 100_000, link_id=7), 6.0) is Refusal.TOO_OLD


def test_81_100000_streams_keep_64_places_and_spare_other_keys() -> None:
    signing = keep(DRIVER, WATCHER)
    mine = signed(ARM)
    assert check(signing, mine) is DRIVER
    streams = signing.verifier.streams
    for n in range(100_000):  # 10^5 streams
        streams.record(SignedStream(WATCHER.fingerprint, 1 + n // 256 % 250, n // 64_000, n % 256), NOW + n)
    assert len(streams.newest) == MAX_STREAMS == 64
    assert streams.floors == {WATCHER.fingerprint: NOW + 99_999 - (MAX_STREAMS - 1)}
    assert check(signing, mine) is Refusal.REPLAYED
    assert check(signing, signed(stamp=NOW + 1)) is DRIVER


def test_a_key_that_is_withdrawn_is_unknown_at_once() -> None:
    signing = keep(DRIVER, WATCHER)
    check(signing, signed(key=WATCHER))
    signing.set_ring(signing.ring.remove(WATCHER.name))
    assert check(signing, signed(key=WATCHER, stamp=NOW + 1)) is Refusal.BAD_SIGNATURE
    assert check(signing, signed()) is DRIVER


def test_a_key_named_like_a_removed_one_is_another_key() -> None:
    signing = keep(DRIVER, WATCHER)
    assert signing.hash_of(DRIVER) is not None
    assert STRANGER.name == DRIVER.name
    signing.set_ring(signing.ring.remove(DRIVER.name).add(STRANGER))
    assert signing.hash_of(DRIVER) is None
    assert signing.hash_of(WATCHER) is not None
    found = signing.hash_of(STRANGER)
    assert found is not None
    assert found.matches(signed(key=STRANGER))
    assert signing.hash_of(None) is None


def test_a_key_whose_name_or_role_has_changed_signs_as_before() -> None:
    signing = keep(DRIVER)
    signing.set_ring(KeyRing((SigningKey("renamed", SigningRole.WATCH, DRIVER.secret),), "renamed"))
    found = signing.hash_of(DRIVER)
    assert found is not None
    assert found.matches(signed())


def test_a_sender_that_signs_has_its_ids_for_itself() -> None:
    signing = keep(DRIVER)
    assert not signing.verifier.is_pinned(*GROUND, 0.0)
    check(signing, signed())
    assert signing.verifier.is_pinned(*GROUND, 10.0)
    assert not signing.verifier.is_pinned(*GROUND, 10.1)
    assert not signing.verifier.is_pinned(254, 190, 0.0)


@given(st.lists(st.sampled_from([-3650 * 86_400.0, -3600.0, 0.0, 3600.0, 3650 * 86_400.0]), max_size=6))
def test_steps_of_the_computers_clock_open_no_replay(steps: list[float]) -> None:
    """Not of frames of known streams, and of no others that are a minute older than the newest."""
    signing, wall, now = keep(DRIVER), NOON, 0.0
    frame = signed(ARM)
    assert check(signing, frame) is DRIVER
    for step in steps:
        wall, now = wall + step, now + 61.0
        signing.update(wall + now, now)
        assert check(signing, frame, now) is Refusal.REPLAYED
        assert check(signing, signed(ARM, stamp=NOW - 1, link_id=1), now) is Refusal.TOO_OLD
    after = keep(DRIVER, wall=wall + now, memory=signing.memory(now), now=now)
    assert check(after, frame, now) is Refusal.REPLAYED


def test_first_run_without_clock_learns_the_time_of_a_key_holder() -> None:
    signing = keep(DRIVER, wall=40.0, memory=SigningMemory())
    assert signing.clock.stamp(0.0) == 0
    assert check(signing, signed()) is DRIVER
    assert check(signing, signed(ARM, stamp=NOW - DAY, link_id=1)) is Refusal.TOO_OLD
    assert signing.clock.stamp(0.0) == to_stamp(40.0), "a peer's clock is not kept for the next run"


def test_other_keys_do_not_unpin_a_sender_whose_key_stays() -> None:
    """Else a forger without a key would be believed whenever somebody adds one."""
    verifier = keep(DRIVER).verifier
    assert isinstance(verifier.check(signed(), 255, 190, 0.0), Verified)
    verifier.set_keys([DRIVER, WATCHER])
    assert verifier.is_pinned(255, 190, 1.0)
    less = SigningKey(DRIVER.name, SigningRole.WATCH, DRIVER.secret)
    verifier.set_keys([less, WATCHER])
    assert not verifier.is_pinned(255, 190, 1.0)
    again = verifier.check(signed(stamp=NOW + 1), 255, 190, 1.0)
    assert isinstance(again, Verified)
    assert again.key.role is SigningRole.WATCH


def test_of_many_senders_the_oldest_is_forgotten() -> None:
    verifier = keep(DRIVER).verifier
    for component in range(1, MAX_STREAMS + 2):
        verifier.check(signed(stamp=NOW + component, ids=(255, component)), 255, component, 0.0)
    assert not verifier.is_pinned(255, 1, 0.0)
    assert verifier.is_pinned(255, 2, 0.0)
    assert verifier.is_pinned(255, MAX_STREAMS + 1, 0.0)


@each_row("link_id", [0, 9])
@each_row(
    ("ended", "ago", "found"),
    [
        (False, 3600, Refusal.TOO_OLD),
        (False, 55, Refusal.TOO_OLD),
        (False, 6, Refusal.TOO_OLD),
        (False, 4, DRIVER),
        (True, 6, DRIVER),
        (True, 61, Refusal.TOO_OLD),
    ],
)
def test_frames_from_before_a_crash_are_refused_in_all_streams(
    link_id: int, ended: bool, ago: int, found: SigningKey | Refusal
) -> None:
    """An arming 10 s after the last store, recorded, and sent again `ago` s later, after a restart."""
    before = keep(DRIVER)
    check(before, signed())
    memory = before.memory(0.0, ended=ended)
    after = keep(DRIVER, wall=NOON + 10 + ago, memory=memory)
    assert check(after, signed(ARM, stamp=NOW + 10 * TICKS, link_id=link_id)) is found


def test_minute_after_a_crash_new_streams_may_be_a_minute_behind() -> None:
    memory = keep(DRIVER).memory(0.0)
    after = keep(DRIVER, wall=NOON + 10, memory=memory)
    late = signed(stamp=NOW + 60 * TICKS)
    assert check(after, late, 59.9) is Refusal.TOO_OLD
    assert check(after, late, 60.1) is DRIVER
