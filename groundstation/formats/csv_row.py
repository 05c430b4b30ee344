"""Rows of CSV files whose words come from vehicles: no cell is a formula to a spreadsheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

FORMULAS = ("=", "+", "-", "@", "\t", "\r")
"""How a cell begins that spreadsheets calculate (OWASP, CSV injection)."""

END = "\r\n"


def csv_row(cells: Iterable[object]) -> str:
    """Return one line without its end. A text that a spreadsheet would calculate gets a quote before it."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator=END)  # it quotes a cell with a character of the end of a line
    writer.writerow([_plain(cell) if isinstance(cell, str) else cell for cell in cells])
    return out.getvalue().removesuffix(END)


def _plain(text: str) -> str:
    return f"'{text}" if text.startswith(FORMULAS) and not _is_number(text) else text


def _is_number(text: str) -> bool:
    if text != text.strip():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True
