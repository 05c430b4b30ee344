"""What a tab may send: keys and sizes for the pseudo-terminal; anything else does nothing."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("aiohttp", reason="the extra [web] is not installed")
from groundstation.web.server import _number, _take


class Terminal:
    """Keeps what reaches it."""

    def __init__(self) -> None:
        self.got: list[object] = []

    def type(self, text: str) -> None:
        self.got.append(text)

    def resize(self, size: tuple[int, int]) -> None:
        self.got.append(size)


def test_keys_and_sizes_reach_the_terminal() -> None:
    terminal = Terminal()
    for message in (["stdin", "i"], ["resize", {"width": 100, "height": 30}], ["ping", "1"], ["focus"], ["blur"]):
        _take(terminal, json.dumps(message))  # type: ignore[arg-type]
    assert terminal.got == ["i", (100, 30)]


@pytest.mark.parametrize(
    "text",
    [
        "", "{}", "[]", "null", "1", '"stdin"', '["resize"]', '["resize", 3]', '["resize", {"width": "wide"}]',
        '["resize", {"width": Infinity, "height": 3}]', '["resize", {"width": NaN, "height": 3}]', "[" * 100_000,
    ],
)  # fmt: skip
def test_anything_else_does_nothing(text: str) -> None:
    terminal = Terminal()
    _take(terminal, text)  # type: ignore[arg-type]
    assert terminal.got == []


def test_numbers_of_an_address() -> None:
    assert [_number(text, 80) for text in (None, "", "-1", "1e3", "\u0663", "999999", "100")] == [80] * 6 + [100]
