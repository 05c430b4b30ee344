"""COMMAND_LONG and COMMAND_INT become the same request."""

from __future__ import annotations

import math

from dialects.messages import CommandInt, CommandLong
from link.services.command.request import parse_command, value_or_default
from tests.link.command_rig import received


def test_a_parameter_that_is_left_out_has_its_default() -> None:
    assert value_or_default(math.nan) == 0.0
    assert value_or_default(math.nan, 2.5) == 2.5
    assert value_or_default(1.5, 2.5) == 1.5


def test_a_repeat_equals_the_first_also_with_parameters_left_out() -> None:
    first = CommandLong(1, 1, 400, 0, 1, math.nan, float("nan"), 0, 5, 6, 7)
    again = CommandLong(1, 1, 400, 1, 1, float("nan"), math.nan, 0, 5, 6, 7)
    one, two = parse_command(first, received(first)), parse_command(again, received(again))
    assert one == two
    assert (one.repeated, two.repeated) == (False, True)


def test_command_int_has_a_frame_and_exact_coordinates() -> None:
    message = CommandInt(1, 1, 6, 192, 0, 0, 1, 2, 3, 4, 471234567, 81234567, 9.5)
    request = parse_command(message, received(message))
    assert (request.frame, request.x, request.y, request.params[6]) == (6, 471234567, 81234567, 9.5)
    assert request.is_int
    assert request.repeated
