"""Recipe: an action of the operator, in two files: its intent, which sends its command, and its row in ACTIONS."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

INTENT = '''class SoundHorn(VehicleIntent, frozen=True):
    """Switch relay 0 on: the horn."""

    neutral = False

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Send the command."""
        commands.send(vehicle, "horn", "DO_SET_RELAY", 0, 1, now=now)


'''

ROW = '    OperatorAction("vehicle.horn", "Horn", "Sound the horn", "vehicle", SoundHorn(), ("h",)),'

PRESS_IT = """
import asyncio
from groundstation.intents.vehicle import SoundHorn
from tests.groundstation.ui.pilots import console

async def press():
    async with console(size=(140, 45)) as screen:
        await screen.press("h")
        assert screen.station.of(SoundHorn) == [SoundHorn()]
        await screen.press("question_mark")
        assert "Sound the horn" in screen.text

asyncio.run(press())
"""

SEND_IT = """
from dialects import messages as m
from dialects.enums import Command
from groundstation.intents.vehicle import SoundHorn
from tests.test_stops import Drive

drive = Drive()
drive.until(lambda: drive.station.snapshot(drive.world.now, 0).vehicle is not None)
drive.tell(SoundHorn())
drive.run(1.0)
sent = [message.command for _, message in drive.world.near.sent if isinstance(message, m.CommandLong)]
assert Command.DO_SET_RELAY in sent, sent
"""


def test_an_action_of_the_operator(tree: Tree) -> None:
    tree.insert_before("groundstation/intents/vehicle.py", "class SelectVehicle(Intent", INTENT)
    tree.insert_before("groundstation/actions.py", 'OperatorAction("app.simulator"', ROW)
    tree.replace("groundstation/actions.py", "    TakeOff,\n)", "    SoundHorn,\n    TakeOff,\n)")
    tree.check_recipe("an action of the operator")
    tree.run_script(PRESS_IT)
    tree.run_script(SEND_IT)
