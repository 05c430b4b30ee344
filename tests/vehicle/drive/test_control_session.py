"""Control without a rover: demands of operator sessions, and who succeeds a session."""

from __future__ import annotations

import pytest

from dialects.enums import OperatorFlag
from dialects.messages import INVALID_AXIS, RoverOperatorPresence
from tests.vehicle.bench import AHEAD, BEAT, DRIVER, NEUTRAL, OTHER
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import BOOT, Rig
from vehicle.drive.conversation import Conversation
from vehicle.drive.driver import SUCCESSION_TIME

ECHO_MAX = 0.5
NO_AXES: dict[str, int] = {"x": INVALID_AXIS, "r": INVALID_AXIS}


class Sessions(Rig):
    """With proofs: each is 0.1 s old when it arrives, unless told."""

    def __init__(self, **params: float) -> None:
        super().__init__(**{"OPR_ECHO_MAX": ECHO_MAX, "MAN_TIMEOUT": 1.0} | params)
        self.clock = 0

    def prove(
        self,
        session: int = 7,
        *,
        age: float = 0.1,
        system: int = DRIVER,
        target: int = 1,
        x: int = 0,
        r: int = 0,
        y: int = INVALID_AXIS,
        clock: int | None = None,
        introduced: bool = True,
        numbering: int = 0,
        flags: int = 0,
    ) -> bool:
        """A ROVER_OPERATOR_PRESENCE with axes, at once."""
        self.clock += 1
        message = RoverOperatorPresence(
            target, 1, self.clock if clock is None else clock, round((self.now - BOOT - age) * 1000), session, 1, 0,
            int(OperatorFlag.AXES) | flags, x, y, INVALID_AXIS, r,
        )  # fmt: skip
        received = self.received(message, system, introduced=introduced)._replace(numbering=numbering)
        self.control.hear(received, self.now)
        return self.control.handle_operator_presence(received, message, self.now)

    @property
    def source(self) -> Conversation:
        return conversation(DRIVER)

    def owned(self) -> Sessions:
        """Session 7 of DRIVER is in control, with a stick at rest."""
        self.prove()
        self.control.take(self.source, self.now)
        assert self.control.ownership.session is not None
        assert self.prove()
        assert self.control.neutral_seen
        return self


class TestTakingControl:
    def test_the_session_of_the_sender_takes_it(self) -> None:
        rig = Sessions()
        assert not rig.prove()
        rig.control.take(rig.source, rig.now)
        assert rig.control.ownership.session is not None
        assert rig.control.ownership.session.id == 7

    @pytest.mark.parametrize(
        "wrong", [{"age": ECHO_MAX + 0.001}, {"target": 2}, {"introduced": False}, {"system": OTHER}]
    )
    def test_without_a_good_proof_of_its_own_there_is_none(self, wrong: dict[str, float]) -> None:
        rig = Sessions()
        assert not rig.prove(**wrong)  # type: ignore[arg-type]
        rig.control.take(rig.source, rig.now)
        assert rig.control.ownership.session is None

    def test_a_proof_at_the_limit_is_good(self) -> None:
        rig = Sessions()
        rig.prove(age=ECHO_MAX)
        rig.control.take(rig.source, rig.now)
        assert rig.control.ownership.session is not None

    def test_who_is_in_control_may_add_its_session_and_keeps_it(self) -> None:
        rig = Sessions()
        rig.control.take(conversation(DRIVER), rig.now)
        assert rig.control.ownership.session is None
        assert not rig.prove(7)
        rig.control.take(rig.source, rig.now)
        session = rig.control.ownership.session
        assert session is not None
        rig.prove(8)
        rig.control.take(rig.source, rig.now)
        assert rig.control.ownership.session is session

    def test_another_owner_and_a_release_end_it(self) -> None:
        rig = Sessions().owned()
        rig.control.take(conversation(OTHER), rig.now)
        assert rig.control.ownership.session is None
        rig = Sessions().owned()
        rig.control.release("gave it up", rig.now)
        assert rig.control.ownership.session is None

    def test_at_the_start_nothing_has_been_succeeded(self) -> None:
        assert not Sessions().control.pop_succession()
        assert not Sessions().owned().control.pop_succession()


