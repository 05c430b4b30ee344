"""No colours at all (https://no-color.org): takes them out of all that is drawn, also by Textual's own widgets."""

from __future__ import annotations

from functools import lru_cache

from rich.color import Color as RichColor
from rich.segment import Segment
from rich.style import Style
from textual.color import Color
from textual.filter import LineFilter


class NoColourFilter(LineFilter):
    """Applies to every line that any widget draws. Dark text on a light ground becomes reverse video."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments without colours."""
        return [Segment(text, style and _without_colours(style), control) for text, style, control in segments]


@lru_cache(4096)
def _without_colours(style: Style) -> Style:
    swapped = style.color is not None and style.bgcolor is not None and _light(style.bgcolor) > _light(style.color)
    return Style(
        bold=style.bold,
        italic=style.italic,
        underline=style.underline,
        strike=style.strike,
        reverse=bool(style.reverse) != swapped,
        meta=style.meta or None,
    )


def _light(colour: RichColor) -> float:
    return sum(colour.get_truecolor())
