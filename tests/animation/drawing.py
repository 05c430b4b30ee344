"""Draws a recording of a terminal as an animated PNG (APNG) with a palette."""

from __future__ import annotations

import io
import subprocess
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import cast as typed

from PIL import Image, ImageChops, PngImagePlugin

from tests.animation.asciicast import Cast
from tests.animation.display import Display
from tests.animation.moments import choose_moments, merge_equal
from tests.groundstation.ui import frames
from tests.groundstation.ui.png_palette import Colour, choose_palette

STEP = 0.1
"""s between two frames at least."""
LONGEST = 1.0
"""s for which a frame is shown at most, however long the program takes to start."""
LAST = 2.0
"""s for which the last frame is shown before the first one comes again."""
UNCHANGED = 63
"""Index of the palette for a pixel that stays as it is; those below are colours."""


def draw(cast: Cast, file: Path) -> int:
    """Write the picture of a recording; return the number of its frames."""
    pictures = _pictures(cast)
    write_animation([_image(picture) for picture, _ in pictures], [duration for _, duration in pictures], file)
    return len(pictures)


def write_animation(images: Sequence[Image.Image], durations: Sequence[float], file: Path) -> None:
    """Write images (RGB, all of one size) that are shown for so many s each, again and again.

    Programs that show no animation show the one in the middle.
    """
    reduced = _reduce(images)
    changes = [_changes(before, after) for before, after in pairwise(reduced)]
    reduced[len(reduced) // 2].save(
        file, format="PNG", save_all=True, default_image=True, append_images=[reduced[0], *changes],
        transparency=UNCHANGED, blend=PngImagePlugin.Blend.OP_OVER, loop=0,
        duration=[round(duration * 1000) for duration in durations],
    )  # fmt: skip


def _pictures(cast: Cast) -> list[tuple[frames.Picture, float]]:
    display = Display(cast.width, cast.height)
    pictures = []
    for moment in choose_moments(cast.outputs, STEP, LONGEST, LAST):
        display.write(moment.text)
        pictures.append((display.picture(), moment.duration))
    return merge_equal(pictures)


def _image(picture: frames.Picture) -> Image.Image:
    svg = frames.svg(picture).encode()
    png = subprocess.run(["rsvg-convert"], input=svg, check=True, capture_output=True).stdout
    return Image.open(io.BytesIO(png)).convert("RGB")


def _reduce(images: Sequence[Image.Image]) -> list[Image.Image]:
    """Return the images with one palette for all, in which UNCHANGED is no colour."""
    counts: Counter[Colour] = Counter()
    for image in images:
        for count, colour in image.getcolors(image.width * image.height) or ():
            counts[typed(Colour, colour)] += count
    colours = choose_palette(counts, UNCHANGED)
    colours += colours[:1] * (UNCHANGED + 1 - len(colours))
    palette = Image.new("P", (1, 1))
    palette.putpalette([part for colour in colours for part in colour])
    return [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in images]


def _changes(before: Image.Image, after: Image.Image) -> Image.Image:
    """Return a picture of the pixels that differ, UNCHANGED elsewhere: it takes half the bytes of a whole one."""
    drawn, shown = (Image.frombytes("L", each.size, each.tobytes()) for each in (before, after))
    changes = Image.new("P", after.size, UNCHANGED)
    changes.putpalette(after.getpalette() or [])
    changes.info["transparency"] = UNCHANGED  # else Pillow takes it for a colour and leaves out changes to that
    changes.paste(shown, mask=ImageChops.difference(drawn, shown).point([0] + [255] * 255))
    return changes
