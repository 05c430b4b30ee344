"""TOML files that cannot be read are one line with a remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from link.toml.file import TomlError, find_unsupported, parse_toml, read_toml


def test_a_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert read_toml(tmp_path / "a.toml") == {"a": 1}


def test_what_is_not_a_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(TomlError, match=r"is a directory; name a file in it$"):
        read_toml(tmp_path)
    with pytest.raises(TomlError, match=r"No such file or directory$"):
        read_toml(tmp_path / "a.toml")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("[a]\n[a]", r"x.toml: \[a\] exists already, and again at line 2; move its lines below the first one"),
        ("a = 1\na = 2", "x.toml: the key is set already, at end of document; remove one of them"),
        ("a = " + "[" * 40 + "]" * 40, "x.toml: lists or tables are nested too deep"),
        ("a = " + "1" * 5000, "x.toml: a number with thousands of digits"),
    ],
)
def test_an_error_names_the_file_and_the_remedy(text: str, error: str) -> None:
    with pytest.raises(TomlError, match=f"^{error}$"):
        parse_toml(text, "x.toml")


def test_values_that_no_setting_accepts_are_named() -> None:
    table = {"a": {"b": 2**64}, "c": ["x\0"], "d": "fine"}
    assert list(find_unsupported(table)) == [
        "a.b: the number is too large",
        "c[0]: contains the character NUL; remove it",
    ]
