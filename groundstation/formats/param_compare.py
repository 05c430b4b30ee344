"""Compares a parameter file with the parameters of a vehicle."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from groundstation.formats.param_file import ParamFile
from link.services.param.client import Param


class ParamComparison(msgspec.Struct, frozen=True):
    """What is the same and what is not, each in the order of the file."""

    same: int
    different: tuple[tuple[str, float, Param], ...]
    """Name, value of the file, and the parameter of the vehicle."""
    only_file: tuple[str, ...]
    only_vehicle: tuple[str, ...]


def compare(file: ParamFile, params: Mapping[str, Param], component: int) -> ParamComparison:
    """Compare. Lines of another component are not the vehicle's and are left out."""
    wanted = {line.name: line.value for line in file.lines if line.component in (None, component)}
    different = tuple(
        (name, value, params[name])
        for name, value in wanted.items()
        if name in params and not params[name].equals(value)
    )
    only_file = tuple(name for name in wanted if name not in params)
    only_vehicle = tuple(name for name in params if name not in wanted)
    same = len(wanted) - len(different) - len(only_file)
    return ParamComparison(same, different, only_file, only_vehicle)
