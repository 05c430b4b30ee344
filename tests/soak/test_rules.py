"""The rules of the soak see each way in which motors may have power that they must not have."""

from __future__ import annotations

import pytest

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from tests.e2e.programs import Output
from tests.link.signing.signed import signed
from tests.soak.census import LEAST, WARM_UPS, Life
from tests.soak.rules import NOISE, Stretch, Witness, judge, stretches

DRIVEN = [10.0 + number * 0.05 for number in range(21)]
"""When demands were sent: 20 a second, from 10 s to 11 s."""
ARMED = [(9.5, True), (12.5, True)]


def outputs(*rows: tuple[float, float]) -> list[Output]:
    return [Output(at, (power, power)) for at, power in rows]


def test_outputs_are_judged_while_they_are_not_neutral() -> None:
    rows = outputs((10.1, 0.2), (10.2, 0.4), (11.5, 0.0), (12.0, -0.3))
    assert list(stretches(rows, None, 12.4)) == [
        Stretch(10.1, 10.2, 0.2, 0.0),
        Stretch(10.2, 11.5, 0.4, 0.2),
        Stretch(12.0, 12.4, 0.3, 0.0),
    ]


def test_an_output_that_lasts_is_judged_again() -> None:
    assert list(stretches([], Output(10.0, (0.5,)), 11.0)) == [Stretch(10.0, 11.0, 0.5, 0.0)]
    assert list(stretches([], Output(10.0, (0.0,)), 11.0)) == []


@pytest.mark.parametrize(
    ("stretch", "fault"),
    [
        (Stretch(10.02, 11.8, 0.5, 0.0), None),
        (Stretch(10.02, 12.1, 0.5, 0.0), "motors had power 1.100 s after the newest demand"),
        (Stretch(9.9, 10.5, 0.5, 0.0), "motors had power inf s after"),
        (Stretch(11.7, 11.8, 0.5, 0.6), None),
        (Stretch(11.7, 11.8, 0.5, 0.4), "power rose to 0.50 by a demand that is at least 0.700 s old"),
    ],
)
def test_power_needs_a_fresh_demand(stretch: Stretch, fault: str | None) -> None:
    found = list(judge(stretch, DRIVEN, ARMED, NOISE))
    assert found == [] if fault is None else found[0].startswith(fault), found


@pytest.mark.parametrize(
    ("beats", "fault"),
    [
        ([(10.0, False), (11.0, False)], True),
        ([(10.0, False), (11.0, True)], False),
        ([(10.0, True), (11.0, False)], False),
        ([(11.2, False), (12.2, False)], False),
    ],
)
def test_power_needs_arming(beats: list[tuple[float, bool]], fault: bool) -> None:
    found = list(judge(Stretch(10.3, 11.0, 0.5, 0.0), DRIVEN, beats, NOISE))
    assert found == (["power 0.50 while disarmed"] if fault else [])


def frame(message: m.Message, system: int) -> bytes:
    return codec.frame(type(message).id, codec.encode_payload(message), 0, system, 190)


def test_witness_counts_demands_of_motion_and_reads_obedience() -> None:
    seen = Witness()
    for axes in (Axes(), Axes(throttle=0.5)):
        seen.station_says(frame(build_manual_control(axes, 1), 254), 10.0)
    for age, throttle in ((700, 0), (300, 5000)):
        seen.vehicle_says(frame(m.RoverDriveStatus(0, age, throttle, 0, [0] * 4, 0, 254, 0), 1), 10.0)
    assert (list(seen.demands), seen.by_station, seen.oldest_obeyed) == ([10.0], {254: 1}, 0.3)


def test_the_witness_counts_what_is_not_signed() -> None:
    seen = Witness()
    seen.station_says(signed(), 10.0)
    seen.vehicle_says(signed(ids=(1, 1)) + frame(m.Heartbeat(10, 3, 0, 0, 3, 3), 1), 10.0)
    assert (seen.signed, seen.unsigned, len(seen.beats)) == (2, {"1/190 HEARTBEAT": 1}, 2)


def test_a_process_that_grows_is_named() -> None:
    life = Life("station one", 1, 0.0)
    for second in range(0, int(WARM_UPS[0] + LEAST) + 60, 10):
        life.times.append(float(second))
        life.rss.append(40.0 + 3.0 * second / 3600)
        life.pss.append(20.0 + 4.0 * second / 3600)
        life.descriptors.append(9 + second // 400)
        life.threads.append(2)
    assert life.faults() == ["station one grows by 3.00 MB/h", "station one: descriptors grew from 9 to 10"]
    life.descriptors = [9] * len(life.times)
    life.descriptors[-2] = 10
    assert life.faults() == ["station one grows by 3.00 MB/h"], "open for a moment"
    life.pss = [20.0] * len(life.times)
    assert life.faults() == [], "it only touches what it shares"


def test_filling_up_in_ten_minutes_differs_from_endless_growth() -> None:
    for forever, judged in ((0.0, 0.0), (2.0, 2.0)):
        life = Life("station one", 1, 0.0)
        for second in range(0, 1800, 10):
            life.times.append(float(second))
            life.rss.append(40.0 + min(second, 600) / 200 + forever * second / 3600)
            life.pss.append(life.rss[-1] - 10.0)
            life.descriptors.append(9)
            life.threads.append(1)
        first, _, last = life.growth(life.rss)
        assert first > 1.0 + forever
        assert last == pytest.approx(judged)
        assert bool(life.faults()) is (forever > 0.0)
