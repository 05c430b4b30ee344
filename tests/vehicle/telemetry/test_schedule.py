"""Each peer is told what it understands and asked for, and slows no other."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from pymavlink.dialects.v20 import ardupilotmega, common

from dialects import messages as m
from dialects.enums import Command, Result
from link.core import RECORDER, Peer
from link.protocol.peer_table import MAX_PEERS
from tests.rows import each_row
from tests.vehicle.bench import MESSAGE_IDS
from tests.vehicle.crowd import Crowd, weight
from vehicle.storage.logbook import NullLogRecorder
from vehicle.telemetry import telemetry
from vehicle.telemetry.schedule import PEER_MESSAGE_RATE_MAX
from vehicle.telemetry.streams import STREAMS, DialectLevel, Stream
from vehicle.telemetry.telemetry import LINK_MESSAGE_RATE_MAX

ONE, OTHER, THIRD = Peer(0, "one"), Peer(0, "other"), Peer(0, "third")
RADIO = Peer(1, "radio")
UNTOLD = {m.PositionTargetGlobalInt, m.PositionTargetLocalNed, m.NavControllerOutput, m.FenceStatus, m.RelayStatus,
          m.ObstacleDistance, m.DistanceSensor}  # fmt: skip
"""By a rover that drives to no place, has no fence and no relay, and sees no obstacle."""
SIK = 5760.0
"""bytes/s: 57600 baud."""
OWN = {m.RoverDriveStatus, m.RoverFailsafeStatus, m.RoverLinkStatus, m.RoverDriveInfo}
NEWER = {m.ControlStatus, m.CurrentMode, m.AvailableModesMonitor}


def known(number: int) -> bool:
    return number in common.mavlink_map and number in ardupilotmega.mavlink_map


def greedy(crowd: Crowd, peer: Peer, rate: float = 50) -> None:
    for stream in STREAMS:
        crowd.ask_rate(peer, stream.message, rate)


# ---- families ----


@each_row("stream", STREAMS, ids=lambda stream: stream.message.msgname)
def test_a_stream_is_common_exactly_where_pymavlink_knows_it(stream: Stream) -> None:
    assert known(stream.message.id) == (stream.level is DialectLevel.COMMON)
    assert (stream.level is DialectLevel.ROVER) == stream.message.msgname.startswith("ROVER_")
    assert stream.group is None or stream.level is DialectLevel.COMMON, "REQUEST_DATA_STREAM must turn on no other"


def test_a_sender_of_heartbeats_only_gets_what_pymavlink_knows() -> None:
    crowd = Crowd(ONE)
    crowd.wait(1.0)
    crowd.command(ONE, Command.REQUEST_MESSAGE, m.AutopilotVersion.id)
    crowd.say(ONE, m.RequestDataStream(1, 1, 0, 4, 1))
    crowd.command(ONE, Command.COMPONENT_ARM_DISARM, 1)
    crowd.wait(10.0, driver=ONE)
    crowd.command(ONE, Command.DO_SET_MODE, 1, 4)
    crowd.wait(5.0)
    assert len(crowd.kinds(ONE)) > 15
    assert [kind.msgname for kind in crowd.kinds(ONE) if not known(kind.id)] == []


SHOWS_NEWER: dict[str, Callable[[Crowd], object]] = {
    "modes": lambda crowd: crowd.command(ONE, Command.REQUEST_MESSAGE, m.AvailableModes.id),
    "metadata": lambda crowd: crowd.command(ONE, Command.REQUEST_MESSAGE, m.ComponentMetadata.id),
    "one of them": lambda crowd: crowd.command(ONE, Command.REQUEST_MESSAGE, m.CurrentMode.id),
    "its rate": lambda crowd: crowd.command(ONE, Command.SET_MESSAGE_INTERVAL, m.AvailableModesMonitor.id, 0),
    "which rate": lambda crowd: crowd.command(ONE, Command.GET_MESSAGE_INTERVAL, m.ControlStatus.id),
    "control": lambda crowd: crowd.command(ONE, Command.REQUEST_OPERATOR_CONTROL, 1),
    "standard mode": lambda crowd: crowd.command(ONE, Command.DO_SET_STANDARD_MODE, 1),
}


@pytest.mark.parametrize("shows", SHOWS_NEWER.values(), ids=SHOWS_NEWER)
def test_newer_messages_come_to_who_shows_to_know_them(shows: Callable[[Crowd], object]) -> None:
    crowd = Crowd(ONE, OTHER)
    crowd.wait(2.0)
    assert not crowd.kinds(ONE) & NEWER
    shows(crowd)
    crowd.wait(0.1)
    assert crowd.kinds(ONE) >= NEWER
    rates = crowd.rates(ONE, 20.0)
    assert rates[m.ControlStatus] in (20, 21), "and once more where control was lost"
    assert (rates[m.CurrentMode], rates[m.AvailableModesMonitor]) == (10, 6)
    assert not crowd.kinds(ONE) & OWN
    assert not crowd.kinds(OTHER) & (NEWER | OWN)


SHOWS_OURS: dict[str, Callable[[Crowd], object]] = {
    "presence": lambda crowd: crowd.say(ONE, m.RoverOperatorPresence(1, 1, 0, 0, 0, 0, 0, 0)),
    "info": lambda crowd: crowd.command(ONE, Command.REQUEST_MESSAGE, m.RoverDriveInfo.id),
    "link status": lambda crowd: crowd.command(ONE, Command.REQUEST_MESSAGE, m.RoverLinkStatus.id),
    "status": lambda crowd: crowd.command(ONE, Command.SET_MESSAGE_INTERVAL, m.RoverDriveStatus.id, 0),
}


@pytest.mark.parametrize("shows", SHOWS_OURS.values(), ids=SHOWS_OURS)
def test_ours_go_to_who_shows_to_know_them_and_newer_ones_too(shows: Callable[[Crowd], object]) -> None:
    crowd = Crowd(ONE, OTHER)
    crowd.wait(2.0)
    assert not crowd.kinds(ONE) & OWN
    shows(crowd)
    crowd.wait(0.2)
    assert crowd.kinds(ONE) >= {m.RoverDriveStatus, m.RoverFailsafeStatus, *NEWER}
    rates = crowd.rates(ONE, 10.0)
    assert (rates[m.RoverDriveStatus], rates[m.RoverFailsafeStatus], rates[m.RoverLinkStatus]) == (50, 10, 10)
    assert not crowd.kinds(OTHER) & (NEWER | OWN)


def test_a_stranger_shows_nothing_and_is_told_nothing() -> None:
    crowd = Crowd(ONE)
    stranger = Peer(0, "stranger")
    crowd.say(stranger, m.RoverOperatorPresence(1, 1, 0, 0, 0, 0, 0, 0), introduced=False)
    crowd.command(stranger, Command.REQUEST_MESSAGE, m.RoverDriveInfo.id, introduced=False)
    crowd.say(stranger, m.RequestDataStream(1, 1, 0, 50, 1), introduced=False)
    crowd.wait(3.0)
    assert crowd.kinds(stranger) == {m.CommandAck}
    assert not crowd.kinds(ONE) & (NEWER | OWN)


def test_a_named_address_gets_the_usual_before_a_heartbeat() -> None:
    crowd = Crowd()
    crowd.peers.append(ONE)  # by the link's report alone
    crowd.wait(2.0)
    assert {m.Heartbeat, m.Attitude, m.SysStatus} <= crowd.kinds(ONE)


def test_the_log_hears_all_there_is_also_where_nobody_listens() -> None:
    crowd = Crowd(recording=NullLogRecorder())
    crowd.wait(5.0)
    usual = {stream.message for stream in STREAMS if stream.rate}
    assert usual - UNTOLD <= crowd.kinds(RECORDER)
    crowd.join(ONE)
    crowd.wait(2.0)
    assert m.RoverLinkStatus in crowd.kinds(RECORDER) - crowd.kinds(ONE)
    crowd.leave(ONE)
    crowd.wait(2.0)
    crowd.forget()
    crowd.wait(5.0)
    assert len(crowd.all(RECORDER, m.RoverDriveStatus)) == 25
    assert not crowd.told[ONE]
    silent = Crowd()
    silent.wait(5.0)
    assert not silent.outgoing


# ---- rates ----


def test_a_newcomer_is_told_all_it_understands_at_once() -> None:
    crowd = Crowd()
    crowd.wait(7.77)
    crowd.join(ONE)
    crowd.wait(0.02)
    assert m.Heartbeat in crowd.kinds(ONE)
    crowd.wait(0.5)
    usual = {stream.message for stream in STREAMS if stream.rate and stream.level is DialectLevel.COMMON}
    assert usual - UNTOLD <= crowd.kinds(ONE)


def test_rates_belong_to_who_asked_for_them() -> None:
    crowd = Crowd(ONE, OTHER)
    assert crowd.ask_rate(ONE, m.Attitude, 50) == Result.ACCEPTED
    crowd.command(OTHER, Command.SET_MESSAGE_INTERVAL, m.VfrHud.id, -1)
    assert (crowd.interval(ONE, m.Attitude), crowd.interval(OTHER, m.Attitude)) == (20_000, 250_000)
    assert (crowd.interval(ONE, m.VfrHud), crowd.interval(OTHER, m.VfrHud)) == (250_000, -1)
    crowd.wait(2.0)
    crowd.forget()
    crowd.wait(10.0)
    assert len(crowd.all(ONE, m.Attitude)) == pytest.approx(500, abs=3)
    assert len(crowd.all(OTHER, m.Attitude)) == pytest.approx(40, abs=1)
    assert len(crowd.all(ONE, m.VfrHud)) == pytest.approx(40, abs=1)
    assert crowd.all(OTHER, m.VfrHud) == []


def test_groups_belong_to_who_asked_for_them() -> None:
    crowd = Crowd(ONE, OTHER)
    crowd.say(ONE, m.RequestDataStream(1, 1, 0, 10, 1))
    crowd.say(OTHER, m.RequestDataStream(1, 1, 0, 10, 0))
    assert (crowd.interval(ONE, m.Attitude), crowd.interval(OTHER, m.Attitude)) == (100_000, -1)


def test_who_asks_again_for_what_it_has_gets_no_more() -> None:
    crowd = Crowd(ONE)
    crowd.wait(2.0)
    crowd.forget()
    for _ in range(50):
        crowd.say(ONE, m.RequestDataStream(1, 1, 0, 4, 1))
        crowd.wait(0.2)
    assert len(crowd.all(ONE, m.Attitude)) == pytest.approx(40, abs=1)
    assert len(crowd.all(ONE, m.SysStatus)) == pytest.approx(40, abs=2)


def test_what_is_off_is_off_when_it_changes_too() -> None:
    crowd = Crowd(ONE)
    crowd.command(ONE, Command.SET_MESSAGE_INTERVAL, m.CurrentMode.id, -1)
    crowd.wait(1.0)
    crowd.forget()
    crowd.command(ONE, Command.DO_SET_MODE, 1, 4)
    crowd.wait(3.0)
    assert crowd.all(ONE, m.CurrentMode) == []
    assert crowd.all(ONE, m.Heartbeat)


def test_who_is_gone_takes_its_rates_along() -> None:
    crowd = Crowd(ONE, OTHER)
    crowd.ask_rate(ONE, m.Attitude, 50)
    crowd.say(ONE, m.RoverOperatorPresence(1, 1, 0, 0, 0, 0, 0, 0))
    crowd.wait(2.0)
    crowd.leave(ONE)
    crowd.wait(1.1)
    crowd.forget()
    crowd.wait(2.0)
    assert not crowd.told[ONE]
    crowd.join(ONE)
    assert crowd.interval(ONE, m.Attitude) == 250_000
    crowd.wait(2.0)
    assert not crowd.kinds(ONE) & OWN


def test_who_was_gone_between_two_reports_begins_anew_too() -> None:
    crowd = Crowd(ONE)
    crowd.ask_rate(ONE, m.Attitude, 50)
    crowd.wait(2.0)
    crowd.leave(ONE)
    back = ONE._replace(conversation=1)
    crowd.join(back)
    assert crowd.interval(back, m.Attitude) == 250_000


# ---- budgets ----


def test_request_for_everything_neither_floods_nor_slows_a_line() -> None:
    alone = Crowd(RADIO, capacity={1: SIK})
    alone.wait(3.0)
    undisturbed = alone.rates(RADIO, 20.0)
    crowd = Crowd(ONE, RADIO, capacity={1: SIK})
    greedy(crowd, ONE)
    crowd.wait(3.0)
    crowd.forget()
    assert crowd.rates(RADIO, 20.0) == undisturbed
    assert weight(crowd.told[ONE]) / 20 > 1.2 * SIK, "or there was nothing that could have flooded it"
    assert weight(crowd.told[RADIO]) / 20 < 0.6 * SIK


def test_nor_does_it_slow_its_neighbour_on_the_same_network() -> None:
    crowd = Crowd(ONE, OTHER)
    crowd.wait(3.0)
    undisturbed = crowd.rates(OTHER, 20.0)
    greedy(crowd, ONE)
    crowd.wait(3.0)
    assert crowd.rates(OTHER, 20.0) == undisturbed


def test_two_on_one_slow_line_share_it() -> None:
    near, far = Peer(1, "near"), Peer(1, "far")
    crowd = Crowd(near, far, capacity={1: SIK})
    greedy(crowd, near)
    crowd.wait(3.0)
    crowd.forget()
    rates = crowd.rates(far, 20.0)
    assert rates[m.Heartbeat] == 20
    assert rates[m.Attitude] >= 40, "half of what it gets on a line of its own, at least"
    assert weight(crowd.told[near] + crowd.told[far]) / 20 <= 0.6 * SIK


def test_54_the_budget_of_one_and_that_of_a_link() -> None:
    crowd = Crowd(*(Peer(0, number) for number in range(MAX_PEERS)))
    greedy(crowd, crowd.peers[0], 1e6)
    crowd.wait(2.0)
    crowd.forget()
    crowd.wait(10.0)
    assert len(crowd.told[crowd.peers[0]]) <= 10 * PEER_MESSAGE_RATE_MAX
    assert len(crowd.told[crowd.peers[1]]) == pytest.approx(27 * 10, abs=10), "what it gets where it is alone"
    for peer in crowd.peers:
        greedy(crowd, peer)
    crowd.wait(2.0)
    crowd.forget()
    crowd.wait(10.0)
    assert sum(map(len, crowd.told.values())) <= 10 * LINK_MESSAGE_RATE_MAX * 1.05
    assert all(len(crowd.all(peer, m.Heartbeat)) == 10 for peer in crowd.peers)
    assert all(len(crowd.all(peer, m.HomePosition)) >= 5 for peer in crowd.peers), "nothing starves"


def test_a_full_radio_slows_down_who_is_behind_it() -> None:
    crowd = Crowd(ONE, RADIO)
    crowd.wait(2.0)
    for _ in range(4):
        crowd.say(RADIO, m.RadioStatus(0, 0, 10, 0, 0, 0, 0), introduced=False)
    crowd.wait(0.5)
    crowd.forget()
    crowd.wait(4.0)
    assert len(crowd.all(RADIO, m.Attitude)) <= 3
    assert len(crowd.all(ONE, m.Attitude)) == pytest.approx(16, abs=1)


# ---- cheap ----


def test_one_message_serves_all_who_are_due_for_it() -> None:
    crowd = Crowd()
    for number in range(16):
        crowd.join(Peer(0, number))
        crowd.wait(0.13)
    crowd.wait(5.0)
    crowd.forget()
    crowd.wait(10.0)
    streamed = [each for each in crowd.outgoing if each.among]
    alone = Crowd(ONE)
    alone.wait(5.0)
    alone.forget()
    alone.wait(10.0)
    assert len(streamed) == len([each for each in alone.outgoing if each.among])
    assert all(each.among is not None and len(each.among) == 16 for each in streamed)


def test_a_crowd_of_newcomers_fills_no_table() -> None:
    crowd = Crowd()
    for number in range(1000):
        crowd.say(Peer(0, number), m.Heartbeat(6, 8, 0, 0, 4, 3))
    assert len(crowd.rover._telemetry._schedules) == telemetry.MAX_PEERS
    late = Peer(0, 999)
    assert crowd.command(late, Command.SET_MESSAGE_INTERVAL, m.Attitude.id, 0) == Result.TEMPORARILY_REJECTED
    assert crowd.command(late, Command.GET_MESSAGE_INTERVAL, m.Attitude.id) == Result.TEMPORARILY_REJECTED
    crowd.join(late)
    crowd.wait(2.0)  # the link reports who is really there
    assert len(crowd.rover._telemetry._schedules) == 1
    assert crowd.all(late, m.Attitude)


def test_messages_that_telemetry_acts_on_are_decoded() -> None:
    assert {kind.id for kind in telemetry._OBSERVED} <= MESSAGE_IDS
    assert {each.id for each in (m.Heartbeat, m.RequestDataStream, m.RadioStatus)} <= MESSAGE_IDS


def test_an_origin_is_sent_when_known_and_to_each_newcomer_once() -> None:
    crowd = Crowd(ONE)
    crowd.wait(5.0)
    assert len(crowd.all(ONE, m.GpsGlobalOrigin)) == 1
    crowd.join(OTHER)
    crowd.wait(5.0)
    assert len(crowd.all(OTHER, m.GpsGlobalOrigin)) == 1
    assert len(crowd.all(ONE, m.GpsGlobalOrigin)) == 1
    crowd.ask_rate(ONE, m.GpsGlobalOrigin, 1)
    assert crowd.rates(ONE, 5.0)[m.GpsGlobalOrigin] == 5
    crowd.command(ONE, Command.SET_MESSAGE_INTERVAL, m.GpsGlobalOrigin.id, 0)
    assert crowd.rates(ONE, 5.0)[m.GpsGlobalOrigin] == 0
