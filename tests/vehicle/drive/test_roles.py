"""What the role of a key allows, and how a denial reads."""

from __future__ import annotations

from typing import NamedTuple

import pytest

from dialects.axes import build_manual_control
from dialects.enums import OperatorFlag
from dialects.messages import INVALID_AXIS, Message, RoverOperatorPresence
from link.core import Received
from link.signing.role import SigningRole
from tests.vehicle.bench import DRIVER, NEUTRAL, OTHER
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import BOOT, Rig
from vehicle.drive.driver import SUCCESSION_TIME
from vehicle.drive.ownership import Ownership
from vehicle.drive.roles import UNSIGNED, role_denial
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue


class Holder(NamedTuple):
    role: SigningRole
    signed: bool


@pytest.mark.parametrize(
    ("role", "signed", "denial"),
    [
        (SigningRole.SET_UP, True, None),
        (SigningRole.DRIVE, True, "its key may drive but not set up"),
        (SigningRole.WATCH, True, "its key may only watch"),
        (SigningRole.WATCH, False, UNSIGNED),
    ],
)
def test_a_role_that_does_not_suffice_says_why(role: SigningRole, signed: bool, denial: str | None) -> None:
    assert role_denial(Holder(role, signed), SigningRole.SET_UP) == denial
    assert role_denial(Holder(role, signed), role) is None


def test_a_conversation_has_no_role_of_its_own() -> None:
    assert conversation(255).role is SigningRole.SET_UP
    assert not conversation(255).signed


def test_a_key_that_may_only_watch_is_not_in_control() -> None:
    class Watcher(NamedTuple):
        system: int = 255
        component: int = 190
        peer: object = None
        numbering: int = 0
        role: SigningRole = SigningRole.WATCH
        signed: bool = True

    ownership = Ownership(Params(), StatusTextQueue(), 0.0)
    assert ownership.denial_reason(Watcher(), 1.0) == "its key may only watch"  # type: ignore[arg-type]


# ---- a key that may watch, drive, and set up, beside or in place of the driver ----

ROLES = [(SigningRole.WATCH, False), (SigningRole.DRIVE, True), (SigningRole.SET_UP, True)]
"""SigningRole -> whether it may drive."""


class Silent(Rig):
    """A driver without sessions that streamed demands, and a moment at which it may be succeeded."""

    def __init__(self) -> None:
        super().__init__()
        self.control.take(conversation(DRIVER), self.now)
        assert self.stick(NEUTRAL)
        self.now += SUCCESSION_TIME + 0.1

    def says(self, message: Message, role: SigningRole) -> Received:
        """The next message of the driver's ids, of another program."""
        return self.received(message)._replace(role=role, numbering=1)


@pytest.mark.parametrize(("role", "may"), ROLES)
def test_only_who_may_drive_succeeds_a_silent_driver(role: SigningRole, may: bool) -> None:
    rig = Silent()
    for _ in range(3):
        rig.control.hear(rig.says(build_manual_control(NEUTRAL, 1), role), rig.now)
    assert rig.control.pop_succession() is may


@pytest.mark.parametrize(("role", "may"), ROLES)
def test_only_who_may_drive_proves_a_session(role: SigningRole, may: bool) -> None:
    rig = Silent()
    echo, flags = round((rig.now - BOOT - 0.1) * 1000), int(OperatorFlag.AXES)
    message = RoverOperatorPresence(1, 1, 5, echo, 7, 1, 0, flags, 0, INVALID_AXIS, INVALID_AXIS, 0)
    rig.control.handle_operator_presence(rig.says(message, role), message, rig.now)
    assert (rig.control.ownership.session is not None) is may


@pytest.mark.parametrize(("role", "may"), ROLES)
def test_only_who_may_drive_counts_as_the_driver(role: SigningRole, may: bool) -> None:
    rig = Silent()
    sender = rig.received(build_manual_control(NEUTRAL, 1))._replace(role=role)
    ownership = rig.control.ownership
    assert ownership.is_driver(sender, rig.now) is may
    assert (ownership.denial_reason(sender, rig.now) is None) is may


@pytest.mark.parametrize(("role", "may"), ROLES)
def test_only_who_may_drive_takes_control_from_a_lost_driver(role: SigningRole, may: bool) -> None:
    rig = Silent()
    rig.now += rig.params["FS_GCS_TIMEOUT"]
    sender = rig.received(build_manual_control(NEUTRAL, 1), OTHER)._replace(role=role)
    assert rig.control.ownership.is_lost(rig.now)
    assert (rig.control.ownership.takeover_denial_reason(sender, rig.now) is None) is may
