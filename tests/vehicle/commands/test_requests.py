"""Messages and rates on request: bad inputs 22, 54 and 55 of the design."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.codec import decode, encode_payload
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.core import LinkReport, Peer, Received
from link.signing.role import SigningRole
from tests.vehicle.bench import EVERYTHING, OTHER, Bench, Equipped
from vehicle.modes import MODES
from vehicle.telemetry.streams import STREAMS, Stream

REQUEST, SET, GET = Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL, Command.GET_MESSAGE_INTERVAL


def equipped(**params: float) -> Bench:
    bench = Equipped(**params)
    bench.readings = EVERYTHING
    bench.wait(0.1)
    return bench


def see_obstacle(bench: Bench) -> None:
    """A companion reports an obstacle 1 m ahead."""
    message = m.DistanceSensor(0, 2, 600, 100, 0, 0, 0, 255, 0.4, 0)
    peer = Peer(0, "companion")
    bench._receive(Received(message, 1, 196, 0, peer, introduced=True, role=SigningRole.SET_UP))


@pytest.mark.parametrize("stream", STREAMS, ids=lambda stream: stream.message.msgname)
def test_every_stream_can_be_asked_for(stream: Stream) -> None:
    bench = equipped(FENCE_ENABLE=1, PRX1_TYPE=2)
    see_obstacle(bench)
    bench.arm()
    bench.set_mode(Mode.LOITER)
    bench.meet(OTHER)
    bench.wait(0.6)
    see_obstacle(bench)
    count = len(bench.all(stream.message))
    assert bench.command(REQUEST, stream.message.id, system=OTHER) is Result.ACCEPTED
    assert len(bench.all(stream.message)) == count + 1


def test_the_answer_goes_to_who_asked() -> None:
    bench = equipped()
    bench.command(REQUEST, m.AutopilotVersion.id, system=OTHER)
    assert bench.peers[bench.sent.index(bench.newest(m.AutopilotVersion))] == Peer(0, f"gcs {OTHER}")


def test_modes_one_by_one_and_all_at_once() -> None:
    bench = equipped()
    assert bench.command(REQUEST, m.AvailableModes.id, 0) is Result.ACCEPTED
    modes = bench.all(m.AvailableModes)
    assert [(mode.mode_index, mode.custom_mode) for mode in modes] == list(enumerate(MODES, start=1))
    assert all(mode.number_modes == len(MODES) for mode in modes)
    assert bench.command(REQUEST, m.AvailableModes.id, 3) is Result.ACCEPTED
    assert bench.newest(m.AvailableModes).custom_mode == Mode.HOLD
    assert bench.command(REQUEST, m.AvailableModes.id, math.nan) is Result.ACCEPTED  # left out: all
    assert bench.newest(m.AvailableModes).mode_index == len(MODES)
    for index in (len(MODES) + 1, -1, 0.5, math.inf):
        assert bench.command(REQUEST, m.AvailableModes.id, index) is Result.DENIED


@pytest.mark.parametrize("number", [4294967040.0, -1, math.nan, math.inf, 0.5, 2**24])
def test_55_what_is_no_message_id_is_denied(number: float) -> None:
    bench = equipped()
    for command in (REQUEST, SET, GET):
        assert bench.command(command, number) is Result.DENIED


def test_unknown_message_is_unsupported_and_sensorless_one_fails() -> None:
    bench = Bench()
    assert bench.command(REQUEST, 259) is Result.UNSUPPORTED
    assert bench.command(REQUEST, m.Attitude.id) is Result.FAILED
    assert bench.command(Command.GET_HOME_POSITION) is Result.FAILED


def test_home_on_request_and_when_it_is_set() -> None:
    bench = Bench()
    bench.wait(0.5)
    assert not bench.all(m.HomePosition)
    bench.readings = EVERYTHING
    bench.wait(0.5)
    home = bench.newest(m.HomePosition)
    assert (home.latitude, home.longitude, home.altitude) == (481000000, 115000000, 500000)
    assert bench.command(Command.GET_HOME_POSITION) is Result.ACCEPTED
    assert len(bench.all(m.HomePosition)) == 2


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (Command.REQUEST_PROTOCOL_VERSION, m.ProtocolVersion),
        (Command.REQUEST_AUTOPILOT_CAPABILITIES, m.AutopilotVersion),
    ],
)
def test_the_older_questions(command: Command, message: type[m.Message]) -> None:
    bench = equipped()
    assert bench.command(command, 1) is Result.ACCEPTED
    assert len(bench.all(message)) == 1
    assert bench.command(command, math.nan) is Result.DENIED


@pytest.mark.parametrize("command", [REQUEST, SET, GET, Command.REQUEST_AUTOPILOT_CAPABILITIES])
def test_22_a_sender_without_heartbeat_gets_only_a_refusal(command: Command) -> None:
    bench = equipped()
    count = len(bench.sent)
    assert bench.command(
        command, 148 if command is not Command.REQUEST_AUTOPILOT_CAPABILITIES else 1, introduced=False
    ) is (Result.TEMPORARILY_REJECTED)
    assert len(bench.all(m.AutopilotVersion)) == 0
    assert len(bench.sent) <= count + 2  # the answer, and a stream that was due


def interval(bench: Bench, kind: type[m.Message]) -> int:
    assert bench.command(GET, kind.id) is Result.ACCEPTED
    answer = bench.newest(m.MessageInterval)
    assert answer.message_id == kind.id
    return int(answer.interval_us)


def test_the_longest_interval_can_be_requested_and_read_back() -> None:
    """3e9 us is capped to what MESSAGE_INTERVAL can hold; more was accepted, and never answered."""
    bench = equipped()
    assert bench.command(SET, m.Attitude.id, 3e9) is Result.ACCEPTED
    assert interval(bench, m.Attitude) == 2_147_000_000
    encoded = encode_payload(bench.newest(m.MessageInterval))
    decoded = decode(m.MessageInterval.id, encoded)
    assert isinstance(decoded, m.MessageInterval)
    assert decoded.interval_us == 2_147_000_000


def test_intervals_can_be_read_set_turned_off_and_reset() -> None:
    bench = equipped()
    assert interval(bench, m.Attitude) == 250_000
    assert bench.command(SET, m.Attitude.id, 100_000) is Result.ACCEPTED
    assert interval(bench, m.Attitude) == 100_000
    count = len(bench.all(m.Attitude))
    bench.wait(2.0)
    assert len(bench.all(m.Attitude)) - count == pytest.approx(20, abs=1)
    bench.command(SET, m.Attitude.id, -1)
    assert interval(bench, m.Attitude) == -1
    count = len(bench.all(m.Attitude))
    bench.wait(2.0)
    assert len(bench.all(m.Attitude)) == count
    bench.command(SET, m.Attitude.id, 0)
    assert interval(bench, m.Attitude) == 250_000


def test_a_stream_that_is_off_at_the_start_can_be_turned_on() -> None:
    bench = equipped()
    assert interval(bench, m.RoverDriveInfo) == -1
    bench.command(SET, m.RoverDriveInfo.id, 500_000)
    bench.wait(2.0)
    assert len(bench.all(m.RoverDriveInfo)) == pytest.approx(4, abs=1)


def test_54_every_microsecond_is_clamped_and_all_have_a_budget() -> None:
    bench = equipped()
    for stream in STREAMS:
        assert bench.command(SET, stream.message.id, 1) is Result.ACCEPTED
    assert interval(bench, m.Attitude) == 20_000
    assert interval(bench, m.Heartbeat) == 1_000_000  # not for others to choose
    count = len(bench.sent)
    bench.wait(10.0)
    assert len(bench.sent) - count <= 10 * 200 + 60 + 12


@pytest.mark.parametrize("wish", [math.nan, math.inf, -2, -0.5])
def test_a_rate_that_is_none_is_denied(wish: float) -> None:
    bench = equipped()
    assert bench.command(SET, m.Attitude.id, wish) is Result.DENIED
    assert bench.command(SET, 11000, 1000) is Result.DENIED
    assert interval(bench, m.Attitude) == 250_000


def test_what_is_no_stream_has_no_interval() -> None:
    bench = equipped()
    bench.command(GET, 11000)
    assert bench.newest(m.MessageInterval).interval_us == 0


def test_request_data_stream_sets_a_group() -> None:
    bench = equipped()
    bench.say(m.RequestDataStream(1, 1, 10, 10, 1))
    assert interval(bench, m.Attitude) == 100_000
    assert interval(bench, m.VfrHud) == 250_000
    bench.say(m.RequestDataStream(1, 1, 0, 65535, 1))
    assert interval(bench, m.VfrHud) == 20_000
    bench.say(m.RequestDataStream(1, 1, 0, 4, 0))
    assert interval(bench, m.VfrHud) == -1
    assert interval(bench, m.RoverDriveStatus) == 200_000  # in no group
    bench.say(m.RequestDataStream(2, 1, 0, 4, 1))
    assert interval(bench, m.VfrHud) == -1


def test_the_state_of_a_link_is_that_of_the_askers_own() -> None:
    bench = Bench()
    assert bench.command(REQUEST, m.RoverLinkStatus.id) is Result.FAILED  # nothing has been reported yet
    other, own = LinkReport("udpin:[::]:1", index=3, frames=7), LinkReport("serial:/dev/ttyAMA0:57600", frames=40)
    bench.rover.observe([other, own], bench.now)
    bench.rover.observe([other, replace(own, frames=41, crc_errors=2)], bench.now)
    bench.rover.messages_to_send()
    assert bench.command(REQUEST, m.RoverLinkStatus.id) is Result.ACCEPTED
    told = bench.newest(m.RoverLinkStatus)
    assert (told.link_id, told.frames_ok, told.crc_errors) == (0, 41, 2)
    bench.rover.observe([other], bench.now)
    assert bench.command(REQUEST, m.RoverLinkStatus.id) is Result.FAILED  # this link is gone
