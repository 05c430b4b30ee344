"""Who is in control, without a rover: takeover, succession, clashes, and the words for those who are not."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.axes import build_manual_control
from dialects.enums import Command, Severity
from link.core import Outgoing, Peer, Received
from tests.vehicle.bench import BEAT, NEUTRAL
from tests.vehicle.conversations import conversation
from vehicle.drive.conversation import Conversation
from vehicle.drive.operator_session import SENDERS_MAX, DrivingSession, Proof
from vehicle.drive.ownership import CLASH_REPORT_AGAIN, LINK_TIME, REPORT_AGAIN, Ownership
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue

BOOT = 50.0
GCS, OTHER = conversation(255, numbering=1), conversation(254, numbering=1)
TWIN = GCS._replace(peer=GCS.peer._replace(address="elsewhere"), numbering=3)
DEMAND = build_manual_control(NEUTRAL, 1)
ARM = m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0)
ASK = m.CommandLong(1, 1, Command.REQUEST_MESSAGE, 0, 0, 0, 0, 0, 0, 0, 0)
PROOF = Proof(session=7, clock=1, age=0.1)


class Scene:
    """Ownership with its texts; each frame has a digest of its own unless a test gives one."""

    def __init__(self, driver: Conversation | None = GCS, **params: float) -> None:
        self.now = 100.0
        self.logged: list[tuple[Severity, str]] = []
        self.texts = StatusTextQueue(lambda severity, text: self.logged.append((severity, text)))
        self.ownership = Ownership(Params({"FS_GCS_TIMEOUT": 5} | params), self.texts, BOOT)
        self._digest = 0
        if driver is not None:
            assert self.ownership.take(driver, self.now)

    def hear(
        self, speaker: Conversation, message: m.Message = DEMAND, *, digest: int | None = None, clash: bool = False
    ) -> bool:
        self._digest += 1
        system, component, peer, numbering = speaker
        received = Received(message, system, component, 0, peer, True, False, numbering, clash, digest or self._digest)
        return self.ownership.hear(received, self.now)

    def wait(self, seconds: float) -> Scene:
        self.now += seconds
        return self

    def said(self, part: str) -> int:
        return sum(part in text for _, text in self.logged)

    def told(self, speaker: Conversation) -> list[Outgoing]:
        """What only this peer is told, since the last call."""
        return [each for each in self.texts.pop_replies() if each.peer == speaker.peer]

    def prove(self, speaker: Conversation, proof: Proof = PROOF, *, good: bool = True) -> None:
        self.ownership.add_proof(speaker, proof, self.now, good=good)


def test_bounds() -> None:
    assert (REPORT_AGAIN, CLASH_REPORT_AGAIN, LINK_TIME) == (60.0, 10.0, 2.0)


class TestQuestions:
    def test_without_a_driver(self) -> None:
        scene = Scene(None)
        assert (scene.ownership.owner, scene.ownership.session) == (0, None)
        assert not scene.ownership.is_driver(GCS, scene.now)
        assert not scene.ownership.has_driver_ids(GCS)
        assert not scene.ownership.is_silent(scene.now)
        assert not scene.ownership.is_barred(GCS, scene.now)
        assert scene.ownership.silence_duration(scene.now) == scene.now - BOOT
        assert scene.ownership.denial_reason(GCS, scene.now) is None
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now) == "no GCS is in control, arm to take it"

    def test_what_each_sender_is_told(self) -> None:
        scene = Scene()
        reason = scene.ownership.denial_reason
        assert reason(GCS, scene.now) is None
        assert reason(OTHER, scene.now) == "GCS 255 is in control"
        assert reason(TWIN, scene.now) == "another program with your ids 255/190 is in control, use other ids"
        assert reason(GCS._replace(component=1), scene.now) == "GCS 255 is in control"

    def test_a_link_of_the_driver_that_is_late_is_named(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        scene.prove(TWIN, PROOF._replace(age=2.04), good=False)
        assert scene.ownership.denial_reason(TWIN, scene.now) == "this link is 2.0 s late"
        for _ in range(9):
            scene.hear(TWIN)
        assert not scene.told(GCS)

    def test_a_link_of_the_driver_whose_proofs_have_ended_is_named(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        assert scene.ownership.denial_reason(GCS, scene.now) is None
        assert scene.ownership.denial_reason(GCS, scene.now + 1.5) == "no proof on this link for 1.5 s"

    def test_only_a_link_of_the_drivers_session_misses_a_proof(self) -> None:
        scene = Scene(None)
        missing = scene.ownership.missing_proof
        assert missing(GCS, scene.now) is None
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        assert missing(GCS, scene.now + 1.0) is None
        assert missing(GCS, scene.now + 1.5) == "no proof on this link for 1.5 s"
        assert missing(OTHER, scene.now + 1.5) is missing(TWIN, scene.now + 1.5) is None
        scene.prove(TWIN, PROOF._replace(age=2.04), good=False)
        assert missing(TWIN, scene.now) == "this link is 2.0 s late"
        scene.prove(GCS)
        assert missing(GCS, scene.now) is None

    def test_a_driver_without_sessions_misses_no_proof(self) -> None:
        scene = Scene()
        assert scene.ownership.missing_proof(GCS, scene.now + 1.5) is None

    def test_a_link_with_proofs_as_old_as_may_be_is_not_late(self) -> None:
        scene = Scene(None)
        scene.prove(GCS, PROOF._replace(age=0.45))
        scene.ownership.take(GCS, scene.now)
        assert scene.ownership.denial_reason(GCS, scene.now + 1.5) == "no proof on this link for 1.5 s"

    def test_a_driver_proves_for_a_second_after_a_proof_good_or_not(self) -> None:
        scene = Scene(None)
        scene.prove(GCS, good=False)
        assert not scene.ownership.driver_proves(scene.now)
        scene.ownership.take(GCS, scene.now)
        assert scene.ownership.driver_proves(scene.now + 1.0)
        assert not scene.ownership.driver_proves(scene.now + 1.01)

    def test_of_the_provers_the_one_silent_longest_is_forgotten(self) -> None:
        scene = Scene()
        others = [conversation(system, numbering=1) for system in range(1, SENDERS_MAX)]
        for sender in (GCS, *others, GCS, conversation(99, numbering=1)):
            scene.prove(sender, good=False)
        assert scene.ownership.driver_proves(scene.now)
        for system in range(100, 99 + SENDERS_MAX):
            scene.prove(conversation(system, numbering=1), good=False)
        assert not scene.ownership.driver_proves(scene.now)

    def test_only_the_configured_ids(self) -> None:
        scene = Scene(None, MAV_GCS_SYSID=254)
        reason = "only GCS 254 may control (MAV_GCS_SYSID)"
        assert scene.ownership.denial_reason(GCS, scene.now) == reason
        assert scene.ownership.takeover_denial_reason(GCS, scene.now) == reason
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now) == reason
        assert scene.ownership.denial_reason(OTHER, scene.now) is None

    def test_setpoints_of_a_session_are_as_fresh_as_its_proof(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now + 0.34) is None
        scene.prove(GCS, PROOF._replace(age=0.45))
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now) is None
        late = scene.ownership.setpoint_denial_reason(GCS, scene.now + 0.01)
        assert late == "older than OPR_ECHO_MAX on arrival"
        assert scene.ownership.setpoint_denial_reason(OTHER, scene.now) == "GCS 255 is in control"

    def test_setpoints_of_a_driver_that_repeats_frames_do_not_count(self) -> None:
        scene = Scene()
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now) is None
        scene.hear(GCS, digest=77)
        scene.wait(1.0).hear(GCS, digest=77)
        assert scene.ownership.setpoint_denial_reason(GCS, scene.now) == "it repeats old frames"


class TestUnprovenDemands:
    def test_they_count_of_a_driver_without_sessions(self) -> None:
        assert Scene().ownership.accepts_unproven_demand(100.0)
        assert not Scene(None).ownership.accepts_unproven_demand(100.0)

    def test_not_of_a_session(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        assert not scene.ownership.accepts_unproven_demand(scene.now)

    def test_not_while_it_repeats_old_frames_or_clashes(self) -> None:
        scene = Scene()
        assert scene.ownership.driver is not None
        scene.ownership.driver.is_copy = True
        assert not scene.ownership.accepts_unproven_demand(scene.now)
        scene.ownership.driver.is_copy = False
        scene.ownership.driver.barred_until = scene.now + 0.1
        assert not scene.ownership.accepts_unproven_demand(scene.now)


class TestTake:
    def test_the_text_goes_to_all(self) -> None:
        assert Scene().logged == [(Severity.NOTICE, "GCS 255 is in control")]

    def test_again_changes_nothing(self) -> None:
        scene = Scene()
        scene.ownership.takeover_allowed = True
        assert not scene.wait(3.0).ownership.take(GCS, scene.now)
        assert scene.ownership.silence_duration(scene.now) == 0.0
        assert scene.ownership.takeover_allowed
        assert len(scene.logged) == 1

    def test_another_one_begins_without_permissions(self) -> None:
        scene = Scene()
        scene.ownership.takeover_allowed = True
        assert scene.ownership.take(OTHER, scene.now)
        assert not scene.ownership.takeover_allowed

    def test_one_that_has_only_repeated_frames_begins_as_a_copy(self) -> None:
        scene = Scene(None)
        for digest in (11, 12):
            scene.hear(GCS, digest=digest)
        scene.ownership.take(GCS, scene.now)
        scene.ownership.release("gave it up", scene.now)
        scene.hear(TWIN, digest=11)
        scene.hear(OTHER)
        scene.ownership.take(TWIN, scene.now)
        assert scene.ownership.driver is not None
        assert scene.ownership.driver.is_copy
        scene.ownership.take(OTHER, scene.now)
        assert scene.ownership.driver.is_copy is False

    def test_the_other_links_of_a_station_are_known_by_its_session(self) -> None:
        scene, elsewhere = Scene(None), GCS._replace(peer=Peer(9, "lte"))
        for speaker in (GCS, elsewhere, GCS._replace(numbering=GCS.numbering + 5)):
            scene.prove(speaker)
        assert scene.ownership.other_peers(elsewhere, scene.now) == [GCS.peer, GCS.peer]
        assert scene.ownership.other_peers(GCS, scene.now) == [elsewhere.peer]
        scene.prove(elsewhere, PROOF._replace(session=8))
        assert scene.ownership.other_peers(elsewhere, scene.now) == []

    def test_a_proof_of_other_ids_is_not_that_of_the_driver(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        scene.wait(2.0).prove(OTHER)
        assert scene.ownership.silence_duration(scene.now) == 2.0
        scene.prove(TWIN, PROOF._replace(session=8))
        assert scene.ownership.silence_duration(scene.now) == 2.0
        scene.prove(TWIN, good=False)
        assert scene.ownership.silence_duration(scene.now) == 2.0
        scene.prove(TWIN)
        assert scene.ownership.silence_duration(scene.now) == 0.0
        assert scene.ownership.driver is not None
        assert scene.ownership.driver.conversation == TWIN


class TestLiveness:
    def test_every_message_of_a_driver_without_sessions_counts(self) -> None:
        scene = Scene()
        scene.wait(3.0).hear(GCS, BEAT)
        assert scene.ownership.silence_duration(scene.now) == 0.0
        for stranger in (OTHER, TWIN):
            scene.wait(1.0).hear(stranger, BEAT)
        assert scene.ownership.silence_duration(scene.now) == 2.0

    def test_of_a_session_only_proofs_count(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        scene.wait(0.5).hear(GCS, BEAT)
        assert scene.ownership.silence_duration(scene.now) == 0.5

    def test_it_is_lost_after_its_time(self) -> None:
        scene = Scene()
        assert not scene.ownership.is_lost(scene.now + 5.0)
        assert scene.ownership.is_lost(scene.now + 5.1)

    def test_it_is_silent_when_another_session_may_succeed_it(self) -> None:
        scene = Scene()
        scene.hear(GCS)
        assert not scene.ownership.is_silent(scene.now + 0.69)
        proven = Scene(None)
        proven.prove(GCS)
        proven.ownership.take(GCS, proven.now)
        assert proven.ownership.is_silent(proven.now + 0.71)
        assert scene.ownership.is_silent(scene.now + 0.71)


class TestSuccession:
    @pytest.mark.parametrize("message", [DEMAND, ARM])
    def test_by_a_program_that_drives_or_commands(self, message: m.Message) -> None:
        scene = Scene()
        scene.hear(GCS)
        scene.wait(0.8)
        assert [scene.hear(TWIN, message) for _ in range(4)] == [False, False, True, False]
        assert scene.ownership.is_driver(TWIN, scene.now)
        assert scene.logged[-1] == (
            Severity.NOTICE, "GCS 255 drives from another program now: release the keys first"
        )  # fmt: skip

    def test_not_by_heartbeats_nor_by_other_ids_nor_by_copies(self) -> None:
        scene = Scene()
        for digest in (901, 902, 903):
            scene.hear(GCS, digest=digest)
        scene.wait(0.8)
        assert not any(scene.hear(TWIN, BEAT) for _ in range(9))
        assert not any(scene.hear(OTHER) for _ in range(9))
        copies = TWIN._replace(numbering=9)
        assert not any(scene.hear(copies, digest=digest) for digest in (901, 902, 903, 901))
        assert scene.ownership.is_driver(GCS, scene.now)

    def test_not_by_commands_that_only_ask(self) -> None:
        scene = Scene()
        scene.hear(GCS)
        scene.wait(0.8)
        assert not any(scene.hear(TWIN, ASK) for _ in range(9))
        assert scene.hear(TWIN, ARM)

    def test_not_while_the_driver_speaks(self) -> None:
        scene = Scene()
        for _ in range(20):
            scene.wait(0.2).hear(GCS)
            assert not scene.hear(TWIN)

    def test_a_session_needs_one_command_only(self) -> None:
        scene = Scene()
        scene.hear(GCS)
        scene.wait(0.8).prove(TWIN)
        assert scene.hear(TWIN, ARM)
        assert scene.ownership.session is not None
        assert scene.ownership.session.id == 7

    def test_by_hand(self) -> None:
        scene = Scene()
        scene.hear(GCS)
        session = DrivingSession.begin(TWIN, PROOF, scene.now)
        assert not scene.wait(0.5).ownership.succeed(TWIN, session, scene.now)
        assert scene.wait(0.3).ownership.succeed(TWIN, session, scene.now)
        assert not Scene(None).ownership.succeed(TWIN, session, scene.now)


class TestReports:
    def test_the_driver_is_told_of_a_twin_and_again_after_a_minute(self) -> None:
        scene = Scene()
        counts = []
        for _ in range(130):
            scene.wait(0.5).hear(GCS)
            scene.hear(TWIN)
            counts.append(len(scene.told(GCS)))
        assert sum(counts) == 2 * 2  # in two chunks each time
        assert not any(counts[:2])
        assert scene.said("Another program uses your ids 255/190: it may only stop") == 2

    def test_a_session_is_told_as_well(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        for _ in range(3):
            scene.hear(TWIN)
        assert not scene.told(GCS)  # it may yet prove to be another link of the session
        scene.wait(LINK_TIME - 0.01).hear(TWIN)
        assert not scene.told(GCS)
        scene.wait(0.01).hear(TWIN)
        assert scene.told(GCS)

    def test_another_link_of_the_session_is_told_nothing(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.prove(TWIN)
        scene.ownership.take(GCS, scene.now)
        for _ in range(9):
            scene.wait(0.1).hear(TWIN)
        assert scene.ownership.is_driver(TWIN, scene.now)
        scene.wait(LINK_TIME).hear(TWIN)
        assert not scene.told(GCS)

    def test_who_may_yet_be_a_link(self) -> None:
        scene = Scene()
        assert not scene.ownership.may_be_link(TWIN, scene.now)  # the driver has no session
        scene = Scene(None)
        assert not scene.ownership.may_be_link(TWIN, scene.now)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        assert scene.ownership.may_be_link(TWIN, scene.now)
        assert not scene.ownership.may_be_link(OTHER, scene.now)

    def test_a_minute_later_is_again(self) -> None:
        scene = Scene()
        scene.hear(TWIN, BEAT)
        scene.ownership.report_other_session(TWIN, 100.0)
        scene.told(GCS)
        scene.ownership.report_other_session(TWIN, 159.0)
        assert not scene.told(GCS)
        scene.ownership.report_other_session(TWIN, 160.0)
        assert scene.told(GCS)

    def test_not_of_a_few_frames_nor_of_heartbeats_or_copies(self) -> None:
        scene = Scene()
        scene.hear(GCS, digest=901)
        scene.hear(TWIN)
        scene.hear(TWIN)
        for _ in range(9):
            scene.hear(TWIN._replace(numbering=8), digest=901)
            scene.hear(TWIN._replace(numbering=9), BEAT)
        assert not scene.told(GCS)

    def test_another_session_is_reported_when_it_has_been_heard(self) -> None:
        scene = Scene()
        scene.ownership.report_other_session(TWIN, scene.now)
        assert not scene.told(GCS)
        scene.hear(TWIN, BEAT)
        scene.ownership.report_other_session(TWIN, scene.now)
        assert len(scene.told(GCS)) == 2
        scene.ownership.report_other_session(TWIN, scene.now)
        assert not scene.told(GCS)
        scene.ownership.release("gave it up", scene.now)
        scene.ownership.report_other_session(TWIN, scene.now + 100.0)
        assert not scene.told(GCS)


class TestClash:
    def test_the_driver_is_barred_and_all_are_told_once_in_10_s(self) -> None:
        scene = Scene()
        text = "Two programs count as 255/190 behind one address: stopped"
        scene.hear(GCS, clash=True)
        assert scene.logged[-1] == (Severity.CRITICAL, text)
        assert scene.ownership.is_barred(GCS, scene.now)
        assert not scene.ownership.is_barred(TWIN, scene.now)
        assert scene.ownership.denial_reason(GCS, scene.now) == "two programs count as 255/190"
        scene.wait(10.0).hear(GCS, clash=True)
        assert scene.said(text) == 1
        scene.wait(0.1).hear(GCS, clash=True)
        assert scene.said(text) == 2
        assert not scene.ownership.is_barred(GCS, scene.now + 0.7)

    def test_it_is_no_sign_of_life(self) -> None:
        scene = Scene()
        scene.wait(2.0).hear(GCS, clash=True)
        assert scene.ownership.silence_duration(scene.now) == 2.0

    @pytest.mark.parametrize("elsewhere", [OTHER, TWIN, GCS._replace(component=1), GCS._replace(system=9)])
    def test_clashes_of_others_are_none_of_it(self, elsewhere: Conversation) -> None:
        scene = Scene()
        scene.hear(elsewhere, clash=True)
        assert not scene.ownership.is_barred(GCS, scene.now)

    def test_another_run_of_numbers_at_its_peer_clashes_too(self) -> None:
        scene = Scene()
        scene.hear(GCS._replace(numbering=2), clash=True)
        assert scene.ownership.is_barred(GCS, scene.now)

    def test_of_a_session_it_does_not_matter(self) -> None:
        scene = Scene(None)
        scene.prove(GCS)
        scene.ownership.take(GCS, scene.now)
        scene.hear(GCS, clash=True)
        assert not scene.ownership.is_barred(GCS, scene.now)

    def test_a_new_driver_begins_without_a_clash(self) -> None:
        scene = Scene()
        scene.hear(GCS, clash=True)
        scene.ownership.take(OTHER, scene.now)
        scene.hear(OTHER, clash=True)
        assert scene.said("Two programs count as 254/190") == 1
