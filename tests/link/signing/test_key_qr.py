"""A text as a QR code in a terminal, read back from the cells that are drawn."""

from __future__ import annotations

import sys

import pytest

from link.signing.key_qr import draw_qr
from link.signing.missing_package import MissingPackageError

segno = pytest.importorskip("segno")

SHORT, LONG = "A", "AB" * 32
"""Of 21 and 29 modules, both odd: the last half row is empty."""
TONES = {" ": (0, 0), "▀": (1, 0), "▄": (0, 1), "█": (1, 1)}


def modules(text: str) -> list[list[int]]:
    """The modules with a quiet zone of four, as ISO/IEC 18004 asks."""
    return [list(map(int, row)) for row in segno.make(text, micro=False).matrix_iter(border=4)]


@pytest.mark.parametrize("text", [SHORT, LONG])
def test_half_blocks_are_two_rows_of_modules(text: str) -> None:
    drawn = draw_qr(text, unicode=True)
    assert drawn.endswith("\x1b[0m\n")
    rows: list[list[int]] = []
    for line in drawn.splitlines():
        assert line.startswith("\x1b[30;107m")
        cells = line.removeprefix("\x1b[30;107m").removesuffix("\x1b[0m")
        rows += [[TONES[cell][half] for cell in cells] for half in (0, 1)]
    expected = modules(text)
    assert rows == [*expected, [0] * len(expected[0])]
    assert len(expected) in (29, 37)


@pytest.mark.parametrize("text", [SHORT, LONG])
def test_without_unicode_a_module_is_two_spaces(text: str) -> None:
    drawn = draw_qr(text, unicode=False)
    rows = [
        [{"\x1b[40m": 1, "\x1b[107m": 0}[tone] for tone in line.removesuffix("\x1b[0m").split("  ")[:-1]]
        for line in drawn.splitlines()
    ]
    assert rows == modules(text)
    assert drawn.endswith("  \x1b[0m\n")


def test_a_missing_package_is_named_with_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "segno", None)
    with pytest.raises(
        MissingPackageError, match=r"^QR codes need the package segno: .*\[keys\].*; --hex does without$"
    ):
        draw_qr(SHORT, unicode=True)
