"""Streams of a clock that was years ahead: back to the right time, and nothing of that time twice."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

from link.signing.memory_file import FILE, MemoryFileError, load_memory, save_memory
from link.signing.signing import Signing, SigningMemory
from link.signing.streams import SignedStream, Span, StreamTable
from link.signing.system_clock import is_synchronized
from link.signing.verifier import Refusal, Verified
from tests.link.signing.signed import ARM, DAY, DRIVER, NOON, NOW, WATCHER, keep, signed

FAR = NOW + 40 * 365 * DAY
MINE = SignedStream(DRIVER.fingerprint, 255, 190, 0)


def spoilt(wall: float = NOON, *, synchronized: bool, stamp: int = FAR) -> Signing:
    memory = SigningMemory(NOW - DAY, {MINE: stamp}, {WATCHER.fingerprint: stamp}, ended=True)
    return Signing(keep(DRIVER, WATCHER).ring, wall=wall, now=0.0, memory=memory, synchronized=synchronized)


@pytest.mark.parametrize(("ahead", "heals"), [(DAY, False), (DAY + 1, True)])
def test_a_stream_more_than_a_day_ahead_heals(ahead: int, heals: bool) -> None:
    streams = spoilt(synchronized=True, stamp=NOW + ahead).verifier.streams
    assert streams.newest[MINE] == (NOW if heals else NOW + ahead)
    assert streams.floors[WATCHER.fingerprint] == (NOW if heals else NOW + ahead)


def test_it_heals_as_soon_as_the_right_time_is_known() -> None:
    signing = spoilt(wall=12.0, synchronized=False)
    assert signing.verifier.check(signed(stamp=NOW + 5), 255, 190, 1.0) is Refusal.REPLAYED
    signing.update(NOON + 2.0, 2.0)
    assert signing.verifier.check(signed(stamp=NOW + 5), 255, 190, 2.0) is Refusal.REPLAYED
    signing.update(NOON + 3.0, 3.0, synchronized=True)
    assert isinstance(signing.verifier.check(signed(stamp=NOW + 400_000), 255, 190, 4.0), Verified)


def test_what_was_accepted_before_it_healed_is_a_replay_for_ever() -> None:
    signing = spoilt(synchronized=True)
    for stamp in (FAR, FAR - 29 * DAY, NOW, NOW - 1):
        assert signing.verifier.check(signed(ARM, stamp=stamp), 255, 190, 0.0) is Refusal.REPLAYED
        assert signing.verifier.check(signed(ARM, WATCHER, stamp, link_id=7), 255, 190, 0.0) is Refusal.REPLAYED
    later = Signing(signing.ring, wall=12.0, now=0.0, memory=signing.memory(9.0, ended=True))
    for stamp in (FAR, FAR - 29 * DAY):
        assert later.verifier.check(signed(ARM, stamp=stamp, link_id=9), 255, 190, 0.0) is Refusal.REPLAYED
    assert later.verifier.check(signed(ARM, stamp=FAR - 31 * DAY), 255, 190, 0.0) is not Refusal.REPLAYED


def test_spans_of_one_key_that_overlap_are_one_and_16_are_kept() -> None:
    table = StreamTable({MINE: FAR})
    table.heal(NOW, DAY)
    table.record(MINE, FAR + 10 * DAY)
    table.heal(NOW, DAY)
    assert table.spans == [Span(DRIVER.fingerprint, FAR - 30 * DAY, FAR + 10 * DAY)]
    for number in range(1, 20):
        table.record(MINE, FAR + 100 * number * DAY)
        table.heal(NOW, DAY)
    assert len(table.spans) == 16
    table.keep_keys([WATCHER.fingerprint])
    assert table.spans == []


def test_a_span_does_not_reach_back_to_the_right_time() -> None:
    table = StreamTable({MINE: NOW + 3 * DAY})
    table.heal(NOW, DAY)
    assert table.spans == [Span(DRIVER.fingerprint, NOW + DAY, NOW + 3 * DAY)]
    assert not table.is_replay(MINE, NOW + DAY)
    assert table.is_replay(MINE, NOW + DAY + 1)
    assert not table.is_replay(MINE, NOW + 3 * DAY + 1)


def test_spans_are_stored_and_files_without_them_are_read(tmp_path: Path) -> None:
    path = tmp_path / FILE
    memory = SigningMemory(NOW, {MINE: NOW}, {}, (Span(DRIVER.fingerprint, NOW + DAY, FAR),))
    save_memory(path, memory)
    assert load_memory(path) == memory
    path.write_text('{"stamp":5,"streams":[["ab",1,1,1,7]],"floors":{},"ended":true}')
    assert load_memory(path) == SigningMemory(5, {SignedStream("ab", 1, 1, 1): 7}, ended=True)
    many = ",".join(['["ab",1,2]'] * 17)
    for spans in (many, '["ab",-1,2]', f'["ab",1,{1 << 48}]'):
        path.write_text(f'{{"stamp":5,"streams":[],"floors":{{}},"spans":[{spans}]}}')
        with pytest.raises(MemoryFileError, match="damaged"):
            load_memory(path)


def test_the_kernel_says_whether_its_clock_is_right() -> None:
    assert is_synchronized() in (True, False)


def test_a_clock_that_was_right_before_heals_nothing_more() -> None:
    signing = spoilt(synchronized=True)
    signing.verifier.streams.record(MINE, FAR)
    signing.update(NOON + 1.0, 1.0, synchronized=True)
    assert signing.verifier.streams.newest[MINE] == FAR


def test_a_kernel_that_cannot_be_asked_knows_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("no C library")

    monkeypatch.setattr(ctypes, "CDLL", refuse)
    assert not is_synchronized()
