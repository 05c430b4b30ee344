"""Mistakes in a TOML table, each as one line."""

from __future__ import annotations

from typing import Annotated

import msgspec
import pytest

from link.toml.errors import explain_errors


class Inner(msgspec.Struct, forbid_unknown_fields=True):
    pin: Annotated[int, msgspec.Meta(ge=0, le=27)]
    name: str = ""


class Outer(msgspec.Struct, forbid_unknown_fields=True):
    rate: float
    inner: Inner | None = None
    items: tuple[Inner, ...] = ()


@pytest.mark.parametrize(
    ("table", "lines"),
    [
        ({"rate": 1.0, "inner": {"pin": 5}}, []),
        (
            {"rate": "x", "inner": {"pin": 99, "nam": "a", "name": 5}},
            [
                "top.rate: must be a number, not text in \"quotes\"",
                "top.inner.pin: must be at most 27",
                "top.inner.nam: unknown key; did you mean name?",
                'top.inner.name: must be text in "quotes", not a whole number',
            ],
        ),
        ({"inner": {"name": 5}}, [
            'top.inner.name: must be text in "quotes", not a whole number', "top.inner.pin: missing; add it",
            "top.rate: missing; add it",
        ]),
        ({"rate": 1.0, "items": [{"pin": 1}, {"pin": 28}, {"pn": 1}]}, ["top.items[1].pin: must be at most 27"]),
        ({"rate": 1.0, "a": 1, "b": 2}, [
            "top.a: unknown key; there are rate, inner, items", "top.b: unknown key; there are rate, inner, items",
        ]),
    ],
)  # fmt: skip
def test_each_mistake_is_named_once(table: dict[str, object], lines: list[str]) -> None:
    assert sorted(explain_errors(table, Outer, "top")) == sorted(lines)
