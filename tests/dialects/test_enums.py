"""Names of enum entries in words."""

from __future__ import annotations

import pytest

from dialects.enums import state_name, type_name


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
