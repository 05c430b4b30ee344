"""Finding D9: safety parameters are not weakened unnoticed, and not beyond the bound of 1 s from outside."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, ParamErrorCode, Result, Severity
from link.services.param.values import REAL32
from tests.vehicle.bench import OTHER, Bench, logged, said
from vehicle.config.merge import merge_params
from vehicle.params import PARAMETERS, SAFETY_PARAMETERS, ParamError, Params
from vehicle.safety.param_report import list_changed_safety_params


def set_param(bench: Bench, name: str, value: float, system: int = OTHER) -> float:
    """Set a parameter; return the value afterwards."""
    bench.say(m.ParamSet(1, 1, name.encode(), value, REAL32), system)
    return bench.newest(m.ParamValue).param_value


class TestAtArming:
    def test_each_weakened_parameter_is_a_text_to_all_and_in_the_log(self) -> None:
        bench = Bench()
        assert set_param(bench, "FS_GCS_ENABLE", 0) == 0
        assert set_param(bench, "FS_TIMEOUT", 10) == 10
        bench.wait(5.0)
        bench.texts.clear()
        bench.logged.clear()
        assert bench.arm() is Result.ACCEPTED
        bench.wait(1.0)
        for text in ("FS_GCS_ENABLE is 0, default 1", "FS_TIMEOUT is 10, default 1.5"):
            assert text in bench.texts
            assert logged(bench, text)
        warnings = [each for each in bench.all(m.StatusText) if " is 0, default 1" in m.decode_text(each)]
        assert [each.severity for each in warnings] == [Severity.WARNING]
        assert bench.peers[bench.sent.index(warnings[0])] is None
        assert bench.texts.index("FS_TIMEOUT is 10, default 1.5") > next(
            index for index, text in enumerate(bench.texts) if text.startswith("Armed")
        )

    def test_with_defaults_there_is_none(self) -> None:
        bench = Bench()
        assert bench.arm() is Result.ACCEPTED
        bench.wait(1.0)
        assert not said(bench, "default")

    def test_of_many_ten_are_sent_and_all_are_logged(self) -> None:
        bench = Bench()
        for bit in range(15):
            set_param(bench, f"BTN{bit}_FUNCTION", 2)
        bench.wait(5.0)
        bench.texts.clear()
        bench.logged.clear()
        assert bench.arm() is Result.ACCEPTED
        bench.wait(3.0)
        assert sum(", default 0" in text for text in bench.texts) == 10
        assert "and 5 more" in bench.texts
        assert all(logged(bench, f"BTN{bit}_FUNCTION is 2, default 0") for bit in range(15))

    def test_the_default_is_that_of_the_car(self) -> None:
        params = Params({"MOT1_TRIM": 5.0, "FS_TIMEOUT": 2.0, "WP_SPEED": 2.0}, usual={"MOT1_TRIM": 5.0})
        assert list_changed_safety_params(params) == ["FS_TIMEOUT is 2, default 1.5"]

    def test_every_safety_parameter_is_reported(self) -> None:
        for name in SAFETY_PARAMETERS:
            each = PARAMETERS[name]
            other = each.low if each.default != each.low else each.high
            if not name.endswith(("_MIN", "_MAX")) or not name.startswith("MOT"):
                assert len(list_changed_safety_params(Params({name: other}))) == 1, name


class TestChanges:
    def test_a_change_while_no_one_is_in_control_is_announced_to_all(self) -> None:
        bench = Bench()
        assert set_param(bench, "FS_GCS_ENABLE", 0) == 0
        bench.wait(0.1)
        text = f"GCS {OTHER}: FS_GCS_ENABLE set to 0, default 1"
        assert text in bench.texts
        assert logged(bench, text)
        message = bench.newest(m.StatusText)
        assert message.severity == Severity.NOTICE
        assert bench.peers[bench.sent.index(message)] is None

    def test_a_change_back_and_forth_is_announced_each_time(self) -> None:
        bench = Bench()
        for value in (0, 1, 0):
            set_param(bench, "FS_GCS_ENABLE", value)
            bench.wait(0.5)
        assert sum("FS_GCS_ENABLE set to 0" in text for text in bench.texts) == 2

    def test_others_than_safety_parameters_are_not_announced(self) -> None:
        bench = Bench()
        set_param(bench, "WP_SPEED", 2.0)
        bench.wait(0.1)
        assert bench.texts == []


class TestLimit:
    @pytest.mark.parametrize("name", ["MAN_TIMEOUT", "OPR_ECHO_MAX"])
    def test_no_ground_station_sets_more_than_half_a_second(self, name: str) -> None:
        bench = Bench()
        assert set_param(bench, name, 0.51) == pytest.approx(0.45)
        assert bench.newest(m.ParamError).error == ParamErrorCode.VALUE_OUT_OF_RANGE
        assert set_param(bench, name, 0.5) == 0.5

    @pytest.mark.parametrize("name", ["MAN_TIMEOUT", "OPR_ECHO_MAX"])
    def test_rover_toml_and_the_command_line_do(self, name: str) -> None:
        params, left_out = merge_params({name: 1.5}, kept={}, usual={}, pinned=(name,))
        assert (params[name], left_out) == (1.5, [])
        params, _ = merge_params({name: 1.5}, kept={}, usual={}, run={name: 1.5})
        assert params[name] == 1.5

    @pytest.mark.parametrize("name", ["MAN_TIMEOUT", "OPR_ECHO_MAX"])
    def test_a_saved_value_above_it_is_left_out(self, name: str) -> None:
        params, left_out = merge_params({}, kept={name: 1.5, "SPEED_MAX": 2.0}, usual={})
        assert params[name] == pytest.approx(0.45)
        assert params["SPEED_MAX"] == 2.0
        assert left_out == [f"{name} 1.5 is above 0.5, which only rover.toml or --param may set"]

    def test_ground_stations_see_the_limit_as_the_range(self) -> None:
        high = {each.name: each.high for each in Params().table}
        assert (high["MAN_TIMEOUT"], high["OPR_ECHO_MAX"], high["FS_TIMEOUT"]) == (0.5, 0.5, 10)

    def test_a_value_from_rover_toml_may_be_sent_back_unchanged(self) -> None:
        bench = Bench(MAN_TIMEOUT=1.5)
        assert set_param(bench, "MAN_TIMEOUT", 1.5) == 1.5
        assert bench.all(m.ParamError) == []

    def test_values_beyond_the_range_are_an_error_everywhere(self) -> None:
        with pytest.raises(ParamError):
            Params({"MAN_TIMEOUT": 2.1})


class TestFence:
    def test_a_fence_that_a_command_disables_is_announced_to_all(self) -> None:
        bench = Bench()
        for wanted in (1, 1, 0):
            assert bench.command(Command.DO_FENCE_ENABLE, wanted, system=OTHER) is Result.ACCEPTED
            bench.wait(0.5)
        for texts in (bench.texts, bench.logged):
            changes = [text for text in texts if text.startswith("GCS")]
            assert changes == [f"GCS {OTHER}: fence enabled", f"GCS {OTHER}: fence disabled"]
