"""Compares a parameter file with the parameters of a vehicle."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from groundstation.formats.param_file import ParamFile
from link.services.param.client import Param

IDENTITY = frozenset(("MAV_SYSID", "SYSID_THISMAV", "MAV_SYS_ID", "MAV_COMP_ID"))
"""Parameters that say which vehicle it is. No file sets them: the ids of two vehicles would be one."""


class ParamComparison(msgspec.Struct, frozen=True):
    """What is the same and what is not, each in the order of the file."""

    same: int
    different: tuple[tuple[str, float, Param], ...]
    """Name, value of the file, and the parameter of the vehicle."""
    only_file: tuple[str, ...]
    only_vehicle: tuple[str, ...]

    @property
    def loadable(self) -> tuple[tuple[str, float, Param], ...]:
        """What is different, without what belongs to one vehicle only."""
        return tuple(each for each in self.different if each[0] not in IDENTITY)

    @property
    def own(self) -> tuple[str, ...]:
        """Names of what is different and belongs to one vehicle only."""
        return tuple(name for name, _, _ in self.different if name in IDENTITY)


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