class TestDemands:
    def test_a_proof_is_a_demand_for_the_rest_of_its_age(self) -> None:
        rig = Sessions().owned()
        assert rig.prove(x=500, age=0.2)
        demand = rig.control.demand
        assert demand is not None
        assert (demand.throttle, demand.time) == (0.5, rig.now)
        assert demand.lifetime == pytest.approx(0.3)
        assert rig.control.demand_timeout == pytest.approx(0.3)
        assert rig.control.presence.known
        assert rig.control.presence.echo_age(rig.now) == pytest.approx(0.2)

    def test_a_copy_and_one_that_was_overtaken_are_none(self) -> None:
        rig = Sessions().owned()
        assert rig.prove(x=500, clock=10)
        assert not rig.prove(x=500, clock=10)
        assert not rig.prove(x=900, clock=9)
        assert rig.control.demand is not None
        assert rig.control.demand.throttle == 0.5
        assert rig.prove(x=600, clock=11)

    def test_an_old_motion_is_rejected_and_an_old_stop_still_stops(self) -> None:
        rig = Sessions().owned()
        assert rig.prove(x=500)
        assert rig.prove(x=500, age=2.0) is False
        assert rig.said("OPR_ECHO_MAX")
        rig.control.require_neutral()
        assert rig.prove(age=2.0, clock=50)
        assert not rig.control.requests_motion()
        assert not rig.control.neutral_seen
        assert not rig.prove(x=500, clock=49)  # sent before that stop

    def test_a_proof_over_a_second_link_is_not_another_program(self) -> None:
        rig = Sessions().owned()
        rig.control.hear(rig.received(BEAT)._replace(numbering=2), rig.now)
        assert rig.prove(x=500, numbering=2)
        assert not rig.said("Another program")

    def test_without_an_axis_it_is_a_sign_of_life_and_no_demand(self) -> None:
        rig = Sessions().owned()
        before = rig.control.demand
        rig.now += 3.0
        assert not rig.prove(x=INVALID_AXIS, r=INVALID_AXIS)
        assert rig.control.demand is before
        assert rig.control.ownership.silence_duration(rig.now) == 0.0

    def test_an_old_proof_is_no_sign_of_life(self) -> None:
        rig = Sessions().owned()
        rig.now += 3.0
        rig.prove(x=0, age=2.0)
        assert rig.control.ownership.silence_duration(rig.now) == 3.0

    @pytest.mark.parametrize(("kind", "side"), [(1, None), (4, 0.5)])
    def test_sideways_where_the_vehicle_can(self, kind: float, side: float | None) -> None:
        rig = Sessions(DRIVE_TYPE=kind).owned()
        assert rig.prove(y=500)
        assert rig.control.demand is not None
        assert rig.control.demand.sideways == side

    def test_heartbeats_with_its_system_id_are_no_sign_of_life(self) -> None:
        rig = Sessions().owned()
        rig.now += 3.0
        rig.control.hear(rig.received(BEAT), rig.now)
        assert rig.control.ownership.silence_duration(rig.now) == 3.0

    def test_a_presence_without_axes_is_none_of_it(self) -> None:
        rig = Sessions().owned()
        rig.now += 3.0
        rig.presence()
        assert rig.control.ownership.silence_duration(rig.now) == 3.0

    def test_of_another_system_it_is_none(self) -> None:
        rig = Sessions().owned()
        assert not rig.prove(x=500, system=OTHER)
        assert not rig.control.requests_motion()


