"""Names of results, also of those that the definitions lack."""

from __future__ import annotations

from dialects import rover
from dialects.result_texts import mission_result_name, param_error_text


def test_mission_results_have_their_official_names() -> None:
    official = {name: value for name, value in vars(rover).items() if name.startswith("MAV_MISSION_")}
    results = {
        value: name.removeprefix("MAV_MISSION_")
        for name, value in official.items()
        if not name.startswith("MAV_MISSION_TYPE") and not name.endswith("ENUM_END")
    }
    assert len(results) == 16
    assert {number: mission_result_name(number) for number in results} == results
    assert mission_result_name(99) == "result 99"


def test_parameter_errors() -> None:
    assert param_error_text(1) == "no such parameter"
    assert param_error_text(7) == "the value does not fit its type"
    assert param_error_text(99) == "parameter error 99"
