"""Lines that Textual has drawn: freed with the widget that drew them, and without a garbage collection."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from textual._styles_cache import StylesCache
from textual.strip import Strip

_divide = Strip.divide


def free_with_widget() -> None:
    """Mend two caches of Textual 8.2.8 for this process.

    The colours of a widget's ground are cached in an `lru_cache` of 1024 rows around a method of StylesCache, which has
    the lines of one widget. So these rows kept the lines of 1024 widgets that were gone: after 90 changes of the screen
    630,000 objects. https://github.com/Textualize/textual/issues/6665

    A line that is divided at its end is a part of itself, and is in its own cache: only a garbage collection freed it.
    """
    method = vars(StylesCache)["get_inner_outer"]
    if not isinstance(method, classmethod):  # its first argument is named `cls`, and it uses none
        StylesCache.get_inner_outer = classmethod(method)  # type: ignore[assignment, method-assign]
    Strip.divide = _divide_uncached_whole  # type: ignore[assignment, method-assign]


def _divide_uncached_whole(line: Strip, cuts: Iterable[int]) -> Sequence[Strip]:
    inside = [cut for cut in cuts if cut <= line.cell_length]
    return [line] if inside == [line.cell_length] else _divide(line, inside)
