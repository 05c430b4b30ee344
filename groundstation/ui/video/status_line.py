"""The line below the picture: source, pictures a second, age, and in reverse what is wrong with it."""

from __future__ import annotations

from rich.cells import set_cell_size

from groundstation.pictures.freshness import Freshness, PictureState
from groundstation.pictures.protocol import Protocol


def format_status(
    name: str, state: PictureState, rate: float, protocol: Protocol, level: int, problem: str, width: int
) -> str:
    """Return the line for a terminal of this width. `rate`: pictures drawn a second."""
    facts = f"{name}  {rate:.0f}/s  {protocol}{f', {level} coarser' if level else ''}"
    if state.fresh:
        text, style = f" age {state.age:.1f} s  {facts}", ""
    else:
        text, style = f" {describe(state)}  {f'{problem}  ' if problem else ''}{facts}", "\x1b[7m"
    return f"\x1b[0m{style}{set_cell_size(f'{text}  q quits', width)}\x1b[0m"


def describe(state: PictureState) -> str:
    """Return what is wrong with a picture that is not fresh."""
    if state.freshness is Freshness.NONE:
        return "NO PICTURE YET"
    return f"{'FROZEN' if state.freshness is Freshness.FROZEN else 'OLD'} {state.age:.1f} s: do not drive by it"
