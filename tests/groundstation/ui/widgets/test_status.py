"""The status bar."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.snapshot import EmergencyProgress, LinkView, RecordingView
from groundstation.snapshot.signing import SigningState, SigningView
from groundstation.ui.display.display_state import DisplayState, ScreenInfo
from groundstation.ui.look.ascii import to_ascii
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


@pytest.mark.parametrize("state", list(SigningState))
def test_the_state_of_signing_is_always_in_the_header(state: SigningState) -> None:
    picture = snapshot(operator=helm(), signing=SigningView(state))
    for width, height in ((80, 2), (140, 1)):
        lines = " ".join(texts(StatusBar(StatusBarValue(picture, STANDARD, 0.004)).draw(width, height)))
        assert (" unsigned " if state is SigningState.OFF else f" sign {state.value} ") in lines
        assert "batt" in lines


def test_the_header_counts_refused_frames_of_a_signing_vehicle() -> None:
    picture = snapshot(signing=SigningView(SigningState.ON, "on", "3 wrong key"))
    lines = " ".join(texts(StatusBar(StatusBarValue(picture, STANDARD)).draw(80, 2)))
    assert "sign on, refused 3 wrong key" in lines


def first_line(width: int = 80, **changes: Any) -> str:
    return StatusBar(StatusBarValue(snapshot(vehicle=vehicle(**changes)), STANDARD)).draw(width, 2)[0].text


def test_a_disarmed_vehicle_in_emergency_stop_is_not_shown_armed() -> None:
    line = first_line(emergency_stop=True, armed=False)
    assert "EMERGENCY STOP" in line
    assert "ARMED" not in line


@pytest.mark.parametrize("progress", [None, *EmergencyProgress])
def test_a_vehicle_reporting_armed_in_estop_is_shown_armed(progress: EmergencyProgress | None) -> None:
    line = first_line(emergency_stop=True, armed=True, emergency_progress=progress)
    assert " ARMED " in line
    assert "E-STOP SENT" in line
    assert "EMERGENCY STOP" not in line


def test_an_unanswered_estop_of_a_disarmed_vehicle_is_only_sent() -> None:
    line = first_line(emergency_stop=True, armed=False, emergency_progress=EmergencyProgress.UNANSWERED)
    assert "DISARMED" in line
    assert "E-STOP SENT" in line


def test_the_pre_arm_state_is_shown_while_disarmed() -> None:
    assert "pre-arm failed" in first_line(armed=False, prearm=False, name="ArduPilot rover 1")
    assert "pre-arm ok" in first_line(100, armed=False, prearm=True)
    for changes in ({"armed": True, "prearm": False}, {"armed": False, "prearm": None}):
        assert "pre-arm" not in first_line(100, **changes)


def test_other_armed_vehicles_are_named() -> None:
    changes = {"name": "ArduPilot rover 1", "emergency_stop": True}
    picture = snapshot(vehicle=vehicle(**changes), also_armed=(2, 7))
    line = StatusBar(StatusBarValue(picture, STANDARD)).draw(80, 2)[0].text
    assert "also armed: 2, 7" in line


def away(**changes: Any) -> str:
    state = DisplayState(snapshot(vehicle=vehicle(**changes)), STANDARD, screen=ScreenInfo("log"))
    return StatusBar(StatusBarValue.from_state(state)).draw(80, 1)[0].text


def test_away_from_drive_vehicle_is_neutral_and_the_way_named() -> None:
    assert "neutral · F1 drives" in away()
    assert "neutral" not in away(mode="AUTO")
    assert "neutral" not in away(armed=False)
    assert "neutral" not in away(in_control=False, driver=250)
    assert "link lost for 4 s" in away(alive=False, silence=4.0)


def test_vehicle_that_obeys_another_station_is_not_driven_by_us() -> None:
    line = first_line(obeys="obeys ground station 250 only")
    assert "you drive" not in line
    assert "obeys another GCS" in line


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "you drive"),
        ({"mode": "HOLD", "drivable": False}, "you are in control"),
        ({"mode": "AUTO", "drivable": False, "drives_itself": True}, "AUTO drives"),
        ({"undriven": "keys do not drive a copter", "in_control": False}, "only shown"),
        ({"armed": False}, "you are in control"),
        ({"emergency_stop": True}, ""),
        ({"in_control": False, "driver": 254}, "driven by 254"),
        ({"in_control": False, "driver": 0}, "no GCS in control"),
        ({"in_control": False, "driver": None}, ""),
        ({"alive": False, "silence": 4.0}, "link lost for 4 s"),
    ],
)
def test_you_drive_is_shown_only_while_the_keys_drive(changes: dict[str, Any], words: str) -> None:
    line = first_line(**changes)
    assert words in line
    assert ("you drive" in line) is (words == "you drive")
    assert ("in control" in line) is ("in control" in words)


def test_a_lost_station_drives_nothing() -> None:
    line = StatusBar(StatusBarValue(snapshot(), STANDARD, station_runs=False)).draw(80, 2)[0].text
    assert "station lost" in line
    assert "you drive" not in line


RECORDING = RecordingView(path="/logs/2026-11-22_14-05-09.tlog", seconds=31.0, size=420_000)


@pytest.mark.parametrize(("width", "height"), [(80, 2), (80, 1), (119, 1), (140, 1)])
def test_a_dot_ends_the_first_line_while_the_session_is_recorded(width: int, height: int) -> None:
    value = StatusBarValue(snapshot(operator=helm(), recording=RECORDING), STANDARD, 0.004)
    line = StatusBar(value).draw(width, height)[0].text.rstrip()
    assert line.endswith((" ●", " ● rec"))
    assert "batt" in line
    assert to_ascii(line).endswith((" #", " # rec"))


def test_the_word_behind_the_dot_is_whole_or_not_there() -> None:
    seen = set()
    for width in range(60, 120):
        line = StatusBar(StatusBarValue(snapshot(recording=RECORDING), STANDARD)).draw(width, 2)[0].text.rstrip()
        seen.add(line.rpartition("●")[2])
    assert seen == {"", " rec"}


@pytest.mark.parametrize("recording", [None, RecordingView(), RecordingView(path="/x", problem="not recording: full")])
def test_no_dot_without_a_file_that_is_being_written(recording: RecordingView | None) -> None:
    line = StatusBar(StatusBarValue(snapshot(recording=recording), STANDARD)).draw(140, 1)[0].text
    assert "●" not in line


def test_of_two_links_the_one_that_counts_stays_longest() -> None:
    links = tuple(LinkView(name=f"udpin:{n}", loss=0.0, round_trip=0.01, age=0.1, counts=n == 1) for n in range(2))
    picture = snapshot(links=links, signing=SigningView(SigningState.OFF))
    both = texts(StatusBar(StatusBarValue(picture, STANDARD)).draw(80, 2))[1]
    assert both.index("1 ▂") < both.index("★2 ▂") < both.index("unsigned"), both
    one = texts(StatusBar(StatusBarValue(picture, STANDARD)).draw(80, 1))[0]
    assert "★2 ▂" in one
    assert "1 ▂" not in one
