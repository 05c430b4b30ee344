"""How fast the battery empties."""

from __future__ import annotations

import pytest

from groundstation.vehicles.readings.battery_use import BatteryUse


def discharge(use: BatteryUse, percent: range, step: float, *, begin: float = 0.0, armed: bool = True) -> float:
    """Report each whole percent for `step` s, twice a second; return when that has ended."""
    now = begin
    for each in percent:
        for _ in range(int(2 * step)):
            use.add(each / 100, now, armed=armed)
            now += 0.5
    return now


def test_a_rate_needs_two_whole_percent() -> None:
    use = BatteryUse()
    discharge(use, range(80, 77, -1), 30.0)
    assert use.rate is None, "80 may have been 80.9, so only 79 and 78 are exact"
    discharge(use, range(77, 76, -1), 30.0, begin=90.0)
    assert use.rate == pytest.approx(0.01 / 30.0)


def test_time_disarmed_and_time_of_silence_do_not_count() -> None:
    use = BatteryUse()
    end = discharge(use, range(80, 78, -1), 30.0)
    end = discharge(use, range(79, 78, -1), 600.0, begin=end, armed=False)
    discharge(use, range(78, 76, -1), 30.0, begin=end + 3600.0)
    assert use.rate == pytest.approx(0.02 / 65.0, rel=0.05)


def test_a_charged_battery_begins_anew_a_recovering_one_not() -> None:
    use = BatteryUse()
    end = discharge(use, range(60, 55, -1), 20.0)
    end = discharge(use, range(58, 59), 20.0, begin=end)
    assert use.rate == pytest.approx(0.01 / 20.0)
    discharge(use, range(100, 98, -1), 20.0, begin=end)
    assert use.rate is None


def test_unknown_charge_is_no_charge() -> None:
    use = BatteryUse()
    for now in range(100):
        use.add(None, float(now), armed=True)
    assert use.rate is None
