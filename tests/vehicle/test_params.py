"""The parameter table."""

from __future__ import annotations

import math

import pytest

from vehicle.params import TABLE, ParamError, Parameter, Params


@pytest.mark.parametrize("parameter", TABLE, ids=lambda parameter: parameter.name)
def test_every_parameter_fits_the_protocol(parameter: Parameter) -> None:
    assert 1 <= len(parameter.name.encode("ascii")) <= 16
    assert parameter.low <= parameter.default <= parameter.high
    assert parameter.description
    assert not parameter.whole or (parameter.high <= 2**24 and parameter.default == int(parameter.default))


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


@pytest.mark.parametrize(
    ("name", "value"),
    [("MAN_TIMEOUT", 60), ("MAN_TIMEOUT", 0), ("MAN_TIMEOUT", math.nan), ("MOT_DECEL", 100), ("MAV_SYSID", 1.5),
     ("MAV_SYSID", math.inf), ("NO_SUCH", 1)],
)  # fmt: skip
def test_bad_values_are_refused_in_one_line_and_change_nothing(name: str, value: float) -> None:
    params = Params()
    before = {each: params[each] for each in params}
    with pytest.raises(ParamError) as refusal:
        params.set(name, value)
    assert name in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert {each: params[each] for each in params} == before
