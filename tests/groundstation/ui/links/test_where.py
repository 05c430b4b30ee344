"""The small map of the Links screen, and the bytes by message beside the control."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import pytest

from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.files.screen import FilesScreen
from groundstation.ui.links.screen import LinksScreen
from groundstation.ui.links.where import build_where
from groundstation.ui.messages.byte_counts import MessageBytes
from groundstation.views.links import VehiclesView
from tests.groundstation.ui.example_files import FILES, TASKS
from tests.groundstation.ui.frames import texts
from tests.groundstation.ui.link_examples import BYTES, FLEET, SIX, VIEWS, vehicle_row
from tests.groundstation.ui.pilots import console


def test_vehicles_are_placed_by_chosen_one_and_it_by_its_home() -> None:
    view = VehiclesView(
        (
            vehicle_row(distance=10.0, bearing=90.0),
            vehicle_row(2, distance=5.0, bearing=180.0),
            vehicle_row(3, distance=None),
        )
    )
    value = build_where(view, 1, math.pi)
    assert value.vehicle == (0.0, 0.0)
    assert value.home == pytest.approx((0.0, -10.0))
    (mark,) = value.marks
    assert mark.text == "2"
    assert mark.point == pytest.approx((-5.0, 0.0))


def test_without_position_of_the_chosen_vehicle_there_is_no_map() -> None:
    lost = msgspec.structs.replace(SIX.rows[0], has_position=False)
    for view, selected in ((None, 1), (SIX, None), (VehiclesView((lost,)), 1)):
        assert build_where(view, selected, None).note == "no position of the chosen vehicle"


def test_the_same_message_of_several_vehicles_is_one_line() -> None:
    again = [msgspec.structs.replace(row, system=2) for row in BYTES.rows if not row.sent]
    lines = texts(MessageBytes(msgspec.structs.replace(BYTES, rows=(*BYTES.rows, *again))).draw(60, 9))
    assert len(lines) == 5
    assert lines[0].startswith(" SERVO_OUTPUT_RAW")
    assert "1320 B/s" in lines[0]


def test_bars_compare_the_bytes_of_messages_without_silent_ones() -> None:
    lines = texts(MessageBytes(BYTES).draw(60, 9))
    bars = [line.count("━") for line in lines]
    assert lines[0].startswith(" MANUAL_CONTROL >")
    assert bars[0] == pytest.approx(800 / 660 * bars[1], abs=1)
    assert bars == sorted(bars, reverse=True)
    assert len(lines) == 5
    assert "nothing yet" in texts(MessageBytes(None).draw(60, 9))[0]
    assert len(texts(MessageBytes(BYTES).draw(60, 2))) == 2


async def test_a_view_may_come_before_the_panels_are_laid_out(tmp_path: Path) -> None:
    async with console((140, 45), FLEET, folder=tmp_path) as screen:
        for kind, views in ((LinksScreen, VIEWS), (FilesScreen, (FILES, TASKS))):
            early: ConsoleScreen = kind(screen.app.drive.context)
            for view in views:
                early.show_view(view)
