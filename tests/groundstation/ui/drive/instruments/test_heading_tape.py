"""The heading tape."""

from __future__ import annotations

import pytest

from groundstation.ui.drive.instruments.heading_tape import heading_marks


@pytest.mark.parametrize(("heading", "middle"), [(0, "N"), (90, "E"), (359, "N"), (225, "SW"), (120, "120")])
def test_the_tape_has_the_heading_in_its_middle(heading: int, middle: str) -> None:
    marks = heading_marks(heading, 41)
    assert len(marks) == 41
    assert middle in marks[17:24]
