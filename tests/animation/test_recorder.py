"""The recording of the real program: it is started, armed and driven, and stands at the end."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.animation.moments import choose_moments
from tests.animation.recorder import record

pytest.importorskip("pyte", reason="needs the extra pictures")

from tests.animation.display import Display


def wheels(screen: str) -> list[int]:
    """Return the power of the left and right wheel that the Drive screen shows, %."""
    return [int(each) for each in re.findall(r"(?:left|right) wheel .* ([+-]\d+)%", screen)]


@pytest.mark.e2e
@pytest.mark.slow
def test_the_recording_shows_driving_and_then_stopping(tmp_path: Path) -> None:
    cast = record(tmp_path)
    display, shown = Display(cast.width, cast.height), []
    for moment in choose_moments(cast.outputs, step=0.1, longest=1.0, last=1.0):
        display.write(moment.text)
        shown.append("\n".join("".join(text for text, _ in row) for row in display.picture()))
    assert any("$ mavhelm --sitl" in each for each in shown), shown[:3]
    assert any("ARMED" in each and min(wheels(each), default=0) > 20 for each in shown), shown[-1]
    assert wheels(shown[-1]) == [0, 0], shown[-1]
