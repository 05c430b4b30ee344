"""The key caps."""

from __future__ import annotations

from groundstation.ui.widgets.keycaps import lit_actions
from tests.groundstation.ui.ptys import STANDARD


def test_an_arrow_lights_the_cap_of_its_direction() -> None:
    assert lit_actions(frozenset({"up"}), STANDARD) == lit_actions(frozenset({"i"}), STANDARD) == {"drive.forward"}
    assert lit_actions(frozenset({"r", "question_mark"}), STANDARD) == frozenset()
