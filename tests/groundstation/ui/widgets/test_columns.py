"""Which columns of a table fit a width."""

from __future__ import annotations

from groundstation.ui.params.table import COLUMNS
from groundstation.ui.widgets.columns import GAP, Column, fit
from tests.rows import each_row


def test_what_is_worth_less_never_stands_where_more_did_not_fit() -> None:
    columns = (Column("name", 10), Column("value", 8, 1), Column("unit", 2, 2))
    assert fit(columns, 15) == (10, 0, 0)
    assert fit(columns, 20) == (10, 8, 0)
    assert fit(columns, 22) == (10, 8, 2)


@each_row("width", range(23, 140))
def test_a_parameter_has_its_value_before_its_unit(width: int) -> None:
    widths = dict(zip((column.title for column in COLUMNS[1:]), fit(COLUMNS, width)[1:], strict=True))
    assert widths["value"]
    assert widths["unit"] == 0 or widths["unit"] >= len("deg/s")
    assert sum(size + GAP for size in fit(COLUMNS, width) if size) - GAP <= width
