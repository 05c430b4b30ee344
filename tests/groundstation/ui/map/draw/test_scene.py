"""What range sensors see, on the maps."""

from __future__ import annotations

import math

from groundstation.ui.map.draw.plan_map import PlanMap
from groundstation.ui.map.draw.plan_map_value import PlanMapValue
from groundstation.ui.map.draw.scene import build_obstacles
from tests.groundstation.ui.examples import vehicle


def test_obstacles_stand_where_the_vehicle_sees_them() -> None:
    seen = vehicle(heading=math.pi / 2, obstacles=((0.0, 2.0), (math.pi / 2, 1.0)))
    assert build_obstacles((10.0, 20.0), seen) == ((10.0, 22.0), (9.0, 20.0))
    assert build_obstacles(None, seen) == ()
    assert build_obstacles((0.0, 0.0), vehicle(heading=None, obstacles=((0.0, 2.0),))) == ()
    empty, drawn = (
        PlanMap(PlanMapValue("", home=(0.0, 0.0), vehicle=(0.0, 0.0), obstacles=points)).draw(40, 12)
        for points in ((), ((0.5, 0.5),))
    )
    assert [line.text for line in empty] != [line.text for line in drawn]
