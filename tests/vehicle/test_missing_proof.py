"""A driver whose newest proof is older than a second, as on a late machine: it repeats, and counts once it proves."""

from __future__ import annotations

from typing import TypeVar

import pytest

from dialects import messages as m
from dialects.enums import Command, MissionType, Rejection, Result
from dialects.modes import Mode
from link.services.ftp.protocol import FtpOpcode, FtpPacket
from tests.vehicle.wires import SessionProgram, Wires

M = TypeVar("M", bound=m.Message)


class Late(SessionProgram):
    """A ground station in control, disarmed, that stands still for a while."""

    def __init__(self) -> None:
        super().__init__(Wires())
        self.prove()
        assert self.command(Command.REQUEST_OPERATOR_CONTROL, 1) is Result.ACCEPTED
        self.wires.wait(1.5)

    def prove(self) -> None:
        self.beat()
        self.send(self.build(None))

    def answers(self, kind: type[M], message: m.Message) -> list[M]:
        """Send a message; return the answers of this kind that follow it at once and within 0.1 s."""
        before = len(self.wires.sent)
        self.send(message)
        self.wires.wait(0.1)
        return [each for _, each in self.wires.sent[before:] if isinstance(each, kind)]


PARAM = m.ParamSet(1, 1, b"MAN_TIMEOUT", 0.4, 9)
CREATE = FtpPacket(1, FtpOpcode.CREATE, data=b"/missions/mission.waypoints").message(1, 1)
CHANGES = [
    (m.MissionCount(1, 1, 1, MissionType.MISSION, 0), m.MissionRequestInt),
    (m.MissionClearAll(1, 1, MissionType.RALLY), m.MissionAck),
    (PARAM, m.ParamValue),
    (CREATE, m.FileTransferProtocol),
]


@pytest.mark.parametrize(("change", "answer"), CHANGES, ids=lambda each: getattr(each, "msgname", None))
def test_a_change_is_answered_once_the_sender_proves(change: m.Message, answer: type[m.Message]) -> None:
    late = Late()
    assert not late.answers(answer, change)
    late.prove()
    assert late.answers(answer, change)


def test_the_sender_of_an_unanswered_change_is_told_why() -> None:
    late = Late()
    late.answers(m.ParamValue, PARAM)
    assert late.text("GCS 255: PARAM_SET not answered: no proof on this link for 1.5 s")


def test_a_command_is_rejected_for_the_moment() -> None:
    late = Late()
    mode = m.CommandLong(1, 1, Command.DO_SET_MODE, 0, 1, Mode.GUIDED, 0, 0, 0, 0, 0)
    [answer] = late.answers(m.CommandAck, mode)
    assert (answer.result, answer.result_param2) == (Result.TEMPORARILY_REJECTED, Rejection.NO_PROOF)
    assert late.text("DO_SET_MODE refused: no proof on this link for 1.5 s")
    late.prove()
    assert late.set_mode(Mode.MANUAL) is Result.ACCEPTED


def test_arming_is_rejected_for_the_moment() -> None:
    late = Late()
    assert late.arm() is Result.TEMPORARILY_REJECTED
    assert not late.wires.armed
    late.prove()
    assert late.arm() is Result.ACCEPTED


def test_a_stop_needs_no_proof() -> None:
    late = Late()
    assert late.set_mode(Mode.HOLD) is Result.ACCEPTED
    assert late.disarm() is Result.ACCEPTED


def test_another_ground_station_is_refused_for_good() -> None:
    other = SessionProgram(Late().wires, "other", ids=(254, 190))
    other.beat()
    assert other.set_mode(Mode.GUIDED) is Result.FAILED
