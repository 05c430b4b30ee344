"""The status bar."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.snapshot import EmergencyProgress
from groundstation.ui.display_state import DisplayState, ScreenInfo
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from tests.groundstation.ui.examples import helm, snapshot, vehicle
from tests.groundstation.ui.frames import texts
from tests.groundstation.ui.ptys import STANDARD


@pytest.mark.parametrize("width", [80, 100, 119])
def test_on_two_lines_nothing_important_is_left_out(width: int) -> None:
    value = StatusBarValue(snapshot(operator=helm()), STANDARD, 0.004)
    lines = " ".join(texts(StatusBar(value).draw(width, 2)))
    for words in ("ARMED", "you drive", "link", "loss", "rtt", "cmd", "key→motor", "tty", "batt", "gps", "^g"):
        assert words in lines


def first_line(**changes: Any) -> str:
    return StatusBar(StatusBarValue(snapshot(vehicle=vehicle(**changes)), STANDARD)).draw(80, 2)[0].text


def test_a_disarmed_vehicle_in_emergency_stop_is_not_shown_as_armed() -> None:
    line = first_line(emergency_stop=True, armed=False)
    assert "EMERGENCY STOP" in line
    assert "ARMED" not in line


@pytest.mark.parametrize("progress", [None, *EmergencyProgress])
def test_a_vehicle_that_reports_armed_is_shown_as_armed_in_emergency_stop(progress: EmergencyProgress | None) -> None:
    line = first_line(emergency_stop=True, armed=True, emergency_progress=progress)
    assert " ARMED " in line
    assert "E-STOP SENT" in line
    assert "EMERGENCY STOP" not in line


def test_an_unanswered_emergency_stop_of_a_disarmed_vehicle_is_only_sent() -> None:
    line = first_line(emergency_stop=True, armed=False, emergency_progress=EmergencyProgress.UNANSWERED)
    assert "DISARMED" in line
    assert "E-STOP SENT" in line


def test_other_armed_vehicles_are_named() -> None:
    changes = {"name": "ArduPilot rover 1", "emergency_stop": True}
    picture = snapshot(vehicle=vehicle(**changes), also_armed=(2, 7))
    line = StatusBar(StatusBarValue(picture, STANDARD)).draw(80, 2)[0].text
    assert "also armed: 2, 7" in line


def away(**changes: Any) -> str:
    state = DisplayState(snapshot(vehicle=vehicle(**changes)), STANDARD, screen=ScreenInfo("log"))
    return StatusBar(StatusBarValue.from_state(state)).draw(80, 1)[0].text


def test_away_from_the_drive_screen_the_vehicle_is_neutral_and_the_way_back_is_named() -> None:
    assert "neutral · F1 drives" in away()
    assert "neutral" not in away(mode="AUTO")
    assert "neutral" not in away(armed=False)
    assert "neutral" not in away(in_control=False, driver=250)
    assert "link lost for 4 s" in away(alive=False, silence=4.0)


def test_a_vehicle_that_obeys_another_station_is_not_driven_by_us() -> None:
    line = first_line(obeys="obeys ground station 250 only")
    assert "you drive" not in line
    assert "obeys another GCS" in line
