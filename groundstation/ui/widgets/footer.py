"""The keys worth knowing, from the table of actions."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.intents import ACTIONS
from groundstation.ui.colours import DIM, PANEL, RED, TEXT, YELLOW, style
from groundstation.ui.keynames import format_key, main_key
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

FOOTER_ITEMS: tuple[tuple[str | None, tuple[str, ...]], ...] = (
    (None, ("drive.stop",)),
    ("E-STOP", ("stop.emergency",)),
    (None, ("vehicle.arm",)),
    ("Speed", ("speed.faster", "speed.slower")),
    (None, ("drive.style",)),
    (None, ("app.help",)),
    (None, ("app.quit",)),
    (None, ("vehicle.manual",)),
    (None, ("vehicle.hold",)),
    (None, ("vehicle.control",)),
)
"""A word where the action's own is too long, and the ids. The most important first: the last ones may find no room."""


class KeyFooter(Instrument[bool]):
    """One line; the value says whether the vehicle is armed, because one key then means another thing."""

    def __init__(self, keymap: Keymap, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(False, id=id)
        self._keymap = keymap

    def draw(self, width: int, height: int) -> list[Strip]:
        """Keys in yellow, those that stop in red."""
        parts: list[Part] = []
        tail = [("│ ", style(DIM, PANEL)), ("^p", style(YELLOW, PANEL, bold=True)), (" All ", style(TEXT, PANEL))]
        for label, ids in FOOTER_ITEMS:
            item = self._item(label, ids)
            if item and length(parts) + length(item) + length(tail) <= width:
                parts += item
        gap = max(0, width - length(parts) - length(tail))
        return [strip(*parts, (" " * gap, style(TEXT, PANEL)), *tail).crop(0, width)]

    def _item(self, label: str | None, ids: tuple[str, ...]) -> list[Part]:
        keys = [self._key(action_id) for action_id in ids]
        if None in keys:
            return []
        action = ACTIONS[ids[0]]
        word = label or ("Disarm" if self.value and action.when_armed is not None else action.label)
        colour = RED if action.group == "stop" else YELLOW
        return [
            (f" {' '.join(filter(None, keys))}", style(colour, PANEL, bold=True)),
            (f" {word} ", style(TEXT, PANEL)),
        ]

    def _key(self, action_id: str) -> str | None:
        keys = self._keymap.get_keys(action_id)
        key = "space" if "space" in keys else main_key(self._keymap, action_id)
        return None if key is None else format_key(key)
