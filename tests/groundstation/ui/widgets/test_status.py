"""The status bar."""

from __future__ import annotations

import pytest

from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from tests.groundstation.ui.examples import helm, snapshot, vehicle
from tests.groundstation.ui.frames import texts


@pytest.mark.parametrize("width", [80, 100, 119])
def test_on_two_lines_nothing_important_is_left_out(width: int) -> None:
    value = StatusBarValue(snapshot(operator=helm()), 0.004)
    lines = " ".join(texts(StatusBar(value).draw(width, 2)))
    for words in ("ARMED", "you drive", "link", "loss", "rtt", "cmd", "key→motor", "tty", "batt", "gps"):
        assert words in lines


def test_a_vehicle_in_emergency_stop_is_not_shown_as_armed() -> None:
    line = StatusBar(StatusBarValue(snapshot(vehicle=vehicle(emergency_stop=True, armed=True)))).draw(80, 2)[0].text
    assert "EMERGENCY STOP" in line
    assert "ARMED" not in line
