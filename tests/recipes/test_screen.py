"""Recipe: a screen, in two files: its module and its row in SCREENS."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

TOY = '''"""Toy screen."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget
from textual.widgets import Static

from groundstation.ui.base.screen import ConsoleScreen


class ToyScreen(ConsoleScreen):
    """One line of text."""

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the line."""
        yield Static("nothing but a toy")
'''

ROW = '    ScreenRow("toy", "Toy", "The toy screen", ("f11",), "y", "groundstation.ui.setup.toy:ToyScreen"),'

OPEN_IT = """
import asyncio
from tests.groundstation.ui.pilots import console
from tests.waits import until

async def main():
    async with console(size=(140, 45)) as screen:
        await screen.press("f11")
        await until(lambda: "nothing but a toy" in screen.text)
        await until(lambda: "F11 Toy" in screen.text and "neutral · F1 drives" in screen.text)
        assert screen.app.gate.closure is not None
        await screen.press("escape")
        await until(lambda: "nothing but a toy" not in screen.text)
        await screen.press("question_mark")
        await until(lambda: "The toy screen" in screen.text)
        await screen.press("escape", "ctrl+g", "y")
        await until(lambda: "nothing but a toy" in screen.text)

asyncio.run(main())
"""


def test_a_screen(tree: Tree) -> None:
    tree.write("groundstation/ui/setup/toy.py", TOY)
    tree.insert_after("groundstation/screens.py", '"groundstation.ui.drive.screen:DriveScreen"),', ROW)
    tree.check_recipe("a screen")
    tree.run_script(OPEN_IT)
