"""The key caps."""

from __future__ import annotations

import msgspec

from groundstation.ui.drive.instruments.keycaps import Keycaps, KeycapsValue, lit_actions
from tests.groundstation.ui.ptys import STANDARD


def test_an_arrow_lights_the_cap_of_its_direction() -> None:
    assert lit_actions(frozenset({"up"}), STANDARD) == lit_actions(frozenset({"i"}), STANDARD) == {"drive.forward"}
    assert lit_actions(frozenset({"r", "question_mark"}), STANDARD) == frozenset()


def test_the_cap_of_a_key_that_does_not_count_has_another_colour() -> None:
    first = [
        Keycaps(KeycapsValue(STANDARD, frozenset({"drive.forward"}), open=True, ignored=ignored)).draw(60, 3)[0]
        for ignored in (False, True)
    ]
    assert first[0].text == first[1].text
    assert [segment.style for segment in first[0]] != [segment.style for segment in first[1]]


def test_promised_releases_have_a_timer_until_one_came() -> None:
    """Contour promises them and sends none, so the timer goes on; the text says for how long."""
    promised = KeycapsValue(STANDARD, stop_bound=0.75, promises_releases=True)
    assert "timer 0.75 s till a release" in Keycaps(promised).draw(40, 3)[1].text
    proved = msgspec.structs.replace(promised, reports_releases=True, stop_bound=0.0)
    assert "stops when you let go" in Keycaps(proved).draw(40, 3)[1].text
    assert "timer: stops within 0.75 s" in Keycaps(KeycapsValue(STANDARD, stop_bound=0.75)).draw(40, 3)[1].text


def test_the_vehicles_own_limit_stands_beside_the_keys() -> None:
    own = KeycapsValue(STANDARD, throttle_limit=60)
    assert "limits: speed 60% turn 100%" in Keycaps(own).draw(60, 3)[2].text
    slowed = msgspec.structs.replace(own, slowed=(2.34, "late commands"))
    assert "at most 2.3 m/s: late commands" in Keycaps(slowed).draw(50, 3)[2].text
