"""Recipe: a parameter of the vehicle, in one file."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

LIST_AND_SET_IT = """
from dialects import messages as m
from tests.vehicle.bench import Bench

bench = Bench()
bench.say(m.ParamRequestList(1, 1))
bench.wait(10.0)
values = {value.param_id: value.param_value for value in bench.all(m.ParamValue)}
assert values["TOY_LEVEL"] == 5.0, values
bench.arm()
bench.command(400, 0)
bench.say(m.ParamSet(1, 1, b"TOY_LEVEL", 7.0, 9))
bench.wait(1.0)
assert bench.newest(m.ParamValue).param_value == 7.0, bench.texts
bench.say(m.ParamSet(1, 1, b"TOY_LEVEL", 11.0, 9))
assert bench.newest(m.ParamValue).param_value == 7.0
"""


def test_a_parameter(tree: Tree) -> None:
    row = '    Parameter("TOY_LEVEL", 5, 0, 10, "%", "Level of the toy"),'
    tree.insert_after("vehicle/params.py", "TABLE: tuple[Parameter, ...] = (", row)
    tree.check_recipe("a parameter of the vehicle")
    tree.run_script(LIST_AND_SET_IT)
    assert "| TOY_LEVEL | 5 % | 0 to 10 |" in tree.run("vehicle", "dialect")
    assert "TOY_LEVEL" in tree.run("vehicle", "schema")
