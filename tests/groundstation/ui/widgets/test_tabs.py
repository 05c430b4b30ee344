"""Tab bar: the screens, and the marks behind their names."""

from __future__ import annotations

import pytest

from groundstation.ui.display_state import DisplayState
from groundstation.ui.params.model import ParamModel
from groundstation.ui.request_numbers import RequestNumbers
from groundstation.ui.widgets.tabs import TabBar, TabBarValue
from tests.groundstation.ui.examples import param_page, snapshot
from tests.groundstation.ui.ptys import STANDARD


def bar(model: ParamModel, width: int) -> str:
    state = DisplayState(snapshot(), STANDARD, kept={ParamModel: model})
    value = TabBarValue.from_state(state)
    return TabBar(value).draw(width, 1)[0].text


@pytest.mark.parametrize(("width", "mark"), [(140, "Params✎1 "), (80, "Params✎ ")])
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
