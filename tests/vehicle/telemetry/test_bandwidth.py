"""On a slow link telemetry leaves room for what matters: bytes counted in virtual time, all streams asked for."""

from __future__ import annotations

import itertools

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Command, DriveType, Result
from link.core import LinkReport, Peer
from link.services.pacing import DEFAULT_RATE, LOCAL_FILE_RATE
from tests.vehicle.bench import AHEAD, DRIVER, EVERYTHING, NEUTRAL, Bench
from tests.vehicle.conversations import conversation
from vehicle.autonomy.navigator import Navigator
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.streams import STREAMS

SIK = 5760.0
"""bytes/s: 57600 baud."""
STATION = Peer(0, f"gcs {DRIVER}")
STREAMED = tuple(stream.message for stream in STREAMS)


def report(capacity: float | None, *, index: int = 0, headroom: float = 1.0) -> LinkReport:
    return LinkReport("serial", index=index, capacity=capacity, headroom=headroom, audience=(STATION,))


def streamed(bench: Bench, seconds: float, *reports: LinkReport) -> float:
    """Bytes/s of telemetry, with a driver who changes the demand all the time."""
    before = len(bench.sent)
    for step in range(int(seconds * 10)):
        if step % 10 == 0:
            bench.rover.observe(reports, bench.now)
        bench.wait(0.1, AHEAD if step % 2 else NEUTRAL)
    sizes = [len(codec.encode_payload(each)) + 12 for each in bench.sent[before:] if isinstance(each, STREAMED)]
    return sum(sizes) / seconds


def greedy(rate: int = 50) -> Bench:
    """A ground station that wants all there is, and drives."""
    bench = Bench()
    bench.readings = EVERYTHING
    bench.drive()
    bench.say(m.RequestDataStream(1, 1, 0, rate, 1))
    for stream in STREAMS:
        bench.command(Command.SET_MESSAGE_INTERVAL, stream.message.id, 1e6 / rate)
    return bench


def test_without_a_limit_it_would_be_far_too_much() -> None:
    assert streamed(greedy(), 10.0, report(None)) > 0.7 * SIK


@pytest.mark.parametrize("capacity", [960.0, SIK, 11520.0])
def test_all_streams_together_stay_below_their_share(capacity: float) -> None:
    bench = greedy()
    streamed(bench, 2.0, report(capacity))
    share = streamed(bench, 20.0, report(capacity)) / capacity
    assert 0.34 < share <= 0.6


def test_nothing_starves() -> None:
    bench = greedy()
    streamed(bench, 2.0, report(SIK))
    bench.sent.clear()
    streamed(bench, 20.0, report(SIK))
    counts = {kind: len(bench.all(kind)) for kind in STREAMED if bench.all(kind)}
    assert len(counts) >= 17
    assert counts[m.Heartbeat] in range(20, 23)
    assert min(counts.values()) >= 15
    assert counts[m.RoverDriveStatus] >= 5 * 20


def test_the_usual_streams_fit_a_usual_radio_unchanged() -> None:
    bench = Bench()
    bench.readings = EVERYTHING
    streamed(bench, 2.0, report(SIK))
    before = len(bench.all(m.Attitude))
    streamed(bench, 10.0, report(SIK))
    assert len(bench.all(m.Attitude)) - before == pytest.approx(40, abs=1)


def test_radio_that_asks_for_less_gets_less_and_later_all_again() -> None:
    bench = greedy()
    streamed(bench, 2.0, report(SIK, headroom=0.25))
    assert 0.08 < streamed(bench, 10.0, report(SIK, headroom=0.25)) / SIK <= 0.6 * 0.25 + 0.01
    streamed(bench, 2.0, report(SIK))
    assert streamed(bench, 10.0, report(SIK)) / SIK > 0.35


def test_a_headroom_that_changes_each_second_is_no_way_around() -> None:
    bench = greedy()
    total = 0.0
    for step in range(20):
        total += streamed(bench, 1.0, report(SIK, headroom=0.9 if step % 2 else 1.0))
    assert total / 20 / SIK <= 0.6 * 1.05


def test_the_demand_is_told_at_once_on_a_slow_link() -> None:
    """The driver sees what the vehicle obeys, and echoes its time (OPR_ECHO_MAX 0.45 s)."""
    bench = greedy()
    streamed(bench, 2.0, report(SIK))
    times = []
    for _ in range(100):
        before = len(bench.all(m.RoverDriveStatus))
        bench.wait(0.1, AHEAD)
        if len(bench.all(m.RoverDriveStatus)) > before:
            times.append(bench.now)
    gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
    assert max(gaps) < 0.3


