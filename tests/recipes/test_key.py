"""Recipe: a key for an existing action, in one file."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

ANCHOR = '"minus": "speed.slower"'
"""In the standard key map."""
PRESS_IT = """
import asyncio
from groundstation.intents.vehicle import SetMode
from tests.groundstation.ui.pilots import console

async def main():
    async with console(size=(140, 45)) as screen:
        await screen.press("h")
        assert screen.station.of(SetMode) == [SetMode(mode="HOLD")], screen.station.of(SetMode)
        await screen.press("question_mark")
        print(screen.text)

asyncio.run(main())
"""


def test_a_key(tree: Tree) -> None:
    tree.replace("groundstation/input/keymap.py", ANCHOR, ANCHOR + ', "h": "vehicle.hold"')
    tree.check_recipe("a key")
    help_screen = tree.run_script(PRESS_IT)
    [hold] = [line.split() for line in help_screen.splitlines() if "Mode HOLD" in line]
    assert {"2", "h"} <= set(hold)
