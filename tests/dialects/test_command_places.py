"""COMMAND_LONG as COMMAND_INT and back."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

from dialects.command_params import DEFINITION
from dialects.command_places import LOCATED, UNUSED, to_command_int, to_command_long
from dialects.messages import CommandInt, CommandLong


def test_the_table_has_the_commands_with_a_position() -> None:
    commands = next(each for each in ET.parse(DEFINITION).iter("enum") if each.get("name") == "MAV_CMD")
    located = {int(each.get("value", "0")) for each in commands.iter("entry") if each.get("hasLocation") == "true"}
    assert located | {611} == LOCATED


def test_other_parameters_are_whole_numbers_and_nan_is_unused() -> None:
    there = to_command_int(CommandLong(1, 1, 187, 0, 0, 0, 0, 0, 3.0, math.nan, 7.0))
    assert isinstance(there, CommandInt)
    assert (there.x, there.y, there.z) == (3, UNUSED, 7.0)
    back = to_command_long(there, 2)
    assert (back.param5, math.isnan(back.param6), back.param7, back.confirmation) == (3.0, True, 7.0, 2)


def test_a_number_that_fits_no_integer_has_no_other_form() -> None:
    assert to_command_int(CommandLong(1, 1, 187, 0, 0, 0, 0, 0, 3e9, 0, 0)) is None


def test_metres_of_a_local_frame_are_kept() -> None:
    assert to_command_long(CommandInt(1, 1, 1, 192, 0, 0, 0, 0, 0, 0, 15_000, -20_000, 0)).param5 == 1.5
