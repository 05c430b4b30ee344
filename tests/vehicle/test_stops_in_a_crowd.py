"""Findings D10, A3: with all places of the link taken a new ground station stops the rover, and sees that it stands.

The strangers come from addresses of their own, which are forged easily, and are silent for less than PEER_SILENCE.
"""

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
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.clock import TICKS
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signing import Signing
from tests.link.signing.signed import DRIVER as OWNER
from tests.link.signing.signed import NOW, WATCHER, keep, signed
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
    """A rover behind a channel, its driver, and strangers with a heartbeat each 4 s.

    `key`: that of the strangers; with `signing` the vehicle lets everybody drive, and verifies what is signed.
    """

    def __init__(self, signing: Signing | None = None, key: SigningKey | None = None) -> None:
        self.now = 100.0
        self.rover = Rover(Params({}), now=self.now)
        guard = SigningGuard(signing, SigningPolicy(SigningRole.SET_UP, open_stops=True), 0) if signing else None
        self.channel = Channel("udpin:0.0.0.0:14550", 0, system=1, component=1, wanted=MESSAGE_IDS, guard=guard)
        self._key = key
        self._frames = 0
        self.replies: dict[Hashable, list[m.Message]] = {}
        self._framer = Framer(stream=False)
        self._sequences: dict[Hashable, int] = {}
        self._cycle = 0

    def send(self, message: m.Message, address: Hashable, system: int, key: SigningKey | None = None) -> None:
        sequence = self._sequences[address] = (self._sequences.get(address, -1) + 1) & 0xFF
        if key is None:
            data = codec.frame(type(message).id, codec.encode_payload(message), sequence, system, 190)
        else:
            self._frames += 1
            stamp = NOW + round(self.now * TICKS) + self._frames
            data = signed(message, key, stamp, sequence=sequence, ids=(system, 190))
        for received in self.channel.receive(data, address, self.now):
            self.rover.receive(received, self.now)
        self._flush()

    def run(self, seconds: float, axes: Axes = AHEAD) -> None:
        for _ in range(round(seconds / CYCLE)):
            self.now += CYCLE
            self._cycle += 1
            if self._cycle % round(BEAT_PERIOD / STRANGERS / CYCLE) == 0:
                number = self._cycle // round(BEAT_PERIOD / STRANGERS / CYCLE) % STRANGERS
                self.send(BEAT, (f"10.1.0.{number}", 20000), 100 + number, self._key)
            if self._cycle % 50 == 0:
                self.send(BEAT, DRIVER_ADDRESS, DRIVER)
                self.channel.reserve(self.rover.reserved_ids)
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
            for data, address, _ in self.channel.send(outgoing, now=self.now):
                found = self._framer.feed(data, self.now)
                messages = (codec.decode_frame(number, raw) for number, _, _, _, raw in found)
                self.replies.setdefault(address, []).extend(messages)


STOPS = {
    "disarm": m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0),
    "emergency stop": m.CommandLong(1, 1, Command.DO_SET_SAFETY_SWITCH_STATE, 0, 0, 0, 0, 0, 0, 0, 0),
    "termination": m.CommandLong(1, 1, Command.DO_FLIGHTTERMINATION, 0, 1, 0, 0, 0, 0, 0, 0),
    "HOLD": m.CommandLong(1, 1, Command.DO_SET_MODE, 0, 1, Mode.HOLD, 0, 0, 0, 0, 0),
}


@pytest.mark.parametrize(
    ("name", "delay"), [*zip([*STOPS, *STOPS], (0.0, 0.1, 0.5, 1.1, 2.3, 3.7, 0.0, 3.0), strict=True)]
)
def test_a_new_station_stops_a_rover_whose_places_are_all_taken(name: str, delay: float) -> None:
    """The delays go through the period of the strangers, each place with another stop."""
    stop = STOPS[name]
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


def heartbeats(link: CrowdedLink, address: Hashable = NEW_STATION) -> list[m.Heartbeat]:
    return [each for each in link.replies.get(address, []) if isinstance(each, m.Heartbeat)]


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
def test_the_sender_of_a_stop_without_a_place_sees_its_effect(stop: m.CommandLong) -> None:
    link = CrowdedLink()
    link.drive()
    link.send(stop, NEW_STATION, 66)
    (beat,) = heartbeats(link)
    if stop.command == Command.DO_SET_MODE:
        assert (beat.custom_mode, beat.base_mode & 128) == (Mode.HOLD, 128)
    else:
        assert beat.base_mode & 128 == 0
    assert any(isinstance(each, m.CommandAck) for each in link.replies[NEW_STATION])


def test_a_heartbeat_a_second_answers_stops_of_any_number() -> None:
    link = CrowdedLink()
    link.drive()
    for _ in range(100):
        link.run(0.04)
        link.send(STOPS["disarm"], NEW_STATION, 66)
    assert 4 <= len(heartbeats(link)) <= 5


def test_a_stop_for_another_vehicle_is_not_answered() -> None:
    link = CrowdedLink()
    link.drive()
    link.send(m.CommandLong(9, 1, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0), NEW_STATION, 66)
    assert NEW_STATION not in link.replies
    assert any(link.rover.outputs.throttles)


def test_with_a_set_mode_the_heartbeat_is_the_only_answer() -> None:
    link = CrowdedLink()
    link.drive()
    link.send(m.SetMode(1, 1, Mode.HOLD), NEW_STATION, 66)
    link.run(1.0)
    assert [each.custom_mode for each in heartbeats(link)] == [Mode.HOLD]
    assert not any(link.rover.outputs.throttles)


@pytest.mark.parametrize("strangers", [None, WATCHER], ids=["unsigned", "watch key"])
def test_the_owner_has_a_place_at_once_among_strangers(strangers: SigningKey | None) -> None:
    """While another station drives: the owner hears the vehicle, disarms it, and sees that it is disarmed."""
    link = CrowdedLink(keep(OWNER, WATCHER), strangers)
    link.drive()
    link.send(BEAT, NEW_STATION, 66, OWNER)
    link.run(1.1)
    assert heartbeats(link)[-1].base_mode & 128
    assert any(link.rover.outputs.throttles)
    link.send(STOPS["disarm"], NEW_STATION, 66, OWNER)
    assert link.rover.state is not SafetyState.ARMED
    assert not any(link.rover.outputs.throttles)
    link.run(1.1)
    assert heartbeats(link)[-1].base_mode & 128 == 0


@pytest.mark.parametrize("strangers", [None, WATCHER], ids=["unsigned", "watch key"])
def test_the_owner_drives_among_strangers(strangers: SigningKey | None) -> None:
    link = CrowdedLink(keep(OWNER, WATCHER), strangers)
    link.run(10.0)
    link.send(BEAT, NEW_STATION, 66, OWNER)
    link.send(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0), NEW_STATION, 66, OWNER)
    assert link.rover.state is SafetyState.ARMED, link.replies[NEW_STATION]
    for count in range(150):
        link.run(2 * CYCLE, NEUTRAL)
        link.send(build_manual_control(NEUTRAL if count < 5 else AHEAD, 1), NEW_STATION, 66, OWNER)
    assert any(link.rover.outputs.throttles)
    link.send(STOPS["disarm"], NEW_STATION, 66, OWNER)
    assert not any(link.rover.outputs.throttles)
