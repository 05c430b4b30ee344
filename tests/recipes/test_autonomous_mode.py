"""Recipe: an autonomous mode with a number of ArduRover's, in three files: its class and its rows in two tables."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

CIRCLE = '''"""CIRCLE: turns to the right."""

from __future__ import annotations

from vehicle.autonomy.mode import ModeContext
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.speed_control import DesiredMotion


class CircleMode:
    """Constant speed and turn rate."""

    goal: Point | None = None

    def __init__(self, context: ModeContext) -> None:
        self._params = context.params

    def unready(self, estimate: Estimate) -> str | None:
        """Return None: CIRCLE can always begin."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Do nothing: CIRCLE keeps no state."""

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion:
        """Return the motion of a circle."""
        return DesiredMotion(speed, 0.5)
'''

DRIVE_IT = """
from dialects.modes import Mode
from tests.vehicle.field import Field

field = Field(seed=None)
field.begin(Mode.CIRCLE)
field.beat(8.0)
assert field.mode is Mode.CIRCLE, (field.mode, field.texts)
assert field.speed > 0.5, field.speed
assert field.yaw > 1.0 or field.yaw < -1.0, field.yaw
field.set_mode(Mode.HOLD)
field.beat(3.0)
assert field.speed < 0.05
"""


def test_an_autonomous_mode(tree: Tree) -> None:
    tree.write("vehicle/autonomy/modes/circle.py", CIRCLE)
    tree.insert_after(
        "vehicle/modes.py",
        "        ModeSpec(Mode.HOLD),",
        "        ModeSpec(Mode.CIRCLE, autonomous=True, requirement=ModeRequirement.POSITION),",
    )
    navigator = "vehicle/autonomy/navigator.py"
    tree.insert_after(navigator, "    Mode.LOITER: LoiterMode,", "    Mode.CIRCLE: CircleMode,")
    tree.insert_before(
        navigator,
        "from vehicle.autonomy.modes.guided import",
        "from vehicle.autonomy.modes.circle import CircleMode",
    )
    tree.check_recipe("an autonomous mode")
    tree.run_script(DRIVE_IT)
    assert "CIRCLE" in tree.run("vehicle", "dialect")
