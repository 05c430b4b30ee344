"""Finding D10: with all places of the link taken by strangers a new ground station stops the rover all the same."""

from __future__ import annotations

from collections.abc import Hashable

import pytest

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.protocol.channel import Channel
from link.protocol.framer import Framer
from tests.vehicle.bench import AHEAD, BEAT, CYCLE, DRIVER, MESSAGE_IDS, NEUTRAL
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState

STRANGERS = 30
BEAT_PERIOD = 4.0
"""s; with more strangers than places, and each silent for less than PEER_SILENCE."""
NEW_STATION = ("10.0.0.9", 14550)
DRIVER_ADDRESS = ("10.0.0.2", 14550)


class CrowdedLink:
    """A rover behind a channel, its driver, and strangers with a heartbeat each 4 s."""

    def __init__(self) -> None:
        self.now = 100.0
        self.rover = Rover(Params({}), now=self.now)
        self.channel = Channel("udpin:0.0.0.0:14550", 0, system=1, component=1, wanted=MESSAGE_IDS)
        self.replies: dict[Hashable, list[m.Message]] = {}
        self._framer = Framer(stream=False)
        self._sequences: dict[Hashable, int] = {}
        self._cycle = 0

    def send(self, message: m.Message, address: Hashable, system: int) -> None:
        sequence = self._sequences[address] = (self._sequences.get(address, -1) + 1) & 0xFF
        data = codec.frame(type(message).id, codec.encode_payload(message), sequence, system, 190)
        for received in self.channel.receive(data, address, self.now):
            self.rover.receive(received, self.now)
        self._flush()

    def run(self, seconds: float, axes: Axes = AHEAD) -> None:
        for _ in range(round(seconds / CYCLE)):
            self.now += CYCLE
            self._cycle += 1
            if self._cycle % round(BEAT_PERIOD / STRANGERS / CYCLE) == 0:
                number = self._cycle // round(BEAT_PERIOD / STRANGERS / CYCLE) % STRANGERS
                self.send(BEAT, ("10.0.0.3", 20000 + number), 100 + number)
            if self._cycle % 50 == 0:
                self.send(BEAT, DRIVER_ADDRESS, DRIVER)
            if self._cycle % 2 == 0:
                self.send(build_manual_control(axes, 1), DRIVER_ADDRESS, DRIVER)
            self.rover.tick(self.now)
            self.channel.expire_peers(self.now)
            self._flush()

    def drive(self) -> None:
        self.run(CYCLE, NEUTRAL)
        self.send(BEAT, DRIVER_ADDRESS, DRIVER)
        self.send(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0), DRIVER_ADDRESS, DRIVER)
        self.run(0.2, NEUTRAL)
        self.run(3 * BEAT_PERIOD)
        assert any(self.rover.outputs.throttles)

    def _flush(self) -> None:
        for outgoing in self.rover.messages_to_send():
            for data, address, _ in self.channel.send(outgoing):
                found = self._framer.feed(data, self.now)
                messages = (codec.decode_frame(number, raw) for number, _, _, _, raw in found)
                self.replies.setdefault(address, []).extend(messages)


STOPS = {
    "disarm": m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0),
    "emergency stop": m.CommandLong(1, 1, Command.DO_SET_SAFETY_SWITCH_STATE, 0, 0, 0, 0, 0, 0, 0, 0),
    "termination": m.CommandLong(1, 1, Command.DO_FLIGHTTERMINATION, 0, 1, 0, 0, 0, 0, 0, 0),
    "HOLD": m.CommandLong(1, 1, Command.DO_SET_MODE, 0, 1, Mode.HOLD, 0, 0, 0, 0, 0),
}


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.5, 1.1, 2.3, 3.7])
@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
def test_a_new_station_stops_a_rover_whose_places_are_all_taken(stop: m.CommandLong, delay: float) -> None:
    link = CrowdedLink()
    link.drive()
    link.run(delay)
    refused = link.channel.report().refused_peers
    link.send(BEAT, NEW_STATION, 66)
    assert link.channel.report().refused_peers == refused + 1  # no place
    link.send(stop, NEW_STATION, 66)
    acks = [each for each in link.replies[NEW_STATION] if isinstance(each, m.CommandAck)]
    assert [(each.command, each.result) for each in acks] == [(stop.command, Result.ACCEPTED)]
    if stop.command == Command.DO_SET_MODE:
        link.run(0.5)
        assert link.rover.state is SafetyState.ARMED
    else:
        assert link.rover.state is not SafetyState.ARMED
    assert not any(link.rover.outputs.throttles)


def test_others_than_stops_do_not_pass() -> None:
    link = CrowdedLink()
    link.drive()
    link.send(m.CommandLong(1, 1, Command.DO_SET_MODE, 0, 1, Mode.MANUAL, 0, 0, 0, 0, 0), NEW_STATION, 66)
    link.send(m.CommandLong(1, 1, Command.REQUEST_MESSAGE, 0, 0, 0, 0, 0, 0, 0, 0), NEW_STATION, 66)
    assert NEW_STATION not in link.replies
