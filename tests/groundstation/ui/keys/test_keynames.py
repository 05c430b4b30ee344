"""Keys as printed on the screen."""

from __future__ import annotations

import pytest

from groundstation.ui.keys.keynames import format_key, main_key
from tests.groundstation.ui.ptys import STANDARD


@pytest.mark.parametrize(
    ("key", "shown"),
    [
        ("i", "i"),
        ("comma", ","),
        ("space", "SPACE"),
        ("ctrl+q", "^q"),
        ("f9", "F9"),
        ("question_mark", "?"),
        ("up", "↑"),
    ],
)
def test_keys_are_written_as_people_do(key: str, shown: str) -> None:
    assert format_key(key) == shown


def test_caps_show_the_block_around_k() -> None:
    assert [main_key(STANDARD, f"drive.{name}") for name in ("forward", "backward", "left", "right", "stop")] == [
        "i", "comma", "j", "l", "k",
    ]  # fmt: skip
