"""Rows of CSV files: texts of vehicles are not formulas, and numbers stay numbers."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.formats.csv_row import FORMULAS, csv_row


@pytest.mark.parametrize(
    "text", ['=HYPERLINK("http://evil")', "=cmd|' /C calc'!A0", "@SUM(1)", "-2+3", "+1-1", "\t=1", "\r=1", "-", "=1"]
)
def test_a_formula_of_a_vehicle_is_a_text(text: str) -> None:
    assert next(csv.reader(io.StringIO(csv_row([text]), newline=""))) == [f"'{text}"]


@pytest.mark.parametrize("number", [-2, -0.5, "-2", "+3.5", "-1e-07", "-inf", "nan"])
def test_a_number_stays_a_number(number: object) -> None:
    assert csv_row([number, 1]) == f"{number},1"


@given(st.text())
def test_no_text_begins_as_a_formula_does(text: str) -> None:
    cell = csv_row([text]).removeprefix('"')
    assert not cell.startswith(FORMULAS) or float(cell.removesuffix('"')) is not None
