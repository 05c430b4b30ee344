"""The line of a key, in all ways to write one."""

from __future__ import annotations

from link.toml.lines import find_line
from tests.rows import each_row

TEXT = '''\
# speed = 1
first = """
speed = 2
[keys]
"""
speed = 3  # the real one
list = [
  1, # keys = 5
  2,
]
a.b = 1
[endpoints]
"quo ted" = 1
field = { host = "x" }

[keys]
"drive.stop" = ["k",
  "space"]
drive.left = "j"
'''


@each_row(
    ("path", "line"),
    [
        (("first",), 2), (("speed",), 6), (("list",), 7), (("a",), 11), (("a", "b"), 11), (("endpoints",), 12),
        (("endpoints", "quo ted"), 13), (("endpoints", "field", "host"), 14), (("keys",), 16),
        (("keys", "drive.stop"), 17), (("keys", "drive", "left"), 19), (("keys", "nothing"), None), (("x",), None),
    ],
)  # fmt: skip
def test_each_key_has_its_line(path: tuple[str, ...], line: int | None) -> None:
    assert find_line(TEXT, path) == line
    assert find_line(TEXT.replace("\n", "\r\n"), path) == line


def test_what_is_not_toml_has_no_lines() -> None:
    assert find_line("[[[", ("a",)) is None


def test_a_long_file_is_searched_by_halves() -> None:
    text = "".join(f"key{number} = {number}\n" for number in range(2000))
    assert find_line(text, ("key1234",)) == 1235
