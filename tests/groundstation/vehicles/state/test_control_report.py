"""Who is in control, as the vehicle reports it."""

from __future__ import annotations

import pytest

from dialects.enums import ControlFlag
from dialects.messages import ControlStatus, RoverControl
from groundstation.vehicles.state.control_report import ControlReport

OURS, SESSION = (255, 190), 7


def report(driver: int | None, component: int | None = None, session: int | None = None) -> ControlReport:
    return ControlReport(driver, component, session)


@pytest.mark.parametrize(
    ("control", "accepted", "ours"),
    [
        (report(None), True, True),
        (report(None), False, False),
        (report(0), True, False),
        (report(254), True, False),
        (report(255), False, True),  # the program is not told: an older vehicle, or not yet
        (report(255, 190, 7), False, True),
        (report(255, 190, 8), True, False),
        (report(255, 230, 7), True, False),
        (report(255, 190, 0), True, True),
        (report(255, 190, 0), False, False),
        (report(254, 190, 0), True, False),
    ],
)
def test_which_program_is_in_control(control: ControlReport, accepted: bool, ours: bool) -> None:
    assert control.is_program(OURS, SESSION, accepted=accepted) is ours


def test_the_newest_report_counts() -> None:
    control = ControlReport()
    control.handle_control_status(ControlStatus(1, 255, [0] * 10))
    assert (control.driver, control.session) == (255, None)
    control.handle_rover_control(RoverControl(7, 255, 190, int(ControlFlag.SILENT | ControlFlag.CLASH)))
    assert control == ControlReport(255, 190, 7, silent=True, clash=True)
    control.handle_control_status(ControlStatus(1, 255, [0] * 10))
    assert control.session == 7
    control.handle_rover_control(RoverControl(7, 255, 190, 0))
    assert control == ControlReport(255, 190, 7)


def test_of_another_driver_the_program_is_not_known_yet() -> None:
    control = ControlReport(255, 190, 7, silent=True, clash=True)
    control.handle_control_status(ControlStatus(1, 254, [0] * 10))
    assert control == ControlReport(254)
