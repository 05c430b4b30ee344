"""Two links, one driver, in virtual time: one link is sound, the other one is cut, late, lossy, reordered or frozen.

Each test first sees the wheels turn. The age of a demand is the true one: both ends have one clock here.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import Command
from dialects.modes import Mode
from groundstation.intents.driving import EmergencyStop, Stop
from groundstation.intents.vehicle import Disarm, KeepControl, SetMode
from link.core import Core, Outgoing, Received
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningGuard
from tests.fakes.rover import FakeArduPilot
from tests.link.signing.signed import DRIVER, SIGNED_ONLY, keep
from tests.links_world import LinksDrive, Path
from vehicle.safety.states import SafetyState

SOUND = 0.01
"""s of delay of the sound link."""
OBEYED = 0.1
"""s: the oldest demand that is obeyed while one link is sound."""


def demand_age(drive: LinksDrive) -> float:
    """Return the s since the demand was made that the wheels obey now; 0 while they obey none."""
    control = drive.rover._control
    session = control.ownership.session
    if session is None or session.clock is None or control.demand is None or not control.requests_motion():
        return 0.0
    return drive.now - session.clock / 1000


def assert_drives_on(drive: LinksDrive, seconds: float) -> None:
    """Let a key be held: the wheels turn all the time, by demands that are fresh."""
    oldest, least = 0.0, 1.0

    def each(now: float) -> None:
        nonlocal oldest, least
        oldest, least = max(oldest, demand_age(drive)), min(least, drive.power)

    drive.each = each
    drive.run(seconds)
    drive.each = lambda now: None
    assert least > 0.5
    assert oldest <= OBEYED


def commands(drive: LinksDrive, number: int) -> list[int]:
    """Return the links over which a command went, in order."""
    return [
        link
        for _, link, message in drive.near.sent
        if isinstance(message, m.CommandLong | m.CommandInt) and message.command == number
    ]


@pytest.mark.parametrize("worse", [0, 1])
@settings(max_examples=3, deadline=None)
@given(delay=st.floats(0.0, 2.0), jitter=st.floats(0.0, 0.1), loss=st.floats(0.0, 0.6), seed=st.integers(0, 2**16))
def test_a_bad_link_neither_stops_nor_drives(worse: int, delay: float, jitter: float, loss: float, seed: int) -> None:
    paths = [Path(SOUND, seed=seed), Path(delay, jitter, loss, seed=seed + 1)]
    drive = LinksDrive(*(paths[::-1] if worse == 0 else paths))
    drive.get_going()
    assert_drives_on(drive, 4.0)
    drive.held = None
    drive.run(0.7)
    assert drive.power == 0.0
    drive.each = lambda now: None if drive.power == 0.0 else pytest.fail("an old demand has moved it")
    drive.run(3.0)
    drive.held = "i"
    drive.each = lambda now: None
    drive.until(lambda: drive.power > 0.5, 0.5)


@pytest.mark.parametrize("link", [0, 1])
@pytest.mark.parametrize("how", ["cut", "frozen"])
def test_one_of_two_links_ends_and_comes_back(link: int, how: str) -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND * 2))
    drive.get_going()
    for ended in (True, False, True, False):
        setattr(drive.paths[link], how, ended)
        assert_drives_on(drive, 3.0)
    assert drive.rover.state is SafetyState.ARMED


def test_the_only_sound_link_is_cut_beside_a_late_one() -> None:
    drive = LinksDrive(Path(SOUND), Path(1.0))
    drive.get_going()
    drive.paths[0].cut = True
    power = drive.power
    drive.until(lambda: drive.power < power, 0.5 + 2 * SOUND)
    drive.until(lambda: drive.power == 0.0, 0.5)
    drive.each = lambda now: None if drive.power == 0.0 else pytest.fail("the late link drives")
    drive.run(6.0)


@pytest.mark.parametrize("intent", [Stop(), EmergencyStop(), Disarm(), SetMode(Mode.HOLD.name)])
@pytest.mark.parametrize("sound", [0, 1])
def test_a_stop_comes_over_whichever_link_is_there(intent: Stop | EmergencyStop | Disarm | SetMode, sound: int) -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND))
    drive.get_going()
    drive.paths[1 - sound].cut = True  # in the moment before the key: nothing knows it yet
    drive.held = None
    drive.tell(intent)
    drive.until(lambda: drive.power == 0.0, 0.6)
    if isinstance(intent, EmergencyStop | Disarm):
        drive.until(lambda: drive.rover.state is not SafetyState.ARMED, 0.1)


def test_a_command_without_an_answer_takes_the_other_link() -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND))
    drive.arm()
    assert len(set(commands(drive, Command.COMPONENT_ARM_DISARM))) == 1
    [used] = set(commands(drive, Command.COMPONENT_ARM_DISARM))
    drive.paths[used].cut = True
    drive.tell(SetMode(Mode.GUIDED.name))
    drive.until(lambda: drive.rover._safety.mode is Mode.GUIDED, 0.5)
    assert commands(drive, Command.DO_SET_MODE) == [used, 1 - used]


def asked(drive: LinksDrive) -> list[str]:
    """Return the requests for control that the log of the station shows."""
    return [line.text for line in drive.station.log._lines if "requests control" in line.text]


def ask_for_control(drive: LinksDrive) -> None:
    """Let another ground station, on the first link, ask the vehicle for control."""
    other = Channel("other", 0, system=254, component=190, target="vehicle")
    ask = m.CommandLong(1, 1, Command.REQUEST_OPERATOR_CONTROL, 0, 1.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0)
    for message in (m.Heartbeat(6, 8, 0, 0, 4, 3), ask):
        for data, _, _ in other.send(Outgoing(message)):
            drive.far.receive(0, data, "other", drive.now)


@pytest.mark.parametrize("sound", [0, 1])
def test_a_request_for_control_comes_over_the_link_that_is_there(sound: int) -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND * 2))
    drive.get_going()
    drive.paths[1 - sound].cut = True  # in the moment before the request: nothing knows it yet
    ask_for_control(drive)
    drive.run(0.2)
    assert asked(drive) == ["GCS 254 requests control of Rover 1"]


def test_a_request_for_control_is_shown_once() -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND * 2))
    drive.get_going()
    drive.paths[1].delay = 1.0  # the vehicle knows it as a link of the driver by now
    drive.run(2.5)
    ask_for_control(drive)
    drive.until(lambda: len(asked(drive)) == 1, 0.2)
    drive.tell(KeepControl())  # before the copy of the late link comes
    drive.run(3.0)
    assert len(asked(drive)) == 1
    assert drive.station.snapshot(drive.now, 0).handover is None


def test_manual_control_beside_proofs_takes_the_best_link() -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND * 2))
    drive.get_going()
    drive.run(1.0)
    drive.near.sent.clear()
    drive.run(1.0)
    links = [(type(message), link) for _, link, message in drive.near.sent]
    proofs = [link for kind, link in links if kind is m.RoverOperatorPresence]
    assert proofs.count(0) == proofs.count(1) >= 18
    [best] = {link for kind, link in links if kind is m.ManualControl}
    drive.paths[best].cut = True
    assert_drives_on(drive, 2.0)
    assert [link for _, link, message in drive.near.sent if isinstance(message, m.ManualControl)][-1] == 1 - best


def test_what_a_second_link_repeats_leaves_nothing_to_send() -> None:
    drive = LinksDrive(Path(SOUND), Path(SOUND * 2))
    drive.get_going()
    core, seen = drive.station, []
    receive = core.receive

    def note(received: Received, now: float) -> None:
        receive(received, now)
        seen.append((type(received.message), received.peer.link, core.repeats))
        assert not core.repeats or not core.messages_to_send()

    drive.near.core.receive = note  # type: ignore[method-assign]
    drive.run(2.0)
    attitudes = [(link, repeats) for kind, link, repeats in seen if kind is m.Attitude]
    assert {repeats for link, repeats in attitudes if link == 0} == {False}
    assert [repeats for link, repeats in attitudes if link == 1].count(True) >= 6


def test_what_both_links_bring_is_shown_once() -> None:
    drive = LinksDrive(Path(SOUND), Path(0.3, 0.1))
    drive.get_going()
    lines = [(line.text, line.count) for line in drive.station.log._lines]
    assert len([text for text, _ in lines if text.startswith("Armed by GCS 255")]) == 1
    assert all(count == 1 for _, count in lines)
    assert not any("another program" in text.lower() for text, _ in lines)


def test_a_late_link_is_named_to_the_driver_once() -> None:
    drive = LinksDrive(Path(SOUND), Path(1.5))
    drive.get_going()
    drive.run(5.0)
    texts = [line.text for line in drive.station.log._lines if "late" in line.text]
    assert texts == ["Demand from GCS 255 ignored: this link is 1.5 s late"]


# ---- a vehicle that knows no proofs: one link carries the demands ----


def axes_by_link(drive: LinksDrive, since: float) -> list[tuple[int, bool]]:
    """Return the demands that were sent: over which link, and whether they move."""
    return [
        (link, any(axis not in (0, m.INVALID_AXIS) for axis in (message.x, message.y, message.z, message.r)))
        for at, link, message in drive.near.sent
        if isinstance(message, m.ManualControl) and at >= since
    ]


@pytest.mark.parametrize("first", [0, 1])
def test_demands_of_a_foreign_vehicle_change_links_neutral_first(first: int) -> None:
    paths = [Path(SOUND), Path(SOUND)]
    paths[1 - first].cut = True  # so that the other one is found first
    drive = LinksDrive(*paths, vehicle=FakeArduPilot())
    drive.until(lambda: drive.station.snapshot(drive.now, 0).vehicle is not None)
    paths[1 - first].cut = False
    drive.arm()
    drive.held = "i"
    drive.run(3.0)
    sent = axes_by_link(drive, drive.now - 1.0)
    assert {(first, True)} == set(sent)
    ended = drive.now
    paths[first].cut = True
    drive.until(lambda: (1 - first, False) in axes_by_link(drive, ended), 0.5)
    changed = drive.now
    assert changed - ended >= 0.25
    assert (first, False) in axes_by_link(drive, changed - 0.05)  # what waits in the silent link ends in neutral, too
    paths[first].cut = False
    drive.run(3.0)
    later = axes_by_link(drive, changed)
    assert (1 - first, True) not in later  # the key is held all the while
    drive.held = None
    drive.run(1.0)
    drive.held = "i"
    drive.run(1.0)
    assert {(1 - first, True)} == set(axes_by_link(drive, drive.now - 0.5))


# ---- somebody who has the vehicle's id ----


class Thief:
    """A core in place of the vehicle that hears link 1 in its stead: it answers all commands, and carries out none."""

    def __init__(self, vehicle: Core) -> None:
        self._vehicle = vehicle
        self._answers: list[Outgoing] = []
        self.stole: list[int] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._vehicle, name)

    def receive(self, received: Received, now: float) -> None:
        message = received.message
        if received.peer.link == 0:
            self._vehicle.receive(received, now)
        elif isinstance(message, m.CommandLong | m.CommandInt):
            self.stole.append(message.command)
            self._answers.append(Outgoing(m.CommandAck(message.command, 0), received.peer))
        elif isinstance(message, m.Timesync) and not message.tc1:
            self._answers.append(Outgoing(m.Timesync(int(now * 1e9), message.ts1, 255, 190), received.peer))

    def messages_to_send(self) -> list[Outgoing]:
        answers, self._answers = self._answers, []
        return [*answers, *self._vehicle.messages_to_send()]


def robbed(*, signs: bool) -> tuple[LinksDrive, Thief]:
    """Return a driven rover on a slow link, and a thief on a fast one who copies each frame of the rover at once."""
    drive = LinksDrive(Path(0.1), Path(0.001))
    drive.paths[1].cut = True
    thief = Thief(drive.far.core)
    drive.far.core = thief
    if signs:
        now = drive.now
        drive.far.channels[0].guard = SigningGuard(keep(DRIVER, now=now), SIGNED_ONLY, 0)
        ours = keep(DRIVER, now=now)
        for index, channel in enumerate(drive.near.channels):
            channel.guard = SigningGuard(ours, SIGNED_ONLY, index)
    drive.get_going()
    drive.paths[1].cut = False
    hear = drive.near.receive

    def copy(link: int, data: bytes, address: Hashable, now: float) -> None:
        hear(link, data, address, now)
        if link == 0:
            hear(1, data, address, now)

    drive.near.receive = copy  # type: ignore[method-assign]
    drive.run(6.0)
    return drive, thief


def test_a_copied_id_swallows_single_commands_and_no_stop() -> None:
    drive, thief = robbed(signs=False)
    assert drive.power > 0.5
    drive.tell(SetMode(Mode.GUIDED.name))
    drive.run(2.0)
    assert Command.DO_SET_MODE in thief.stole
    assert drive.rover._safety.mode is Mode.MANUAL
    assert drive.power > 0.5
    drive.held = None
    drive.tell(EmergencyStop())
    drive.until(lambda: drive.power == 0.0, 0.6)
    drive.until(lambda: drive.rover.state is not SafetyState.ARMED, 0.3)


def test_signing_ends_what_a_copied_id_can_do() -> None:
    drive, _ = robbed(signs=True)
    assert drive.power > 0.5
    drive.tell(SetMode(Mode.GUIDED.name))
    drive.until(lambda: drive.rover._safety.mode is Mode.GUIDED, 1.5)
