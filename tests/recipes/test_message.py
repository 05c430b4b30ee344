"""Recipe: a message that the vehicle handles, in two files: its name, and its row with its handler."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

NAME = "PlayTune = rover.MAVLink_play_tune_message"

ROW = '            InboundMessage(PlayTune, Access.INTRODUCED, "shown as a text", self._play),'

HANDLER = """    def _play(self, received: Received, message: PlayTune, now: float) -> None:
        self._texts.send(Severity.INFO, f"tune {message.tune}", now)
"""

SEND_IT = """
from dialects import messages as m
from tests.vehicle.bench import Bench

bench = Bench()
bench.say(m.PlayTune(1, 1, b"CDE"))
bench.wait(1.0)
assert any("tune CDE" in text for text in bench.texts), bench.texts
"""


def test_a_message(tree: Tree) -> None:
    tree.insert_after("dialects/messages.py", "SetupSigning = rover.MAVLink_setup_signing_message", NAME)
    signing = "vehicle/commands/signing.py"
    tree.insert_before(signing, "            InboundMessage(SetupSigning,", ROW)
    tree.insert_after(signing, "from dialects.messages import", "from dialects.messages import PlayTune")
    tree.insert_before(signing, "    def _handle(self", HANDLER)
    tree.check_recipe("a message that the vehicle handles")
    tree.run_script(SEND_IT)
    assert "| PLAY_TUNE |" in tree.run("vehicle", "dialect")
