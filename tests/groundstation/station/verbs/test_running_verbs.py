"""Verbs that go through a station: what of them leaves, as whose, and what ends their demands."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, OperatorFlag, SystemState, VehicleType
from dialects.messages import INVALID_AXIS, UINT16_MAX
from groundstation.intents.driving import EmergencyStop, Stop
from groundstation.intents.session import Quit
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Disarm, SetMode
from groundstation.station.driving.arming import ArmSequence
from groundstation.station.verbs.running_verbs import STOPPED, Purpose, RunningVerb, RunningVerbs, VerbMessage
from groundstation.station_socket.verb_run import ALIVE_WITHIN, KEEP
from groundstation.vehicles.demand.demand_stream import FINAL_NEUTRALS
from groundstation.verbs.control.arm import ArmJob
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.operator import PROOFS_FIRST
from groundstation.verbs.session.station_seat import StationSeat
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.fakes.verb_seat import SeatLog, verb_of
from tests.groundstation.cockpits import Cockpit, armed_cockpit

BEAT = m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)
STEP = 0.05


def said(message: m.Message) -> VerbMessage:
    """Return a message with what the verbs say of it."""
    kinds = {m.Heartbeat: Purpose.PRESENCE, m.RoverOperatorPresence: Purpose.PROOF, m.ManualControl: Purpose.MOTION}
    kinds[m.RcChannelsOverride] = Purpose.MOTION
    return VerbMessage(message, Purpose.NEUTRAL if message is CENTRE else kinds.get(type(message), Purpose.OTHER))


class Ashore:
    """A station without a screen, with an armed vehicle, and one verb that runs."""

    def __init__(self, vehicle: FakeVehicle | None = None, *, needs_session: bool = True) -> None:
        self.cockpit = armed_cockpit(vehicle)
        self.cockpit.leasing = False
        self.cockpit.run(2.0)
        self.began = self.cockpit.now
        self.seat = SeatLog()
        self.heard, self.refusals = self.seat.heard, self.seat.refusals
        self.verb = self.add("mavhelm send", needs_session=needs_session)
        self.alive = True

    def add(self, name: str, *, needs_session: bool = True, follows: bool = False, moves: bool = False) -> RunningVerb:
        verb = verb_of(name, needs_session=needs_session, follows=follows, moves=moves, seat=self.seat)
        self.verbs.join(verb, self.cockpit.now)
        return verb

    @property
    def verbs(self) -> RunningVerbs:
        return self.cockpit.station.verbs

    def send(self, *messages: m.Message, verb: RunningVerb | None = None) -> None:
        for message in messages:
            self.verbs.handle(verb or self.verb, said(message), self.cockpit.now)
        self.cockpit.world.settle()

    def run(self, seconds: float, *messages: m.Message) -> None:
        """Advance the time; send these messages all the while."""
        end = self.cockpit.now + seconds
        while self.cockpit.now < end:
            if self.alive:
                self.verbs.hear(self.verb, self.cockpit.now)
                self.send(*messages)
            self.cockpit.run(STEP)

    def passed(self, *messages: m.Message, verb: RunningVerb) -> list[int]:
        """Send messages of a verb; return how many of each kind reach the vehicle."""
        before = [len(self.of(type(each))) for each in messages]
        self.verbs.hear(verb, self.cockpit.now)
        self.send(*messages, verb=verb)
        self.cockpit.run(STEP)
        return [len(self.of(type(each))) - was for each, was in zip(messages, before, strict=True)]

    def of(self, kind: type[m.Message]) -> list[m.Message]:
        return [message for at, message in self.cockpit.vehicle.all(kind) if at >= self.began]


FULL = m.ManualControl(1, 1000, INVALID_AXIS, INVALID_AXIS, 0, 0)
CENTRE = m.ManualControl(1, 0, INVALID_AXIS, INVALID_AXIS, 0, 0)


@pytest.mark.parametrize(("needs_session", "count"), [(True, 1), (False, 0)])
def test_a_verb_that_looks_keeps_no_vehicle_from_its_failsafe(needs_session: bool, count: int) -> None:
    ashore = Ashore(needs_session=needs_session)
    ashore.run(1.0)
    assert ashore.of(m.Heartbeat) == []
    ashore.send(BEAT)
    ashore.run(0.1)
    assert len(ashore.of(m.Heartbeat)) == count


def test_the_heartbeat_of_a_screen_is_enough() -> None:
    ashore = Ashore()
    ashore.cockpit.leasing = True
    ashore.cockpit.run(1.0)
    before = len(ashore.of(m.Heartbeat))
    ashore.send(BEAT)
    assert len(ashore.of(m.Heartbeat)) == before


def test_proofs_are_those_of_the_stations_session() -> None:
    ashore = Ashore()
    station, began = ashore.cockpit.station, ashore.cockpit.now
    core = VerbCore(station, 1)
    StationSeat(station, core, "mavhelm arm", lambda: None, needs_session=True).join(began)
    core.contacts[1].begin(began)
    ashore.cockpit.run(1.0)
    ashore.run(0.5, FULL)
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    ashore.cockpit.run(1.0)
    proofs = [each for _, each in ashore.cockpit.vehicle.all(m.RoverOperatorPresence)]
    clocks = [each.time_boot_ms for each in proofs]
    assert len(ashore.of(m.RoverOperatorPresence)) >= PROOFS_FIRST + FINAL_NEUTRALS
    assert {each.session_id for each in proofs} == {7}
    assert clocks == sorted(set(clocks)), "those of the screen, the verb and the end of its demand have one clock"
    assert clocks[0] > 1000


def test_a_demand_ends_with_neutral_when_the_verb_ends() -> None:
    ashore = Ashore()
    ashore.run(0.5, FULL)
    assert ashore.cockpit.demands()[-1][1] == 1000
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    ashore.cockpit.world.settle()
    at = ashore.cockpit.now
    ashore.cockpit.run(1.0)
    assert [x for _, x, _ in ashore.cockpit.demands(at)] == [0] * 5
    assert not ashore.verbs.busy


def test_a_demand_of_a_stopped_verb_ends_and_does_not_resume() -> None:
    ashore = Ashore()
    ashore.run(0.5, FULL)
    ashore.alive, at = False, ashore.cockpit.now
    ashore.run(1.0)
    driven = [t for t, x, _ in ashore.cockpit.demands() if x]
    assert ashore.cockpit.demands()[-1][1] == 0
    assert min(t for t, x, _ in ashore.cockpit.demands(at) if not x) - at < ALIVE_WITHIN + 2 * STEP
    ashore.alive = True
    ashore.run(0.5, FULL)
    assert [t for t, x, _ in ashore.cockpit.demands() if x] == driven
    assert "stood still for" in ashore.refusals[0]


def test_a_station_that_ends_ends_the_demands_of_its_verbs() -> None:
    """The process ends as soon as nothing is left to do, so the neutral must not wait until the verb has ended."""
    ashore = Ashore()
    ashore.run(0.5, FULL)
    ashore.cockpit.do(Quit())
    at = ashore.cockpit.now
    assert not ashore.cockpit.station.finished
    ashore.run(1.0, FULL)
    demands = [x for t, x, _ in ashore.cockpit.demands(at) if t > at]
    assert len(demands) >= 5
    assert set(demands) == {0}
    assert not ashore.cockpit.station.finished, "the verb has not sent its last messages yet"
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    assert ashore.cockpit.station.finished


def test_a_thawed_verb_is_found_out_by_its_first_packet() -> None:
    """Nothing else may have run in between: the station stood still, too."""
    ashore = Ashore()
    ashore.run(0.5, FULL)
    now = ashore.cockpit.now + 1.0
    ashore.verbs.hear(ashore.verb, now)
    ashore.verbs.handle(ashore.verb, said(FULL), now)
    assert "stood still for 1." in ashore.refusals[0]
    queued = ashore.cockpit.station.messages_to_send()
    sent = [each.message for each in queued if isinstance(each.message, m.ManualControl)]
    assert {message.x for message in sent} == {0}


def test_of_two_verbs_the_first_drives() -> None:
    ashore = Ashore()
    other = ashore.add("mavhelm drive (pid 2)")
    ashore.run(0.2, FULL)
    ashore.send(FULL, verb=other)
    assert ashore.refusals == ["the mavhelm send drives"]
    ashore.run(0.2, FULL)
    assert ashore.cockpit.demands()[-1][1] == 1000


def test_neutral_of_a_verb_does_not_brake_the_one_that_drives() -> None:
    ashore = Ashore()
    second = ashore.add("mavhelm drive")
    ashore.run(0.2, FULL)
    assert ashore.passed(CENTRE, verb=second) == [0]
    assert ashore.passed(CENTRE, verb=ashore.verb) == [1], "its own neutral ends the drive"
    assert ashore.passed(CENTRE, verb=second) == [1], "nobody drives any more"


def test_a_screen_that_comes_ends_the_demand() -> None:
    ashore = Ashore()
    ashore.run(0.2, FULL)
    ashore.verbs.screen_that_drives = lambda: "screen on pts/1"
    ashore.run(0.5)
    assert ashore.cockpit.demands()[-1][1] == 0
    ashore.send(FULL)
    assert ashore.refusals == ["the screen on pts/1 drives"]


@pytest.mark.parametrize("intent", [Stop(), EmergencyStop(), Disarm(), SetMode(mode="HOLD")])
def test_a_stop_at_a_watching_screen_ends_the_demand(intent: AnyIntent) -> None:
    ashore = Ashore()
    ashore.run(0.5, FULL)
    assert ashore.cockpit.demands()[-1][1] == 1000
    ashore.cockpit.do(intent)
    ashore.cockpit.run(STEP)
    assert ashore.cockpit.demands()[-1][1] == 0
    ashore.run(2.0, FULL)
    assert ashore.cockpit.demands()[-1][1] == 0
    assert set(ashore.refusals) == {STOPPED}
    again = ashore.add("mavhelm drive (pid 2)", moves=True)
    assert not again.refused, "a program that is started after the stop may drive"
    assert ashore.passed(FULL, verb=again) == [1]


def test_a_stop_ends_what_may_move_and_nothing_else() -> None:
    ashore = Ashore()
    program, upload = ashore.add("mavhelm api (pid 2)", moves=True), ashore.add("mavhelm param (pid 3)")
    ashore.run(0.5)
    ashore.cockpit.do(Stop("quitting"))
    assert not ashore.refusals, "only the key of a person does"
    ashore.cockpit.do(Stop())
    assert ashore.refusals == [STOPPED]
    assert program.refused == STOPPED, "between two calls, too: the next one may start a mission"
    assert ashore.passed(FULL, verb=program) == [0]
    assert not upload.refused
    assert ashore.passed(m.ParamSet(1, 1, b"X", 1.0, 9), verb=upload) == [1]


def test_a_stop_of_the_screen_that_drives_ends_no_later_program() -> None:
    ashore = Ashore()
    ashore.verbs.screen_that_drives = lambda: "screen on pts/1"
    ashore.cockpit.do(Stop())
    ashore.verbs.screen_that_drives = lambda: None
    ashore.run(0.5, FULL)
    assert ashore.cockpit.demands()[-1][1] == 1000


def test_channels_are_centred_and_given_back() -> None:
    ashore = Ashore(FakeArduPilot())
    ashore.run(0.2, m.RcChannelsOverride(1, 1, 1500, UINT16_MAX, 1900, *[UINT16_MAX] * 5))
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    ashore.cockpit.run(1.0)
    sent = ashore.cockpit.vehicle.all(m.RcChannelsOverride)
    assert [message.chan3_raw for _, message in sent[-2:]] == [1500, 0]


def test_channels_that_a_verb_has_given_back_are_left_alone() -> None:
    ashore = Ashore(FakeArduPilot())
    ashore.run(0.2, m.RcChannelsOverride(1, 1, 1500, UINT16_MAX, 1900, *[UINT16_MAX] * 5))
    given_back = VerbMessage(m.RcChannelsOverride(1, 1, 0, UINT16_MAX, 0, *[UINT16_MAX] * 5), Purpose.NEUTRAL)
    ashore.verbs.handle(ashore.verb, given_back, ashore.cockpit.now)
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    ashore.cockpit.run(1.0)
    sent = ashore.cockpit.vehicle.all(m.RcChannelsOverride)
    assert [message.chan3_raw for _, message in sent[-2:]] == [1900, 0]


def test_a_demand_to_nobody_is_not_sent() -> None:
    ashore = Ashore()
    ashore.verbs.handle(ashore.verb, said(m.ManualControl(9, 1000, 0, 0, 0, 0)), ashore.cockpit.now)
    assert ashore.cockpit.station.messages_to_send() == []


def test_neutral_of_a_verb_is_left_out_while_the_station_streams() -> None:
    ashore = Ashore()
    ashore.cockpit.leasing = True
    ashore.cockpit.run(1.0)
    before = len(ashore.of(m.ManualControl))
    ashore.send(CENTRE)
    assert len(ashore.of(m.ManualControl)) == before


def test_arming_by_verb_is_control_of_a_vehicle_that_tells_none() -> None:
    cockpit = Cockpit(FakeArduPilot())
    cockpit.run(1.5)
    core = VerbCore(cockpit.station, 1)
    StationSeat(cockpit.station, core, "mavhelm arm", lambda: None, needs_session=True).join(cockpit.now)
    contact = core.contacts[1]
    assert contact.services.book.begin(1, "arm")
    contact.start(ArmJob(1, ArmSequence.start(contact.state, cockpit.now), contact.claim), cockpit.now)
    cockpit.run(1.5)
    assert cockpit.view.armed
    assert cockpit.view.in_control


def test_a_verb_that_comes_knows_at_once_what_was_heard() -> None:
    ashore = Ashore()
    ashore.heard.clear()
    ashore.add("mavhelm status")
    kinds = [type(each.message) for each in ashore.heard]
    assert kinds[0] is m.Heartbeat, "the verb would take nothing that comes before it"
    assert len(kinds) > 1
    assert m.CommandAck not in kinds


def test_the_key_of_setup_signing_reaches_no_verb() -> None:
    ashore = Ashore()
    ashore.run(1.0)
    key = ashore.heard[-1]._replace(message=m.SetupSigning(255, 190, [7] * 32, 1))
    ashore.heard.clear()
    ashore.verbs.receive(key, ashore.cockpit.now)
    ashore.add("mavhelm status")
    heard = [each.message for each in ashore.heard if isinstance(each.message, m.SetupSigning)]
    assert len(heard) >= 1
    assert not any(byte for message in heard for byte in message.secret_key)


@pytest.mark.parametrize("needs_session", [True, False])
def test_the_session_is_proven_before_what_may_need_control(needs_session: bool) -> None:
    ashore = Ashore(needs_session=needs_session)
    ashore.send(m.ParamSet(1, 1, b"WP_RADIUS", 2.0, 9))
    ashore.cockpit.run(0.1)
    kinds = [type(message) for at, message in ashore.cockpit.vehicle.received if at >= ashore.began]
    expected = [m.RoverOperatorPresence, m.ParamSet] if needs_session else [m.ParamSet]
    assert [kind for kind in kinds if kind in (m.RoverOperatorPresence, m.ParamSet)] == expected


PROOF = m.RoverOperatorPresence(1, 1, 5, 6, 99, 1, 0, OperatorFlag.AXES)


def test_verb_that_follows_keeps_the_session_of_the_former_verb() -> None:
    ashore = Ashore()
    assert not ashore.verbs.may_follow(ashore.cockpit.now)  # the last driver was a screen
    ashore.run(0.5)
    watch = ashore.add("mavhelm watch", needs_session=False, follows=ashore.verbs.may_follow(ashore.cockpit.now))
    assert ashore.passed(BEAT, PROOF, verb=watch) == [0, 0]  # the verb before still runs
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    assert ashore.passed(BEAT, PROOF, verb=watch) == [1, 1]


def test_what_follows_begins_soon_and_a_verb_that_looks_is_none() -> None:
    ashore = Ashore()
    ashore.run(0.5)
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    assert ashore.verbs.may_follow(ashore.cockpit.now + KEEP - STEP)
    assert not ashore.verbs.may_follow(ashore.cockpit.now + KEEP + STEP)
    assert ashore.passed(BEAT, PROOF, verb=ashore.add("mavhelm status", needs_session=False)) == [0, 0]


def test_a_screen_that_drove_since_then_leaves_nothing_to_follow() -> None:
    """Else the vehicle of a screen that was killed would drive on for as long as a verb looks."""
    ashore = Ashore()
    ashore.run(0.5)
    watch = ashore.add("mavhelm watch", needs_session=False, follows=True)
    ashore.verbs.leave(ashore.verb, ashore.cockpit.now)
    ashore.cockpit.leasing = True
    ashore.cockpit.run(0.5)
    ashore.cockpit.leasing = False
    ashore.cockpit.run(2.0)
    assert not ashore.verbs.may_follow(ashore.cockpit.now)
    assert ashore.passed(BEAT, PROOF, verb=watch) == [0, 0]
