"""Recipe: a verb, in two files: its function in a module of a room, and its row in the table of that room.

The row has its help, its examples and MAVProxy's words for it.
"""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

MODULE = '''"""`mavhelm horn`: sounds the horn of a vehicle, which is a relay."""

from __future__ import annotations

import argparse

from dialects.enums import Command
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Switch the relay on; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(number, Command.DO_SET_RELAY, (options.relay, 1.0), "horn", now)
    )
    return finish(session, report, output, "sounds its horn")
'''

ROW = """    "horn": Verb(Group.VEHICLE, (
        Example("mavhelm horn --relay 1", "sounds the horn at relay 1"),
    ), {ONLY: VerbAction("sound the horn", horn.run,
        (("--relay", {"type": float, "default": 0.0, "metavar": "N", "help": "its relay (0)"}),),
        needs_session=True)}, mavproxy={"siren": "horn --relay 0"}),"""

SOUND_IT = """
import contextlib
import io

from dialects.enums import Command
from groundstation.cli.main import main
from tests.fakes.services import foreign_vehicle

with foreign_vehicle() as vehicle:
    vehicle.beat_period = 0.05
    assert main(["horn", "--relay", "2", "-e", vehicle.endpoint, "--station", "never"]) == 0
    commands = [each for _, each in vehicle.received if getattr(each, "command", 0) == Command.DO_SET_RELAY]
sent = [(each.param1, each.param2) for each in commands]
assert sent == [(2.0, 1.0)], sent

said = io.StringIO()
with contextlib.redirect_stderr(said):
    assert main(["siren"]) == 2
assert said.getvalue() == "mavhelm: siren: use `mavhelm horn --relay 0`\\n", said.getvalue()
"""


def test_a_verb(tree: Tree) -> None:
    tree.write("groundstation/verbs/control/horn.py", MODULE)
    table = "groundstation/verbs/control/table.py"
    tree.replace(table, "import arm, control, drive, flight, mode,", "import arm, control, drive, flight, horn, mode,")
    tree.insert_after(table, 'drive = LazyModule("control.drive")', '    horn = LazyModule("control.horn")')
    tree.insert_before(table, '    "motor": Verb(', ROW)
    tree.check_recipe("a verb of the command line")
    tree.run_script(SOUND_IT)
    assert "sounds the horn at relay 1" in tree.run("groundstation", "horn", "--help")
    assert " horn" in tree.run("groundstation", "--help")
    assert "mavhelm horn       sound the horn" in tree.run("groundstation", "--help-all")
    assert "-a horn -d 'sound the horn'" in tree.run("groundstation", "completion", "fish")
