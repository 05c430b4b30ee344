"""Wiring drawings of docs/wiring: texts do not overlap, pins are those of the header, and the files are drawn anew."""

from __future__ import annotations

import importlib.util
import re
import sys
from itertools import combinations
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest

FOLDER = Path(__file__).parents[1] / "docs/wiring"


def load() -> ModuleType:
    """Return the script, which is no module of a package."""
    spec = importlib.util.spec_from_file_location("wiring_draw", FOLDER / "draw.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


DRAW = load()
HEADER = {2: 3, 3: 5, 12: 32, 13: 33, 18: 12, 19: 35, 22: 15, 23: 16, 24: 18, 25: 22, 27: 13}
"""GPIO -> pin of the 40-pin header (https://pinout.xyz)."""
OTHERS = {"3V3": {1, 17}, "GND": {6, 9, 14, 20, 25, 30, 34, 39}}


@pytest.mark.parametrize("name", DRAW.BOARDS)
def test_texts_of_a_drawing_do_not_overlap(name: str) -> None:
    board = DRAW.BOARDS[name]
    boxes = [each.box for each in DRAW.texts(board)]
    for left, top, right, bottom in boxes:
        assert left >= 0
        assert right <= DRAW.WIDTH
        assert top >= 0
        assert bottom <= DRAW.height(board)
    for one, other in combinations(boxes, 2):
        apart = one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]
        assert apart, (name, one, other)
    assert all(each.box[2] <= DRAW.RIGHT + DRAW.BOX for each in DRAW.texts(board) if each.x == DRAW.RIGHT + 8)


@pytest.mark.parametrize("name", DRAW.BOARDS)
def test_wires_go_to_pins_that_the_header_has(name: str) -> None:
    for wire in DRAW.BOARDS[name].pi:
        pin = int(wire.other.rpartition("pin ")[2])
        if gpio := re.match(r"GPIO (\d+) ", wire.other):
            assert HEADER[int(gpio[1])] == pin
        else:
            assert pin in OTHERS[wire.other.split()[0]]


def test_each_file_is_what_the_script_draws() -> None:
    assert {path.stem for path in FOLDER.glob("*.svg")} == DRAW.BOARDS.keys()
    for name, board in DRAW.BOARDS.items():
        text = (FOLDER / f"{name}.svg").read_text()
        assert text == DRAW.draw(board), "run: python docs/wiring/draw.py"
        ElementTree.fromstring(text)
