"""What the Drive screen shows of the gamepad."""

from __future__ import annotations

import msgspec

from groundstation.input.pad import PadFrame
from groundstation.input.pad_mapping import BUTTONS, PadMapping

ARM = "vehicle.arm"


class PadState(msgspec.Struct, frozen=True):
    """The gamepad, as far as the screen knows it."""

    frame: PadFrame
    mapping: PadMapping
    problem: str = ""
    """Why none can drive."""
    lost: bool = False
    """There was one, and there is none now."""
    touch: bool = False
    """It is the thumb stick of a page, where what to press is written."""

    @property
    def alert(self) -> str:
        """What keeps it from driving, "" if nothing does or there never was one."""
        if self.problem:
            return f"gamepad: {self.problem}"
        if self.lost:
            return "gamepad unplugged: neutral"
        if self.frame.uncentred:
            return f"gamepad: centre its sticks while {self.mapping.deadman_name} is held, then drive"
        return ""

    def hint(self, *, armed: bool) -> str:
        """Return which button drives, or arms: short, because it follows what the keys do. "" if that is known."""
        if self.touch:
            return ("push the stick" if armed else "hold ARM") if self.frame.names else ""
        if not self.frame.names:
            return "no gamepad yet"
        arm = next((name for name, action in self.mapping.buttons.items() if action == ARM), self.mapping.deadman)
        count = len(self.frame.names)
        number = f" {self.frame.chosen + 1}/{count}" if count > 1 else ""
        return f"gamepad{number}: hold {BUTTONS[self.mapping.deadman if armed else arm]} ({self.frame.name})"
