"""The parameter table."""

from __future__ import annotations

import math

import pytest

from tests.rows import each_row
from vehicle.config.merge import merge_params
from vehicle.params import ORDERED_PAIRS, PARAMETERS, TABLE, ParamError, Parameter, Params


@each_row("parameter", TABLE, ids=lambda parameter: parameter.name)
def test_every_parameter_fits_the_protocol(parameter: Parameter) -> None:
    assert 1 <= len(parameter.name.encode("ascii")) <= 16
    assert parameter.low <= parameter.default <= parameter.high
    assert parameter.description
    assert not parameter.whole or (parameter.high <= 2**24 and parameter.default == int(parameter.default))


TUNED_WHILE_DRIVING = {
    # How it feels, how it follows a path, where it goes by itself, what is recorded: no failsafe, interlock or limit
    # of the motors goes by these. REBOOT_ENABLE and DRIVE_TYPE are read only, and MAV_SYSID waits for a restart.
    "MAV_SYSID", "REBOOT_ENABLE", "DRIVE_TYPE", "INITIAL_MODE", "MANUAL_EXPO", "MANUAL_STR_EXPO", "ACRO_TURN_RATE",
    "WP_SPEED", "WP_RADIUS", "WP_PIVOT_ANGLE", "WP_PIVOT_RATE", "RTL_SPEED", "RALLY_LIMIT_KM", "RALLY_INCL_HOME",
    "LOIT_RADIUS", "TURN_RADIUS", "TRACK_WIDTH", "WHEELBASE", "CRUISE_SPEED", "CRUISE_THROTTLE", "ATC_ACCEL_MAX",
    "ATC_SPEED_P", "ATC_SPEED_I", "ATC_STR_ANG_P", "ATC_STR_RAT_P", "ATC_STR_RAT_I", "ATC_STR_RAT_FF",
    "LOG_BACKEND_TYPE", "LOG_DISARMED", "LOG_MAX_FILES", "LOG_FILE_MB_FREE",
}  # fmt: skip


def test_whatever_is_not_named_here_is_refused_while_armed() -> None:
    assert {parameter.name for parameter in TABLE if not parameter.safety} == TUNED_WHILE_DRIVING


def test_names_are_unique() -> None:
    assert len({parameter.name for parameter in TABLE}) == len(TABLE)


def test_the_defaults_stop_in_time() -> None:
    params = Params()
    cycle = 0.02
    assert params["MAN_TIMEOUT"] + cycle <= 0.5
    assert params["MAN_TIMEOUT"] + cycle + 100 / params["MOT_DECEL"] + cycle <= 1.0


def test_values_replace_defaults() -> None:
    params = Params({"FS_LOOP_TIMEOUT": 1.0})
    assert params["FS_LOOP_TIMEOUT"] == 1.0
    assert len(params) == len(TABLE)
    assert list(params) == [parameter.name for parameter in TABLE]


@each_row(
    ("name", "value"),
    [("MAN_TIMEOUT", 60), ("MAN_TIMEOUT", 0), ("MAN_TIMEOUT", math.nan), ("MOT_DECEL", 100), ("MAV_SYSID", 1.5),
     ("MAV_SYSID", math.inf), ("NO_SUCH", 1), ("MOT1_MIN", 81), ("MOT2_MAX", 24), ("MOT3_TRIM", 21),
     ("MOT4_REVERSED", 0.5)],
)  # fmt: skip
def test_bad_values_are_refused_in_one_line_and_change_nothing(name: str, value: float) -> None:
    params = Params()
    before = {each: params[each] for each in params}
    with pytest.raises(ParamError) as refusal:
        params.set(name, value)
    assert name in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert {each: params[each] for each in params} == before


# ---- values that must fit each other


@pytest.mark.parametrize(
    ("first", "second"),
    [(("MOT1_MIN", 60), ("MOT1_MAX", 60)), (("MOT2_MAX", 30), ("MOT2_MIN", 40)), (("MOT4_MIN", 80), ("MOT4_MAX", 25))],
)
def test_a_smallest_that_is_not_smaller_is_refused(first: tuple[str, float], second: tuple[str, float]) -> None:
    params = Params(dict([first]))
    with pytest.raises(ParamError, match=r"^MOT\d_MIN \d+ must be smaller than MOT\d_MAX \d+$"):
        params.set(*second)
    assert params[second[0]] == PARAMETERS[second[0]].default
    assert params[first[0]] == first[1]


@pytest.mark.parametrize(("small", "large"), ORDERED_PAIRS)
def test_values_that_fit_may_come_in_any_order(small: str, large: str) -> None:
    fits = [(small, 60.0), (large, 61.0)]
    for each in (fits, fits[::-1]):
        params = Params(dict(each))
        assert (params[small], params[large]) == (60.0, 61.0)
        params, left_out = merge_params({}, kept=dict(each), usual={large: 30.0})
        assert (params[small], params[large], left_out) == (60.0, 61.0, [])
    assert PARAMETERS[small].default == PARAMETERS[small].low
    assert PARAMETERS[large].default == PARAMETERS[large].high


def test_the_later_wins() -> None:
    given, kept, usual = {"SPEED_MAX": 4.0}, {"SPEED_MAX": 3.0, "WP_SPEED": 3.0}, {"SPEED_MAX": 2.0, "WP_SPEED": 2.0}
    params, left_out = merge_params(given, kept=kept, usual={**usual, "RTL_SPEED": 2.0}, pinned=given)
    assert [params[name] for name in ("SPEED_MAX", "WP_SPEED", "RTL_SPEED")] == [4.0, 3.0, 2.0]
    assert left_out == []
    pinned = [each.name for each in params.table if each.read_only and not PARAMETERS[each.name].read_only]
    assert pinned == ["SPEED_MAX"]


def test_kept_values_that_fit_no_more_are_left_out_and_told() -> None:
    kept = {"MOT1_MIN": 60.0, "MOT2_MIN": 10.0, "GONE": 1.0, "MAN_TIMEOUT": 99.0}
    params, left_out = merge_params({"MOT1_MAX": 50.0}, kept=kept, usual={})
    assert (params["MOT1_MIN"], params["MOT1_MAX"], params["MOT2_MIN"]) == (0.0, 50.0, 10.0)
    assert left_out == [
        "MOT1_MIN 60 must be smaller than MOT1_MAX 50",
        "no parameter 'GONE'",
        "MAN_TIMEOUT must be 0.2 to 2, not 99",
    ]


def test_what_is_given_and_contradicts_is_refused() -> None:
    with pytest.raises(ParamError, match="MOT1_MIN 60 must be smaller than MOT1_MAX 50"):
        merge_params({"MOT1_MAX": 50.0, "MOT1_MIN": 60.0}, kept={}, usual={})
    with pytest.raises(ParamError, match="MOT1_MIN 70 must be smaller than MOT1_MAX 60"):  # of the article's car
        merge_params({"MOT1_MIN": 70.0}, kept={}, usual={"MOT1_MAX": 60.0})
