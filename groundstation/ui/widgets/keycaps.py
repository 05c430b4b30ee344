"""The drive keys as caps that light up while held, and beside them how the keys drive now."""

from __future__ import annotations

import math
from dataclasses import dataclass

from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.intents import DriveKeyDown, Stop
from groundstation.snapshot import OperatorView
from groundstation.ui.colours import AMBER, DEEP_RED, DIM, FAINT, GREEN, RED, TEXT, YELLOW, badge, style
from groundstation.ui.keynames import format_key, main_key
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

GRID = (
    ("drive.forward_left", "drive.forward", "drive.forward_right"),
    ("drive.left", "drive.stop", "drive.right"),
    ("drive.backward_left", "drive.backward", "drive.backward_right"),
)
"""Actions in their places, as on the keyboard around `k`."""

STYLES = {
    "hold": ("HOLD to drive", style(GREEN, bold=True)),
    "latch": (" LATCHED: drives on ", badge(RED)),
    "step": (" STEP: keeps its speed ", badge(AMBER)),
}
"""Drive style -> how it is named; the styles that drive on without a hand are loud."""


@dataclass(frozen=True, slots=True)
class KeycapsValue:
    """The lit actions, and the helm's settings in figures that can be seen to change."""

    lit: frozenset[str] = frozenset()
    style: str = "hold"
    reports_releases: bool = False
    stop_bound: float = 0.0
    throttle_limit: int = 100
    steering_limit: int = 100
    open: bool = False

    @classmethod
    def from_operator(cls, helm: OperatorView, pressed: frozenset[str], keymap: Keymap) -> KeycapsValue:
        """`pressed` are the keys that the screen saw go down, sooner than a snapshot can tell."""
        return cls(
            lit=lit_actions(frozenset(helm.held) | pressed, keymap),
            style=helm.style,
            reports_releases=helm.reports_releases,
            stop_bound=round(helm.stop_bound, 2),
            throttle_limit=round(100 * helm.throttle_limit),
            steering_limit=round(100 * helm.steering_limit),
            open=helm.gate_open,
        )


def lit_actions(keys: frozenset[str], keymap: Keymap) -> frozenset[str]:
    """The caps to light: an arrow lights the cap of its direction too, whatever letter is printed on it."""
    actions = (keymap.get_action(key) for key in keys)
    return frozenset(action.id for action in actions if action and isinstance(action.intent, (DriveKeyDown, Stop)))


class Keycaps(Instrument[KeycapsValue]):
    """Three rows of caps with three lines of text."""

    def __init__(self, keymap: Keymap, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(KeycapsValue(), id=id)
        self._keymap = keymap

    def draw(self, width: int, height: int) -> list[Strip]:
        """The text goes to the right end; what has no room is cut, never wrapped."""
        lines = []
        for row, words in zip(GRID, self._words(), strict=True):
            caps = [part for action in row for part in self._cap(action)]
            gap = max(1, width - length(caps) - length(words))
            lines.append(strip(*caps, (" " * gap, style()), *words).crop(0, width))
        return lines[:height]

    def _cap(self, action: str) -> list[Part]:
        key = main_key(self._keymap, action)
        name = "·" if key is None else "␣" if key == "space" else format_key(key)
        if action in self.value.lit:
            look = badge(DEEP_RED) if action == "drive.stop" else badge(YELLOW)
        elif not self.value.open:
            look = style(DIM, FAINT)
        else:
            look = style(RED if action == "drive.stop" else TEXT, FAINT, bold=True)
        return [(f" {name[:1]} ", look), (" ", style())]

    def _words(self) -> tuple[list[Part], list[Part], list[Part]]:
        value = self.value
        return (
            [STYLES.get(value.style, (value.style, style(TEXT)))],
            self._bound(),
            [
                ("limits ", style(DIM)), (f"{value.throttle_limit}%", style(TEXT)),
                (" turn ", style(DIM)), (f"{value.steering_limit}%", style(TEXT)),
            ],
        )  # fmt: skip

    def _bound(self) -> list[Part]:
        """What ends a drive, and how soon: without releases only a timer can tell that a key was let go."""
        value = self.value
        if not math.isfinite(value.stop_bound):
            return [("only a key stops it", style(AMBER))]
        if value.reports_releases:
            return [("stops when you let go", style(DIM))]
        return [("timer: stops within ", style(DIM)), (f"{value.stop_bound:.2f} s", style(TEXT))]
