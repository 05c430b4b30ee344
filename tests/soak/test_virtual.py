"""What the soak in virtual time notices: a rover that drives on, and memory that grows."""

from __future__ import annotations

import pytest

from tests.soak.census import HOUR, MAX_GROWTH
from tests.soak.heap import MEGABYTE, Heap
from tests.soak.rules import OBEYED
from tests.soak.strict import RESOLUTION, StrictMonkey
from vehicle.drive.control import Control


def cut_while_driving() -> StrictMonkey:
    monkey = StrictMonkey("hold")
    monkey.get_going()
    assert monkey.power > 0.5
    monkey.link(False)
    monkey.run(2.0)
    return monkey


def test_a_rover_that_stops_keeps_the_rules() -> None:
    monkey = cut_while_driving()
    assert monkey.power == 0.0
    assert 0.0 < monkey.oldest_obeyed <= OBEYED
    assert monkey.oldest_obeyed <= monkey.oldest_sent <= OBEYED + RESOLUTION


def test_a_drive_of_days_has_a_charged_battery() -> None:
    monkey = StrictMonkey("hold")
    monkey.battery.remaining = 0.0
    monkey.forget()
    monkey.get_going()
    assert monkey.power > 0.5


def test_a_late_demand_that_is_obeyed_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its age on arrival is not: only its sender knows when that was."""
    monkey = StrictMonkey("hold")
    monkey.get_going()
    monkeypatch.setattr("vehicle.drive.operator_session.echo_age", lambda echo, since_boot: 0.0)
    monkey.delay(0.6)
    with pytest.raises(AssertionError, match="after it was sent"):
        monkey.run(2.0)


def test_a_rover_that_drives_on_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Control, "demand_timeout", 5.0)
    monkeypatch.setattr("vehicle.drive.operator_session.echo_age", lambda echo, since_boot: 0.0)
    with pytest.raises(AssertionError, match="was obeyed"):
        cut_while_driving()


def test_what_is_kept_for_each_demand_shows_as_growth() -> None:
    heap = Heap(trace=True)
    heap.start()
    kept = []
    for minutes in range(0, 120, 10):
        kept.append(bytes(MEGABYTE // 2))
        heap.look(minutes * 60.0)
    heap.stop()
    growth = heap.growth()
    assert growth is not None
    assert growth[0] == pytest.approx(3.0, rel=0.05)
    assert growth[0] > MAX_GROWTH
    assert heap.samples[-1].row()[0] == round(110 * 60 / HOUR, 2)
