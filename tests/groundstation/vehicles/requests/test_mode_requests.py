"""A change of mode that was accepted, on a link or a machine that lets no heartbeat through for a while."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from link.core import Outgoing
from tests.link.command_rig import received

ROVER, HOLD, MANUAL = 10, 4, 0


def accepted() -> VehicleServices:
    """Return the services of a vehicle that has accepted HOLD at 0.1 s and sent no heartbeat since."""
    services = VehicleServices([], 255, 190, (1, 1))
    services.autopilot, services.kind = Autopilot.ARDUPILOT, ROVER
    services.modes.set(1, "HOLD", 0.0)
    ack = m.CommandAck(Command.DO_SET_MODE, Result.ACCEPTED, target_system=255, target_component=190)
    services.receive(received(ack, 1, 1), 0.1)
    return services


def tick(services: VehicleServices, now: float) -> RequestReport:
    """Return the newest report, 1.1 s later at most: a refusal waits for its reason."""
    services.tick(now)
    services.tick(now + 1.1)
    return services.book.pop_changes()[-1]


@pytest.mark.parametrize(
    ("mode", "state"), [(HOLD, RequestState.ACCEPTED), (MANUAL, RequestState.REFUSED)], ids=["obeys", "does not"]
)
def test_the_first_heartbeat_decides_however_late(mode: int, state: RequestState) -> None:
    services = accepted()
    assert tick(services, 3.2).state is RequestState.RUNNING
    services.receive(received(m.Heartbeat(ROVER, Autopilot.ARDUPILOT, 1, mode, 4, 3), 1, 1), 6.0)
    assert tick(services, 6.0).state is state


def test_without_any_heartbeat_there_is_no_answer() -> None:
    report = tick(accepted(), 8.2)
    assert (report.state, report.detail) == (RequestState.NO_ANSWER, "accepted, but no heartbeat came for 8 s")


def test_a_change_that_our_role_does_not_allow_is_refused() -> None:
    outbox: list[Outgoing] = []
    services = VehicleServices(outbox, 255, 190, (1, 1))
    services.autopilot, services.kind = Autopilot.ARDUPILOT, ROVER
    services.modes.set(1, "HOLD", 0.0)
    [sent] = [each.message for each in outbox if isinstance(each.message, m.CommandLong)]
    services.handle_refused(sent, "the key may only watch", 0.1)
    services.receive(received(m.Heartbeat(ROVER, Autopilot.ARDUPILOT, 1, MANUAL, 4, 3), 1, 1), 0.2)
    report = tick(services, 0.2)
    assert (report.state, report.text) == (RequestState.REFUSED, "mode HOLD: refused, the key may only watch")
