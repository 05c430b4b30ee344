from __future__ import annotations

import threading
from collections.abc import Callable

from vehicle.sensors.latest import LatestValue
from vehicle.sensors.sampler import Sampler


def test_a_value_counts_for_its_time_and_no_longer() -> None:
    latest = LatestValue[int](max_age=2.0)
    assert latest.get(0.0) is None
    latest.update(7, 10.0)
    assert latest.get(12.0) == 7
    assert latest.get(12.1) is None


def test_a_fault_is_told_in_one_line_and_forgotten_with_a_value() -> None:
    latest = LatestValue[int](max_age=2.0)
    latest.update(7, 10.0)
    latest.set_fault(OSError("two\nlines"))
    assert (latest.get(10.0), latest.fault) == (7, "two lines")
    latest.update(8, 11.0)
    assert latest.fault is None
    latest.set_fault(ValueError())
    assert latest.fault == "ValueError"


class Steps:
    """A sensor that gives one answer after another, and tells when the last was taken."""

    def __init__(self, *answers: int | Exception) -> None:
        self.answers = list(answers)
        self.done = threading.Event()

    def sample(self) -> int:
        if len(self.answers) == 1:
            self.done.set()
            threading.Event().wait(0.01)
        answer = self.answers[0] if len(self.answers) == 1 else self.answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer


def sampled(steps: Steps, clock: Callable[[], float]) -> Sampler[int]:
    return Sampler(steps.sample, period=0.001, max_age=2.0, clock=clock)


def test_it_goes_on_after_anything_that_a_sensor_raises() -> None:
    steps = Steps(1, OSError("gone"), ZeroDivisionError(), 2)
    sampler = sampled(steps, lambda: 50.0)
    assert steps.done.wait(60)
    sampler.close()
    assert sampler.latest(50.0) == 2
    assert sampler.fault is None


def test_a_sensor_that_fails_ages_out() -> None:
    times = iter([50.0])
    steps = Steps(1, OSError("gone"))
    sampler = sampled(steps, times.__next__)
    assert steps.done.wait(60)
    sampler.close()
    assert sampler.fault == "gone"
    assert sampler.latest(52.0) == 1
    assert sampler.latest(52.1) is None


def test_a_sensor_that_hangs_holds_nothing_up() -> None:
    inside, never = threading.Event(), threading.Event()

    def hang() -> int:
        inside.set()
        never.wait()
        return 1

    sampler = Sampler(hang, period=0.001, max_age=2.0)
    assert inside.wait(60)
    assert sampler.latest(0.0) is None
    never.set()
    sampler.close()
