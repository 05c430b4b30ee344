"""Tab bar: the screens, and the marks behind their names."""

from __future__ import annotations

import itertools

import pytest

from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.display.tab_marks import TabMark
from groundstation.ui.look.colours import BLUE, RED
from groundstation.ui.params.model import ParamModel
from groundstation.ui.widgets.tabs import TabBar, TabBarValue
from tests.groundstation.ui.examples import param_page, snapshot
from tests.groundstation.ui.ptys import STANDARD
from tests.rows import each_row


def bar(model: ParamModel, width: int) -> str:
    state = DisplayState(snapshot(), STANDARD, kept={ParamModel: model})
    value = TabBarValue.from_state(state)
    return TabBar(value).draw(width, 1)[0].text


@pytest.mark.parametrize(("width", "mark"), [(140, "Params✎1 "), (80, "Par✎ ")])
def test_a_pencil_stands_there_while_changes_are_not_sent(width: int, mark: str) -> None:
    model = ParamModel(RequestNumbers())
    model.set_height(10)
    model.show_page(param_page())
    assert "✎" not in bar(model, width)
    assert model.change_to_default() is None
    assert mark in bar(model, width)
    assert len(bar(model, width)) == width
    model.changes.undo()
    assert "✎" not in bar(model, width)


@each_row(("row", "width"), itertools.product([row for row in SCREENS if row.in_tabs], [40, 60, 80, 100, 120, 140]))
def test_the_tab_of_the_screen_on_top_is_always_there(row: ScreenRow, width: int) -> None:
    marks = {"setup": TabMark(" 12✗", RED), "files": TabMark(" 41%", BLUE), "params": TabMark("✎3", BLUE)}
    text = TabBar(TabBarValue(STANDARD, row.id, marks)).draw(width, 1)[0].text
    assert len(text) == width
    assert row.title in text or (row.short and row.short in text)
    assert "^g" in text


def test_all_tabs_fit_in_80_columns_without_marks() -> None:
    text = TabBar(TabBarValue(STANDARD)).draw(80, 1)[0].text
    assert all((row.short or row.title) in text for row in SCREENS if row.in_tabs)
