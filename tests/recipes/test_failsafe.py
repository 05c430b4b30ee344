"""Recipe: a failsafe, in two files: its bit, and its row in RULES with its condition."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

CONDITION = """

def _upside_down(inputs: FailsafeInputs, now: float) -> float | None:
    roll = inputs.motion.readings.roll
    return now if roll is not None and abs(roll) > 3.0 else None

"""

ROW = """    Failsafe.UPSIDE_DOWN: FailsafeRule(
        "upside down", _upside_down, (_HOLD, FailsafeStep(5, FailsafeAction.DISARM)), help="roll above 3 rad"),"""

TURN_IT_OVER = """
from msgspec.structs import replace
from dialects import messages as m
from dialects.enums import Failsafe
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, Bench

bench = Bench(CRASH_ANGLE=0)
bench.readings = replace(bench.readings, roll=0.0)
bench.drive()
bench.readings = replace(bench.readings, roll=3.14)
bench.wait(1.5, AHEAD)
assert not bench.turning
assert bench.mode is Mode.HOLD
assert any("upside down" in text for text in bench.texts), bench.texts
assert Failsafe(bench.newest(m.RoverFailsafeStatus).active) & Failsafe.UPSIDE_DOWN
bench.wait(5.0, AHEAD)
assert not bench.armed
"""


def test_a_failsafe(tree: Tree) -> None:
    tree.insert_after("dialects/enums.py", "    ESTOP = rover.ROVER_FAILSAFE_ESTOP", "    UPSIDE_DOWN = 1 << 20")
    rules = "vehicle/safety/failsafe.py"
    tree.insert_before(rules, "_LIMIT, _STOP = FailsafeStep(", CONDITION)
    tree.insert_after(rules, "RULES: dict[Failsafe, FailsafeRule] = {", ROW)
    tree.check_recipe("a failsafe")
    tree.run_script(TURN_IT_OVER)
