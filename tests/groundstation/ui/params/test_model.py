"""The model of the Parameters screen: the selection, the window, changes and their undo."""

from __future__ import annotations

from groundstation.intents.services import FetchParams, WriteParams
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.params.edit.pending import MAX_UNDO
from groundstation.ui.params.model import ParamModel
from groundstation.ui.params.scope import CHANGED
from groundstation.views.params import ParamInfo, ParamInfos, ParamPage, ParamPageRequest, ParamRow
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.examples import param_page


def rows(first: int, count: int) -> tuple[ParamRow, ...]:
    return tuple(
        ParamRow(name=f"P{number:03}", value=float(number), kind="REAL32", default=None, changed=False)
        for number in range(first, first + count)
    )


def page(first: int, count: int, matching: int = 100, ended: tuple[RequestLine, ...] = ()) -> ParamPage:
    return ParamPage(1, rows(first, count), first, matching, 100, 100, has_defaults=False, running=(), ended=ended)


def shown(height: int = 10) -> ParamModel:
    model = ParamModel(RequestNumbers())
    model.set_height(height)
    model.show_page(page(0, height))
    return model


def change(model: ParamModel, text: str) -> str | None:
    """Type a value for the selected parameter."""
    editor = model.open_editor()
    assert editor is not None
    editor.type(text)
    return model.close_editor(keep=True)


def test_the_window_follows_the_selection() -> None:
    model = shown()
    model.move(9)
    assert model.request == ParamPageRequest(rows=10)
    model.move(1)
    assert model.request == ParamPageRequest(first=1, rows=10)
    assert model.selected is None, "its row has not arrived"
    model.show_page(page(1, 10))
    assert model.selected is not None
    assert model.selected.name == "P010"
    model.move(1000)
    assert model.request.first == 90
    model.move(-1000)
    assert model.request.first == 0


def test_fewer_that_match_move_the_selection_up() -> None:
    model = shown()
    model.move(9)
    model.show_page(page(0, 3, matching=3))
    assert model.selected is not None
    assert model.selected.name == "P002"


def test_a_filter_begins_at_the_top() -> None:
    model = shown()
    model.move(50)
    model.set_filter("FS")
    model.set_scope(CHANGED)
    assert model.request == ParamPageRequest("FS", True, 0, 10)


def test_a_value_as_it_was_is_no_change() -> None:
    model = shown()
    assert change(model, "0x05") is None
    assert [change.value for change in model.pending.values()] == [5.0]
    assert change(model, "0") is None
    assert model.pending == {}


def test_undo_goes_back_step_by_step_and_is_bounded() -> None:
    model = shown()
    for value in range(1, MAX_UNDO + 50):
        change(model, str(value))
    steps = 0
    while model.changes.undo():
        steps += 1
    assert steps == MAX_UNDO


def test_one_write_at_a_time() -> None:
    model = shown()
    assert not model.may_write, "nothing to write"
    assert model.write() == ()
    change(model, "5")
    assert model.write() == (WriteParams(1, 1, (("P000", 5.0),)),)
    assert not model.may_write, "it is being written"
    assert model.write() == ()


def test_numbers_of_requests_rise() -> None:
    model = shown()
    assert [model.fetch(), model.fetch()] == [FetchParams(1), FetchParams(2)]


def test_a_few_values_that_came_unasked_are_not_the_list() -> None:
    model = ParamModel(RequestNumbers())
    some = ParamPage(1, rows(0, 3), 0, 3, 3, 1234, has_defaults=False, running=(), ended=())
    assert model.show_page(some) == (FetchParams(1),)
    assert model.show_page(some) == (), "once"
    assert ParamModel(RequestNumbers()).show_page(page(0, 10)) == ()


def test_old_ends_of_other_requests_do_not_end_a_write() -> None:
    model = shown()
    change(model, "5")
    model.write()
    model.show_page(page(0, 10, ended=(RequestLine(7, "accepted", "set 1 parameter"),)))
    assert list(model.pending) == ["P000"]
    model.show_page(page(0, 10, ended=(RequestLine(1, "no answer", "set 1 parameter", "after 8 tries", 0, 1),)))
    assert list(model.pending) == ["P000"], "it was not set"
    assert model.status == "no answer: after 8 tries"
    assert model.may_write, "and can be written again"


def test_a_kept_value_is_not_written_and_stays_pending() -> None:
    model = shown()
    change(model, "5")
    model.move(1)
    change(model, "6")
    model.write()
    line = RequestLine(1, "refused", "set 2 parameters", "kept by the vehicle: P000", 2, 2, kept=("P000",))
    model.show_page(page(0, 10, ended=(line,)))
    assert list(model.pending) == ["P000"]
    assert model.last_write == "refused: kept by the vehicle: P000 · set: P001"
    assert model.changes.undo()
    assert model.pending["P001"].value == 1, "what was set can be undone"


def test_a_read_only_value_is_not_changed() -> None:
    model = shown()
    model.show_infos(ParamInfos(1, (ParamInfo("P000", value=0.0, kind="REAL32", read_only=True),)))
    assert change(model, "5") == "P000 is read-only"
    assert model.pending == {}


def test_the_examples_have_changes() -> None:
    model = ParamModel(RequestNumbers())
    model.set_height(10)
    model.show_page(param_page())
    assert model.change_to_default() is None
    assert [change.value for change in model.pending.values()] == [1.0]
