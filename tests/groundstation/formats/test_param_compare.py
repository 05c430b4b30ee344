"""A file against the parameters of a vehicle."""

from __future__ import annotations

from groundstation.formats.param_compare import compare
from groundstation.formats.param_file import parse_params
from link.services.param.client import Param

HERE = {
    name: Param(name, value, 9, index)
    for index, (name, value) in enumerate({"A": 1.0, "B": 0.1, "C": 3.0, "D": 4.0}.items())
}


def test_all_kinds_of_differences() -> None:
    found = compare(parse_params("A 2\nB 0.100000001490116\nE 5\n", "x"), HERE, 1)
    assert (found.same, found.different) == (1, (("A", 2.0, HERE["A"]),))
    assert (found.only_file, found.only_vehicle) == (("E",), ("C", "D"))


def test_lines_of_another_component_do_not_count() -> None:
    found = compare(parse_params("1\t1\tA\t1\t9\n1\t2\tB\t7\t9\n", "x"), HERE, 1)
    assert (found.same, found.different, found.only_vehicle) == (1, (), ("B", "C", "D"))
