"""Control without a rover: who is in control, and what a change of the owner ends."""

from __future__ import annotations

import pytest

from dialects.axes import build_manual_control
from dialects.enums import Severity
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import START, Rig


class TestOwner:
    def test_a_new_one_starts_again(self) -> None:
        rig = Rig().controlled()
        rig.presence()
        rig.control.ownership.takeover_allowed = True
        rig.now += 3.0
        rig.control.take(conversation(OTHER), rig.now)
        assert rig.control.ownership.owner == OTHER
        assert rig.control.ownership.silence_duration(rig.now) == 0.0
        assert not rig.control.ownership.takeover_allowed
        assert not rig.control.presence.known
        assert not rig.control.neutral_seen
        assert rig.control.demand is None
        assert rig.severity(f"GCS {OTHER} is in control") is Severity.NOTICE

    def test_the_same_again_keeps_everything(self) -> None:
        rig = Rig().controlled()
        rig.presence()
        rig.control.ownership.takeover_allowed = True
        texts = len(rig.texts)
        rig.now += 3.0
        rig.control.take(conversation(DRIVER), rig.now)
        assert rig.control.ownership.silence_duration(rig.now) == 0.0
        assert rig.control.ownership.takeover_allowed
        assert rig.control.presence.known
        assert rig.control.neutral_seen
        assert len(rig.texts) == texts

    def test_after_its_release_no_station_is_in_control(self) -> None:
        rig = Rig().controlled()
        rig.control.release("gave it up", rig.now)
        assert rig.control.ownership.owner == 0
        assert rig.control.demand is None
        assert not rig.control.neutral_seen
        assert rig.severity(f"GCS {DRIVER} gave it up") is Severity.NOTICE

    @pytest.mark.parametrize("change", ["release", "owner"])
    def test_after_a_change_others_are_told_again_of_their_refusal(self, change: str) -> None:
        rig = Rig().controlled()
        assert not rig.stick(AHEAD, OTHER)
        first = sum(f"GCS {OTHER} ignored" in text for _, text in rig.texts)
        assert not rig.stick(AHEAD, OTHER)
        rig.now += 60.0
        rig.control.release("gave it up", rig.now) if change == "release" else rig.control.take(
            conversation(9), rig.now
        )
        assert not rig.stick(AHEAD, OTHER)
        assert not rig.stick(AHEAD, OTHER)
        assert sum(f"GCS {OTHER} ignored" in text for _, text in rig.texts) == first + 1 == 2
        assert rig.control.not_in_control_count == 4
        assert rig.severity("ignored") is Severity.WARNING

    def test_who_may_command(self) -> None:
        rig = Rig()
        assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None
        rig.control.take(conversation(DRIVER), START)
        assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None
        assert str(DRIVER) in (rig.control.ownership.denial_reason(conversation(OTHER), START) or "")

    def test_who_may_take_over(self) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5).controlled()
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 5.0) is not None
        assert rig.control.ownership.takeover_denial_reason(conversation(DRIVER), START) is None
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 5.1) is None
        rig.control.ownership.takeover_allowed = True
        assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START) is None

    def test_a_fixed_one_is_the_only_one(self) -> None:
        rig = Rig(MAV_GCS_SYSID=DRIVER)
        for allowed in (False, True):
            rig.control.ownership.takeover_allowed = allowed
            assert rig.control.ownership.takeover_denial_reason(conversation(OTHER), START + 60.0) is not None
            assert rig.control.ownership.denial_reason(conversation(OTHER), START) is not None
            assert rig.control.ownership.takeover_denial_reason(conversation(DRIVER), START) is None
            assert rig.control.ownership.denial_reason(conversation(DRIVER), START) is None

    def test_it_is_lost_after_its_time(self) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5)
        rig.control.take(conversation(DRIVER), 128.0)
        assert not rig.control.ownership.is_lost(133.0)
        assert rig.control.ownership.is_lost(133.1)

    @pytest.mark.parametrize(
        ("system", "introduced", "life"), [(DRIVER, True, True), (OTHER, True, False), (DRIVER, False, False)]
    )
    def test_what_is_a_sign_of_life(self, system: int, introduced: bool, life: bool) -> None:
        rig = Rig().controlled()
        received = rig.received(build_manual_control(NEUTRAL, 1), system, introduced=introduced)
        rig.control.hear(received, START + 3.0)
        assert rig.control.ownership.silence_duration(START + 3.0) == (0.0 if life else 3.0)