def test_commands_are_answered_whatever_telemetry_takes() -> None:
    bench = greedy()
    streamed(bench, 5.0, report(SIK))
    assert bench.command(Command.REQUEST_MESSAGE, m.Attitude.id, system=DRIVER) is Result.ACCEPTED


def build_safety() -> Safety:
    """Of a vehicle that has booted and is disarmed."""
    params, texts = Params(), StatusTextQueue()
    control = Control(params, texts, system=1, boot=0.0)
    safety = Safety(params, control, texts, 0.0, Navigator(params, DriveType.SKID))
    safety.boot_done()
    return safety


class Wire:
    """A slow link on which bulk is sent as fast as it may, in virtual time."""

    def __init__(self) -> None:
        self.now = 0.0
        self._safety = build_safety()
        self.stations: set[Peer] = set()
        self.bandwidth = Bandwidth(self._safety, self.stations.__contains__)
        self.bandwidth.update([report(SIK)])

    def bulk(self, seconds: float, size: int = 263) -> float:
        """Share of the link that bulk gets while it wants all of it."""
        sent, start = 0, self.now
        for cycle in range(1, round(seconds * 50) + 1):
            self.now = start + cycle * 0.02
            while self.bandwidth.pacer.consume(Peer(0, "gcs"), size, self.now):
                sent += size
            if cycle % 50 == 0:
                self.bandwidth.update([report(SIK)])
        return sent / seconds / SIK

    def arm(self) -> None:
        assert self._safety.arm(conversation(DRIVER), self.now) == []

    @property
    def telemetry(self) -> float:
        return self.bandwidth.telemetry_rates[0] / SIK


@pytest.mark.parametrize(("size", "least"), [(37, 0.82), (263, 0.82)])
def test_while_nobody_can_drive_bulk_gets_telemetrys_share(size: int, least: float) -> None:
    wire = Wire()
    assert wire.telemetry == pytest.approx(0.6)
    wire.bulk(1.0, size)
    assert wire.telemetry == pytest.approx(0.12)
    assert least < wire.bulk(20.0, size) <= 0.86


def test_bulk_gains_nothing_before_telemetry_has_given_it_up() -> None:
    assert Wire().bulk(0.98) <= 0.35


def test_arming_takes_it_back_in_the_cycle_and_telemetry_follows() -> None:
    wire = Wire()
    wire.bulk(5.0)
    wire.arm()
    assert wire.bulk(0.9) <= 0.35
    wire.bulk(1.0)
    assert wire.telemetry == pytest.approx(0.6)
    assert 0.25 < wire.bulk(20.0) <= 0.31


SIMULATOR_STATION, ON_WIFI = Peer(1, ("127.0.0.1", 14550)), Peer(1, ("192.0.2.7", 14550))


def test_files_go_faster_to_a_local_station_until_it_is_armed() -> None:
    wire = Wire()
    files = wire.bandwidth.file_pacer
    assert files.rate(SIMULATOR_STATION) == DEFAULT_RATE, "it may be MAVProxy, which loses frames"
    wire.stations |= {SIMULATOR_STATION, ON_WIFI, STATION}
    assert files.rate(SIMULATOR_STATION) == LOCAL_FILE_RATE
    assert wire.bandwidth.pacer.rate(SIMULATOR_STATION) == files.rate(ON_WIFI) == DEFAULT_RATE
    assert files.rate(STATION) < SIK
    wire.arm()
    assert files.rate(SIMULATOR_STATION) == DEFAULT_RATE


def test_files_go_slower_again_where_frames_are_lost() -> None:
    wire = Wire()
    wire.stations.add(SIMULATOR_STATION)
    files = wire.bandwidth.file_pacer
    files.note_loss(SIMULATOR_STATION)
    assert files.rate(SIMULATOR_STATION) == DEFAULT_RATE
    assert files.rate(SIMULATOR_STATION._replace(conversation=1)) == DEFAULT_RATE, "it has not introduced itself"


def test_when_bulk_has_ended_telemetry_has_all_again() -> None:
    wire = Wire()
    wire.bulk(3.0)
    for _ in range(2):
        wire.bandwidth.update([report(SIK)])
    assert wire.telemetry == pytest.approx(0.6)


def test_bulk_on_a_network_slows_no_telemetry() -> None:
    wire = Wire()
    for _ in range(3):
        wire.bandwidth.pacer.consume(Peer(1, "gcs"), 263, wire.now)
        wire.bandwidth.update([report(SIK), report(None, index=1)])
    assert wire.telemetry == pytest.approx(0.6)
    assert wire.bandwidth.pacer.rate(Peer(1, "gcs")) == DEFAULT_RATE
