"""Names of enum entries in words."""

from __future__ import annotations

import pytest

from dialects.enums import result_name, result_token, state_name, type_name


@pytest.mark.parametrize(
    ("number", "name"),
    [(0, "generic"), (10, "ground rover"), (18, "onboard controller"), (30, "camera"), (250, "type 250")],
)
def test_types(number: int, name: str) -> None:
    assert type_name(number) == name


@pytest.mark.parametrize(
    ("number", "name"), [(0, "uninit"), (5, "critical"), (8, "flight termination"), (9, "state 9")]
)
def test_states(number: int, name: str) -> None:
    assert state_name(number) == name


@pytest.mark.parametrize(
    ("number", "token"),
    [(4, "FAILED"), (6, "CANCELLED"), (8, "COMMAND_INT_ONLY"), (9, "COMMAND_UNSUPPORTED_MAV_FRAME"),
     (10, "NOT_IN_CONTROL"), (11, "RESULT_11")],
)  # fmt: skip
def test_results_have_their_names_of_common_xml(number: int, token: str) -> None:
    assert result_token(number) == token
    assert result_name(number) == token.replace("_", " ").lower()
