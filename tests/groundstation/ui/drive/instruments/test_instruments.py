"""The table of instruments."""

from __future__ import annotations

import pytest

from groundstation.snapshot import Snapshot
from groundstation.ui.base.chrome import InstrumentRow
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.instrument_table import INSTRUMENTS
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.ptys import STANDARD


def state_of(picture: Snapshot) -> DisplayState:
    """Return a display state of the standard key map."""
    return DisplayState(picture, STANDARD)


ROWS = pytest.mark.parametrize("row", INSTRUMENTS, ids=lambda row: row.id)


def test_ids_are_unique() -> None:
    assert len({row.id for row in INSTRUMENTS}) == len(INSTRUMENTS)


@ROWS
@pytest.mark.parametrize("picture", [Snapshot(), snapshot()], ids=["no vehicle", "driving"])
def test_each_row_draws_its_value(row: InstrumentRow, picture: Snapshot) -> None:
    state = state_of(picture)
    widget = row.build(row.value(state), id=row.id)
    assert all(line.cell_length <= 80 for line in widget.draw(80, 6))


async def test_each_row_has_its_place_on_the_drive_screen() -> None:
    async with console() as screen:
        for row in INSTRUMENTS:
            assert screen.app.drive.query_one(f"#{row.id}").is_attached, row.id
