"""A recording becomes cells with the right colours, and cells become an animated picture with every frame whole."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.style import Style

pytest.importorskip("PIL", reason="needs the extra pictures")
pytest.importorskip("pyte", reason="needs the extra pictures")

from PIL import Image

from tests.animation.display import Display
from tests.animation.drawing import write_animation
from tests.groundstation.ui.frames import colours


def test_every_frame_is_shown_with_all_its_colours(tmp_path: Path) -> None:
    frames = [Image.new("RGB", (40, 20), "#0b0e14") for _ in range(4)]
    for number, colour in ((1, "#4ec97e"), (2, "#ff5f5f"), (3, "#0b0e14")):
        frames[number].paste(colour, (5, 5, 10 + number, 15))
    frames[2].paste("#58b6ff", (30, 0, 40, 20))
    write_animation(frames, [0.5, 0.1, 0.1, 2.0], tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as made:
        assert getattr(made, "n_frames", 1) == 1 + 4
        assert made.convert("RGB").tobytes() == frames[2].tobytes(), "without animation"
        for number, (frame, duration) in enumerate(zip(frames, (500, 100, 100, 2000), strict=True), start=1):
            made.seek(number)
            assert made.convert("RGB").tobytes() == frame.tobytes(), number
            assert made.info["duration"] == duration


def test_true_colour_named_colour_and_reverse_are_kept() -> None:
    display = Display(10, 1)
    display.write("\x1b[?25l\x1b[1;38;2;88;182;255;48;2;1;2;3mA\x1b[0;33mB\x1b[0;7;38;2;9;9;9mC")
    (a, look_a), (b, look_b), (c, look_c), *_ = display.picture()[0]
    assert (a, b, c) == ("A", "B", "C")
    assert (colours(look_a), look_a.bold) == (("#58b6ff", "#010203"), True)
    assert colours(look_b)[0] == colours(Style(color="yellow"))[0]
    assert colours(look_c)[1] == "#090909"


def test_requests_and_key_modes_of_the_program_show_nothing() -> None:
    display = Display(10, 1)
    display.write("\x1b[?25l\x1b[=31;1u\x1b[?u\x1b[>4;2m\x1b[<u\x1bP+q544e\x1b\\\x1b[?2026$pok")
    assert "".join(text for text, _ in display.picture()[0]).rstrip() == "ok"


def test_the_cursor_of_a_shell_is_a_block() -> None:
    display = Display(4, 1)
    display.write("$ ")
    assert [bool(look.reverse) for _, look in display.picture()[0]] == [False, False, True, False]
