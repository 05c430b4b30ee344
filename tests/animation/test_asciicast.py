"""Recordings of a terminal are written as asciicast v2, and read back; another file is refused with its line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.animation.asciicast import Cast, Output, read_cast, write_cast

HEADER = '{"version": 2, "width": 80, "height": 24, "timestamp": 1504467315, "env": {"TERM": "xterm"}}\n'


def test_a_recording_is_read_as_it_was_written(tmp_path: Path) -> None:
    cast = Cast(80, 24, (Output(0.25, "$ \x1b[1m"), Output(1.5, "─ é\r\n"), Output(1.5, "\x1b[0m")))
    write_cast(cast, tmp_path / "a.cast")
    assert read_cast(tmp_path / "a.cast") == cast


def test_a_line_is_json_as_the_format_asks(tmp_path: Path) -> None:
    write_cast(Cast(100, 30, (Output(0.1234567, "a\nb"),)), tmp_path / "a.cast")
    header, event = (tmp_path / "a.cast").read_text().splitlines()
    assert json.loads(header) == {"version": 2, "width": 100, "height": 30}
    assert json.loads(event) == [0.123457, "o", "a\nb"]


def test_keys_and_markers_of_other_recorders_are_left_out(tmp_path: Path) -> None:
    file = tmp_path / "a.cast"
    file.write_text(HEADER + '[0.1, "i", "x"]\n[0.2, "o", "x"]\n[0.3, "m", "here"]\n[0.4, "r", "100x50"]\n')
    assert read_cast(file) == Cast(80, 24, (Output(0.2, "x"),))


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ("", "a.cast: not an asciicast v2: empty"),
        ('{"version": 1, "width": 80, "height": 24}\n', "a.cast:1: not an asciicast v2: version 1"),
        ('{"version": 2}\n', "a.cast:1: not an asciicast v2: "),
        (HEADER + '[0.1, "o", "x"]\n[0.2, "o"]\n', "a.cast:3: not an asciicast v2: "),
        (HEADER + "\x89PNG\n", "a.cast:2: not an asciicast v2: "),
    ],
)
def test_another_file_is_refused_with_its_line(content: str, place: str, tmp_path: Path) -> None:
    (tmp_path / "a.cast").write_text(content)
    with pytest.raises(ValueError) as caught:
        read_cast(tmp_path / "a.cast")
    assert place in str(caught.value)
