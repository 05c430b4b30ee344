"""Recipe: an instrument of the Drive screen, in two files: its widget and its row in INSTRUMENTS."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

TOY = '''"""Toy instrument."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.look.colours import style
from groundstation.ui.widgets.instrument import Instrument, strip


class ToyReadout(Instrument[int]):
    """Number of texts in the log."""

    DEFAULT_CSS = "ToyReadout { height: 1; }"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the number."""
        return [strip((f"{self.value} texts in the toy", style()))]
'''

ROW = '    instrument_row("toy", "bottom", ToyReadout, lambda now: len(now.snapshot.texts)),'

LOOK_AT_IT = """
import asyncio
from tests.groundstation.ui.examples import TEXTS, snapshot
from tests.groundstation.ui.pilots import console

async def main():
    async with console(size=(140, 45), picture=snapshot(texts=TEXTS)) as screen:
        assert "5 texts in the toy" in screen.text, screen.text
        await screen.show(snapshot(texts=TEXTS[:2]))
        assert "2 texts in the toy" in screen.text, screen.text

asyncio.run(main())
"""


def test_an_instrument(tree: Tree) -> None:
    tree.write("groundstation/ui/drive/instruments/toy.py", TOY)
    instruments = "groundstation/ui/drive/instrument_table.py"
    tree.insert_after(
        instruments,
        "from groundstation.ui.drive.instruments.sticks import",
        "from groundstation.ui.drive.instruments.toy import ToyReadout",
    )
    tree.insert_before(instruments, 'instrument_row("log", "bottom"', ROW)
    tree.check_recipe("an instrument of the Drive screen")
    tree.run_script(LOOK_AT_IT)
