"""Window, cursor, order and filter of the Messages screen."""

from __future__ import annotations

import msgspec

from groundstation.ui.messages.model import MARGIN, MessagesModel
from groundstation.views.messages import MessageRequest, MessageRow, MessagesPage

HEIGHT = 10


def page(first: int = 0, count: int = 60, total: int = 200, *, order: str = "source", text: str = "") -> MessagesPage:
    """Return a page of one source and its messages M1, M2 and so on."""
    rows = tuple(
        MessageRow(1, 1, False, f"M{number}" if number else "", 1.0, 20.0, 5, 0.1)
        for number in range(first, min(total, first + count))
    )
    return MessagesPage(rows, first, total, total - 1, 1.0, 20.0, order=order, text=text)


def shown(model: MessagesModel) -> list[str]:
    return [row.name for row in model.window(HEIGHT)]


def test_the_first_page_puts_the_cursor_on_its_first_row() -> None:
    model = MessagesModel()
    assert model.message_request is None
    model.add(page(), HEIGHT)
    assert model.selected == (1, 1, False, "")
    assert model.message_request is None
    assert shown(model) == ["", *(f"M{number}" for number in range(1, 10))]


def test_the_cursor_moves_within_the_window_and_then_moves_it() -> None:
    model = MessagesModel()
    model.add(page(), HEIGHT)
    model.move(9, HEIGHT)
    assert (model.top, model.message_request) == (0, MessageRequest(1, 1, False, "M9"))
    model.move(1, HEIGHT)
    assert shown(model)[-1] == "M10"
    model.move(-(10**6), HEIGHT)
    assert shown(model)[0] == ""


def test_at_the_end_missing_rows_are_requested_and_then_selected() -> None:
    model = MessagesModel()
    model.add(page(), HEIGHT)
    model.move(10**6, HEIGHT)
    assert (model.cursor, model.selected, shown(model)) == (199, None, [])
    request = model.page_request(HEIGHT)
    assert (request.first, request.count) == (190 - MARGIN, HEIGHT + 2 * MARGIN)
    model.add(page(140), HEIGHT)
    assert model.selected == (1, 1, False, "M199")
    assert shown(model)[-1] == "M199"


def test_the_cursor_stays_on_its_row_when_rows_come_before_it() -> None:
    model = MessagesModel()
    model.add(page(), HEIGHT)
    model.move(20, HEIGHT)
    place = model.cursor - model.top
    before = page()
    more = (*before.rows[:5], MessageRow(1, 1, False, "M4A", 1.0, 20.0, 5, 0.1), *before.rows[5:])
    model.add(msgspec.structs.replace(before, rows=more, total=201), HEIGHT)
    assert model.selected == (1, 1, False, "M20")
    assert (model.cursor, model.cursor - model.top) == (21, place)


def test_a_vanished_row_gives_the_cursor_to_the_one_in_its_place() -> None:
    model = MessagesModel()
    model.add(page(total=5), HEIGHT)
    model.move(4, HEIGHT)
    model.add(page(total=3), HEIGHT)
    assert model.selected == (1, 1, False, "M2")
    model.add(page(total=0), HEIGHT)
    assert model.message_request is None
    assert (model.cursor, shown(model)) == (0, [])


def test_a_new_filter_or_order_starts_anew_and_ignores_old_pages() -> None:
    model = MessagesModel()
    model.add(page(), HEIGHT)
    model.move(30, HEIGHT)
    model.set_filter("m1")
    model.add(page(), HEIGHT)
    assert (shown(model), model.selected) == ([], None)
    model.add(page(text="m1"), HEIGHT)
    assert model.cursor == 0
    model.next_order()
    assert model.page_request(HEIGHT).order == "name"
    model.add(page(order="name", text="m1"), HEIGHT)
    assert model.selected is not None


def test_source_is_closed_from_one_of_its_messages_and_reopened() -> None:
    model = MessagesModel()
    model.add(page(), HEIGHT)
    model.move(3, HEIGHT)
    model.toggle_source()
    assert model.page_request(HEIGHT).closed == ((1, 1, False),)
    model.add(page(total=1), HEIGHT)
    assert (model.cursor, model.selected) == (0, (1, 1, False, ""))
    model.toggle_source()
    assert model.page_request(HEIGHT).closed == ()