class TestSuccession:
    @pytest.mark.parametrize(("silence", "succeeds"), [(SUCCESSION_TIME - 0.1, False), (SUCCESSION_TIME + 0.1, True)])
    def test_another_session_takes_over_where_the_owners_is_silent(self, silence: float, succeeds: bool) -> None:
        rig = Sessions().owned()
        rig.prove(x=500)
        rig.now += silence
        assert rig.prove(8, numbering=2) is succeeds
        assert rig.control.ownership.session is not None
        assert rig.control.ownership.session.id == (8 if succeeds else 7)
        assert rig.said("Another program uses your ids 255/190: it may only stop") is not succeeds
        assert rig.control.pop_succession() is succeeds
        assert not rig.control.pop_succession()

    @pytest.mark.parametrize("wrong", [{"age": 2.0}, NO_AXES])
    def test_only_with_a_good_proof_of_a_demand(self, wrong: dict[str, float]) -> None:
        rig = Sessions().owned()
        rig.now += 2.0
        assert not rig.prove(8, **wrong)  # type: ignore[arg-type]
        assert rig.control.ownership.session is not None
        assert rig.control.ownership.session.id == 7
        assert not rig.said("Another program")

    def test_the_successor_begins_with_neutral_and_without_a_demand(self) -> None:
        rig = Sessions().owned()
        rig.prove(x=500)
        rig.now += 1.0
        assert rig.prove(8, x=900)
        assert not rig.control.neutral_seen
        assert rig.said("release the keys first")
        assert rig.control.ownership.silence_duration(rig.now) == 0.0

    def test_former_drivers_neutral_is_no_proof_for_the_successor(self) -> None:
        rig = Sessions().owned()
        rig.now += 1.0
        assert rig.prove(8, x=900)
        assert not rig.control.neutral_seen

    def test_a_station_without_sessions_may_follow_one_that_is_lost(self) -> None:
        rig = Sessions(FS_GCS_TIMEOUT=5).owned()
        assert not rig.stick(AHEAD)
        rig.now += 4.9
        assert not rig.stick(AHEAD)
        assert rig.control.ownership.session is not None
        rig.now += 0.2
        assert [rig.stick(NEUTRAL) for _ in range(2)] == [False, True]
        assert rig.control.ownership.session is None
        assert not rig.control.presence.known
        assert rig.control.ownership.silence_duration(rig.now) == 0.0
        assert rig.control.pop_succession()

    def test_its_first_demand_forgets_the_one_before(self) -> None:
        rig = Sessions(FS_GCS_TIMEOUT=5).owned()
        rig.prove(x=500)
        rig.control.neutral_seen = True
        rig.now += 5.1
        assert [rig.stick(AHEAD) for _ in range(3)] == [False, False, True]
        assert not rig.control.neutral_seen


class TestWithoutAGoodProof:
    """A ground station that has proven late only: its demands have the bound of a driver that echoes."""

    def late(self) -> Sessions:
        rig = Sessions()
        rig.prove(age=2.0)
        rig.control.take(rig.source, rig.now)
        assert rig.control.ownership.session is None
        return rig

    def test_its_demands_wait_for_another_proof(self) -> None:
        rig = self.late()
        assert rig.stick(NEUTRAL)
        assert not rig.control.neutral_seen
        assert not rig.stick(AHEAD)

    def test_one_that_has_proven_nothing_need_not(self) -> None:
        rig = Sessions()
        rig.control.take(rig.source, rig.now)
        assert rig.stick(NEUTRAL)
        assert rig.control.neutral_seen
        assert rig.stick(AHEAD)

    def test_its_demands_end_when_what_it_has_seen_is_that_old(self) -> None:
        rig = self.late()
        rig.presence(echo=round((rig.now - BOOT - 0.2) * 1000))
        assert rig.stick(NEUTRAL)
        assert rig.control.demand is not None
        assert rig.control.demand.lifetime == pytest.approx(ECHO_MAX - 0.2)
        assert rig.control.demand_timeout == pytest.approx(ECHO_MAX - 0.2)


@pytest.mark.parametrize("flags", [0, int(OperatorFlag.OVERRIDE)])
def test_a_demand_says_whether_it_overrides_obstacles(flags: int) -> None:
    rig = Sessions().owned()
    assert rig.prove(x=600, flags=flags)
    assert rig.control.demand is not None
    assert rig.control.demand.throttle
    assert rig.control.demand.override == bool(flags)
