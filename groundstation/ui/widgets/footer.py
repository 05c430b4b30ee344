"""Footer: the most important keys, from the table of actions."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.actions import ACTIONS
from groundstation.input.keymap import Keymap
from groundstation.ui.display.display_state import DRIVE_INFO, DisplayState, ScreenInfo
from groundstation.ui.keys.keynames import format_key, is_character, main_key
from groundstation.ui.look.colours import DIM, PANEL, RED, TEXT, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

FooterItem = tuple[str | None, tuple[str, ...]]
"""A label where the action's own is too long, and the ids of actions."""

SPEED: FooterItem = ("Speed", ("speed.faster", "speed.slower"))

FOOTER_ITEMS: tuple[FooterItem, ...] = (
    (None, ("drive.stop",)),
    ("E-STOP", ("stop.emergency",)),
    (None, ("vehicle.arm",)),
    SPEED,
    (None, ("app.help",)),
    (None, ("app.quit",)),
    ("Hold/latch/step", ("drive.style",)),
    (None, ("vehicle.manual",)),
    (None, ("vehicle.hold",)),
    (None, ("view.pane",)),
)
"""The most important first: the last ones may not fit. The key that takes or releases control follows them."""

TAKE_OFF: FooterItem = ("Take off", ("vehicle.take_off",))
LAND: FooterItem = ("Land", ("vehicle.land",))
FLY_HOME: FooterItem = ("Home", ("vehicle.home",))

Item = tuple[list[Part], str]
"""A key with its label, and the key that the mouse presses there, "" for none."""

REPLAY_ACTIONS = ("app.goto", "view.pane", "vehicle.next", "app.help", "app.quit")
"""On the Drive screen while a log is shown."""


class FooterValue(msgspec.Struct, frozen=True):
    """What decides on the keys and their labels: one key disarms while armed and arms else."""

    keymap: Keymap
    armed: bool = False
    place: str = ""
    """Which of several vehicles is selected, e.g. "2/16"; "" for one alone."""
    screen: ScreenInfo = DRIVE_INFO
    replay: bool = False
    """A log is shown: keys command nothing."""
    keys_mode: str = ""
    """The mode for keys of what flies; "" for what does not fly."""
    in_air: bool = False
    in_control: bool = False
    """The vehicle obeys this screen: what is left is to release control."""

    @classmethod
    def from_state(cls, now: DisplayState) -> FooterValue:
        """Return the footer of a display state."""
        vehicle, systems = now.snapshot.vehicle, now.snapshot.vehicles
        replay = now.snapshot.replay is not None
        if vehicle is None or replay:
            return cls(now.keymap, screen=now.screen, replay=replay)
        several = len(systems) > 1 and vehicle.system in systems
        place = f"{systems.index(vehicle.system) + 1}/{len(systems)}" if several else ""
        keys_mode = vehicle.keys_mode if vehicle.flies else ""
        in_control = vehicle.in_control and not now.snapshot.lease.driver
        return cls(
            now.keymap, vehicle.armed, place, now.screen, keys_mode=keys_mode, in_air=vehicle.may_fall,
            in_control=in_control,
        )  # fmt: skip


class KeyFooter(Instrument[FooterValue]):
    """One line of keys with their actions."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw keys in yellow, stop keys in red."""
        parts = [part for item, _ in self._fitting(width) for part in item]
        tail = _tail()
        gap = max(0, width - length(parts) - length(tail))
        return [strip(*parts, (" " * gap, style(TEXT, PANEL)), *tail).crop(0, width)]

    def key_at(self, column: int) -> str:
        """Return the key at a column that the mouse may press, by Textual's name; "" for all others.

        It never presses what stops, and no key of a screen that reaches a vehicle.
        """
        begin = 0
        for item, key in self._fitting(self.size.width):
            begin += length(item)
            if column < begin:
                return key
        return ""

    def _fitting(self, width: int) -> Iterator[Item]:
        """Yield the items that have room."""
        room = width - length(_tail())
        for item, key in self._items():
            if item and length(item) <= room:
                room -= length(item)
                yield item, key

    def _items(self) -> Iterator[Item]:
        screen = self.value.screen
        if screen.drives:
            yield from ((self._item(label, ids), "") for label, ids in self._drive_items())
            return
        yield _parts(self._stop_key(), "Pause" if self.value.replay else "Stop", RED), ""
        if not self.value.replay:
            yield self._item("E-STOP", ("stop.emergency",)), ""
        if screen.text:
            yield _parts("ENTER", "Keep", YELLOW), ""
            yield _parts("ESC", "Clear", YELLOW), ""
            return
        for each in screen.keys:
            yield _parts(format_key(each.key), each.label, YELLOW), "" if each.commands else each.key
        yield _parts("ESC", "Drive", YELLOW), "escape"

    def _drive_items(self) -> list[FooterItem]:
        """Return the table; with several vehicles the key that selects the next one takes the place of the speed."""
        if self.value.replay:
            return [("Pause", ("drive.stop",)), *((None, (name,)) for name in REPLAY_ACTIONS)]
        control: FooterItem = (None, ("vehicle.release" if self.value.in_control else "vehicle.control",))
        items = [*(self._flight_items() if self.value.keys_mode else FOOTER_ITEMS), control]
        if not self.value.place:
            return items
        following: FooterItem = (f"Vehicle {self.value.place}", ("vehicle.next",))
        return [*(following if item == SPEED else item for item in items), SPEED]

    def _flight_items(self) -> list[FooterItem]:
        """Return the table with what the keys mean to a copter: in the air its emergency stop lands it."""
        in_air = self.value.in_air
        ends = (LAND, FLY_HOME) if in_air else (("Arm" if not self.value.armed else "Disarm", ("vehicle.arm",)),)
        emergency = "LAND" if in_air else "DISARM"
        return [
            ("Hover", ("drive.stop",)), (emergency, ("stop.emergency",)), *ends, *(() if in_air else (TAKE_OFF,)),
            SPEED, (None, ("app.help",)), (None, ("app.quit",)), (self.value.keys_mode, ("vehicle.manual",)),
            ("Hold", ("vehicle.hold",)), (None, ("view.pane",)),
        ]  # fmt: skip

    def _stop_key(self) -> str:
        """Return a stop key that works now: a text field takes the keys that are characters."""
        keys = self.value.keymap.get_keys("drive.stop")
        usable = [key for key in keys if not (self.value.screen.text and is_character(key))]
        return format_key("space" if "space" in usable else usable[0]) if usable else "?"

    def _item(self, label: str | None, ids: tuple[str, ...]) -> list[Part]:
        keys = [self._key(action_id) for action_id in ids]
        if None in keys:
            return []
        action = ACTIONS[ids[0]]
        text = label or ("Disarm" if self.value.armed and action.when_armed is not None else action.label)
        return _parts(" ".join(filter(None, keys)), text, RED if action.group == "stop" else YELLOW)

    def _key(self, action_id: str) -> str | None:
        keymap = self.value.keymap
        key = "space" if "space" in keymap.get_keys(action_id) else main_key(keymap, action_id)
        return None if key is None else format_key(key)


def _tail() -> list[Part]:
    return [("│ ", style(DIM, PANEL)), ("^p", style(YELLOW, PANEL, bold=True)), (" Commands ", style(TEXT, PANEL))]


def _parts(keys: str, label: str, colour: str) -> list[Part]:
    return [(f" {keys}", style(colour, PANEL, bold=True)), (f" {label} ", style(TEXT, PANEL))]
