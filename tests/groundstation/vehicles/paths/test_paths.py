"""What counts of two paths to one vehicle, which is the best, and where questions go."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Result
from groundstation.vehicles.paths.path import Path
from groundstation.vehicles.paths.paths import LONG_SILENCE, SERVED, SILENCE, STAY, Paths
from groundstation.vehicles.paths.questions import PATIENCE, RETURN_AFTER, Questions
from link.core import Peer, Received

A, B = Peer(0, "a"), Peer(1, "b")
HEARTBEAT = m.Heartbeat(type=10, autopilot=0, base_mode=0, custom_mode=0, system_status=3, mavlink_version=3)


def attitude(boot: float) -> m.Attitude:
    return m.Attitude(round(boot * 1000), 0, 0, 0, 0, 0, 0)


class Bench:
    """The paths to one vehicle that has started at 0 s by our clock."""

    def __init__(self) -> None:
        self.paths = Paths(1)

    def bring(self, peer: Peer, message: m.Message, now: float) -> bool:
        return self.paths.receive(Received(message, 1, 1, 0, peer, introduced=True), now)

    def both(self, start: float, end: float, *, lag: float = 0.0) -> None:
        """ATTITUDE at 10 Hz on both paths; on the second one it is late."""
        now = start
        while now < end:
            self.bring(A, attitude(now), now)
            self.bring(B, attitude(now - lag), now)
            now += 0.1


def test_all_of_the_only_path_counts_also_what_goes_back() -> None:
    bench = Bench()
    assert all(bench.bring(A, message, 1.0) for message in (attitude(5.0), attitude(4.9), HEARTBEAT, HEARTBEAT))
    assert bench.paths.boot_time == 4900


def test_state_with_a_time_counts_if_no_path_has_brought_newer() -> None:
    bench = Bench()
    bench.both(1.0, 2.0)
    assert bench.bring(B, attitude(2.0), 2.0)
    assert not bench.bring(A, attitude(2.0), 2.0)
    assert not bench.bring(A, attitude(1.9), 2.01)
    assert bench.bring(A, attitude(2.1), 2.1)
    assert bench.paths.boot_time == 2100


def test_a_late_path_changes_neither_the_clock_nor_the_state() -> None:
    bench = Bench()
    bench.both(3.0, 5.0, lag=2.0)
    assert bench.bring(A, HEARTBEAT, 5.0)
    assert not bench.bring(B, HEARTBEAT, 5.0)
    assert bench.paths.boot_time == pytest.approx(4900, abs=101)
    late = bench.paths.get(B)
    assert late is not None
    assert late.lag == pytest.approx(2.0, abs=0.01)
    assert late.age(5.0) == pytest.approx(2.0, abs=0.01)


def test_a_late_path_left_alone_counts_once_it_has_caught_up() -> None:
    bench = Bench()
    bench.both(3.0, 5.0, lag=2.0)
    counted = []
    for tenth in range(50, 90):
        now = tenth / 10
        counted.append((bench.bring(B, attitude(now - 2.0), now), bench.bring(B, HEARTBEAT, now)))
    assert bench.paths.best is bench.paths.get(B)
    assert not any(attitude_counts for attitude_counts, _ in counted[:19])
    assert not any(beat for _, beat in counted[:16])
    assert all(both == (True, True) for both in counted[21:])


def test_state_without_a_time_counts_of_one_path_while_it_comes() -> None:
    bench = Bench()
    bench.both(1.0, 2.0)
    assert bench.bring(A, HEARTBEAT, 2.0)
    assert not bench.bring(B, HEARTBEAT, 2.0)
    bench.both(2.1, 2.1 + SERVED)
    assert bench.bring(B, HEARTBEAT, 2.1 + SERVED)
    assert bench.bring(A, HEARTBEAT, 2.1 + SERVED)  # the best path has it again
    assert not bench.bring(B, HEARTBEAT, 2.2 + SERVED)


def test_events_count_as_often_as_one_path_has_told_them() -> None:
    bench, text, other = Bench(), m.StatusText(6, b"hit a wall"), m.StatusText(6, b"again")
    bench.both(1.0, 2.0)
    assert bench.bring(A, text, 2.0)
    assert not bench.bring(B, text, 2.1)
    assert bench.bring(B, text, 2.2)
    assert not bench.bring(A, text, 2.3)
    assert bench.bring(B, other, 2.3)
    assert bench.bring(A, text, 60.0)


def test_answers_count_on_each_path() -> None:
    bench, value = Bench(), m.ParamValue(b"SPEED", 1.0, 9, 1, 0)
    bench.both(1.0, 2.0)
    assert bench.bring(A, value, 2.0)
    assert bench.bring(B, value, 2.0)


def test_another_path_counts_after_a_short_silence_of_the_best() -> None:
    bench = Bench()
    bench.both(1.0, 2.0)
    assert bench.paths.best is bench.paths.get(A)
    for number in range(4):
        bench.bring(B, attitude(2.0 + number / 10), 1.9 + SILENCE / 4 * (number + 1))
    assert bench.paths.best is bench.paths.get(A)
    bench.bring(B, attitude(2.4), 1.95 + SILENCE)
    assert bench.paths.best is bench.paths.get(B)


def test_paths_with_heartbeats_in_turn_do_not_change_places() -> None:
    bench = Bench()
    for second in range(10):
        bench.bring(A, HEARTBEAT, second)
        bench.bring(B, HEARTBEAT, second + 0.5)
        assert bench.paths.best is bench.paths.get(A)
    bench.bring(B, HEARTBEAT, 9.01 + LONG_SILENCE)
    assert bench.paths.best is bench.paths.get(B)


def test_a_path_that_is_much_better_becomes_the_best() -> None:
    bench = Bench()
    bench.both(1.0, 2.0 + STAY)
    measured = {0: 0.4, 1: 0.0}
    bench.paths.observe(measured.get, lambda peer: 0.02, 2.0 + STAY)
    assert bench.paths.best is bench.paths.get(B)
    measured = {0: 0.0, 1: 0.1}
    bench.paths.observe(measured.get, lambda peer: 0.02, 3.0 + 2 * STAY)
    assert bench.paths.best is bench.paths.get(B)  # a little better is not enough


def test_after_a_reboot_what_is_from_before_does_not_count() -> None:
    bench = Bench()
    bench.both(100.0, 102.0, lag=1.0)
    assert bench.bring(A, attitude(0.1), 102.0)
    assert bench.paths.boot_time == 100
    assert not bench.bring(B, attitude(101.0), 102.0)
    assert not bench.bring(B, HEARTBEAT, 102.0)
    assert bench.paths.boot_time == 100
    assert not bench.bring(B, attitude(0.1), 103.0)  # a copy, of this boot
    assert bench.bring(B, attitude(1.2), 103.1)


def test_a_vehicle_back_from_another_address_is_followed() -> None:
    bench = Bench()
    bench.bring(A, attitude(100.0), 100.0)
    for tenth in range(1, 6):
        bench.bring(B, attitude(tenth / 10), 101.0 + tenth / 10)
    assert bench.paths.best is bench.paths.get(B)
    assert bench.paths.boot_time == 500


def test_paths_to_two_vehicles_are_not_joined() -> None:
    bench = Bench()
    bench.both(1.0, 2.0)
    bench.paths.apart = True
    assert bench.bring(A, HEARTBEAT, 2.0)
    assert bench.bring(B, HEARTBEAT, 2.0)
    assert bench.bring(B, attitude(0.5), 2.0)


def test_invented_addresses_fill_no_table() -> None:
    bench = Bench()
    for number in range(1000):
        bench.bring(Peer(0, number), attitude(number), number / 1000)
        bench.bring(A, HEARTBEAT, number / 1000)
    assert len(bench.paths.live(1.0)) <= 16


def test_a_question_without_an_answer_takes_the_next_path() -> None:
    questions, first, second = Questions(), Path(A), Path(B)
    live = [first, second]
    assert questions.choose(live, 1.0) is first
    assert questions.choose(live, 1.0 + PATIENCE / 2) is first
    assert questions.choose(live, 1.01 + PATIENCE) is second
    questions.note_answer(m.CommandAck(400, Result.ACCEPTED, 0, 0, 255, 190))
    assert questions.choose(live, 1.5 + PATIENCE) is second  # it has answered
    questions.note_answer(m.CommandAck(400, Result.TEMPORARILY_REJECTED, 0, 0, 255, 190))
    assert questions.choose(live, 1.6 + 2 * PATIENCE) is first
    assert questions.choose(live, 2.0 + 2 * PATIENCE + RETURN_AFTER) is first


def test_questions_take_no_late_path_while_there_is_another() -> None:
    questions, first, late = Questions(), Path(A), Path(B, lag=2.0)
    assert all(questions.choose([first, late], 1.0 + number) is first for number in range(5))
    assert questions.choose([late], 9.0) is late
