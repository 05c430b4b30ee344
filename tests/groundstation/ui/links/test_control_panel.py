"""Who is in control, line by line."""

from __future__ import annotations

import msgspec
import pytest

from groundstation.snapshot.signing import SigningState, SigningView
from groundstation.ui.links.control_panel import ControlPanel, ControlPanelValue
from groundstation.views.links import Program
from tests.groundstation.ui import frames
from tests.groundstation.ui.link_examples import CONTROL


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "this one, 255/190, session 1a2b3c4d · G releases it"),
        ({"driver": 0, "program": None, "in_control": False}, "no ground station · g requests control"),
        ({"driver": 250, "program": None, "in_control": False}, "ground station 250 · g asks for it"),
        (
            {"driver": 250, "program": Program(250, 190, 7), "in_control": False},
            "ground station 250/190, session 00000007 · g asks for it",
        ),
        ({"driver": None, "program": None, "in_control": False}, "this vehicle does not tell · g requests it"),
        ({"driver": None, "program": None}, "this vehicle does not tell · it accepts our commands"),
        ({"program": Program(255, 190, 7)}, "another program with our id: 255/190, session 00000007"),
        ({"program": Program(255, 191, 7)}, "another program with our id: 255/191"),
        ({"program": None}, "this one, 255 · G releases it"),
        ({"age": 12.0}, "reported 12 s ago"),
        ({"clash": True}, "two programs send with the ids of the driver: its demands do not count"),
        ({"silent": True}, "the driver is silent"),
        ({"takeover": True}, "granted without asking the driver"),
        ({"waits": 7.0}, "the driver may answer for 7 s"),
        ({"signing": SigningView(SigningState.NO_KEY, "the vehicle signs")}, "signing     the vehicle signs"),
        ({"signing": SigningView(SigningState.OFF, "off"), "signing_systems": (7, 9)}, "systems that sign: 7, 9"),
        ({"signing": SigningView(SigningState.ON, "on", "3 replayed")}, "refused     3 replayed with its id"),
        ({"signing": SigningView(SigningState.ON, "on", "", "its clock is 3 h ahead")}, "clock       its clock is 3 h"),
        ({"signing": None}, "no vehicle signs"),
    ],
)
def test_who_is_in_control(changes: dict[str, object], words: str) -> None:
    view = msgspec.structs.replace(CONTROL, **changes)
    panel = ControlPanel(ControlPanelValue(view, "g", "G"))
    lines = frames.texts(panel.draw(136, panel.wanted))
    assert any(words in line for line in lines), lines


def test_the_most_important_line_is_first_and_lines_scroll() -> None:
    view = msgspec.structs.replace(CONTROL, clash=True)
    first, second = frames.texts(ControlPanel(ControlPanelValue(view)).draw(136, 2))
    assert "in control" in first
    assert "two programs" in second
    assert frames.texts(ControlPanel(ControlPanelValue(view, top=1)).draw(136, 1)) == [second]
