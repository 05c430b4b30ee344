"""The keys worth knowing, from the table of actions."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.keymap import ACTIONS, Keymap
from groundstation.ui.colours import DIM, PANEL, RED, TEXT, YELLOW, style
from groundstation.ui.keynames import key_name
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

SHOWN = (
    "drive.stop", "stop.emergency", "vehicle.arm", "drive.style", "speed.faster", "speed.slower", "app.help",
    "app.quit", "vehicle.manual", "vehicle.hold", "vehicle.control",
)  # fmt: skip
"""Ids in order of importance: those that find no room are left out. The rest is on the help screen."""


class KeyFooter(Instrument[bool]):
    """One line; the value says whether the vehicle is armed, because one key then means another thing."""

    def __init__(self, keymap: Keymap, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(False, id=id)
        self._keymap = keymap

    def draw(self, width: int, height: int) -> list[Strip]:
        """Keys in yellow, those that stop in red."""
        parts: list[Part] = []
        tail = [("│ ", style(DIM, PANEL)), ("^p", style(YELLOW, PANEL, bold=True)), (" All ", style(TEXT, PANEL))]
        for action_id in SHOWN:
            item = self._item(action_id)
            if item and length(parts) + length(item) + length(tail) <= width:
                parts += item
        gap = max(0, width - length(parts) - length(tail))
        return [strip(*parts, (" " * gap, style(TEXT, PANEL)), *tail).crop(0, width)]

    def _item(self, action_id: str) -> list[Part]:
        keys = self._keymap.keys(action_id)
        if not keys:
            return []
        action = ACTIONS[action_id]
        key = "space" if "space" in keys else keys[0]
        label = "Disarm" if self.value and action.when_armed is not None else action.label
        label = "E-STOP" if action_id == "stop.emergency" else label
        colour = RED if action.group == "stop" else YELLOW
        return [(f" {key_name(key)}", style(colour, PANEL, bold=True)), (f" {label} ", style(TEXT, PANEL))]
