"""Key caps: the drive keys, lit while held, and beside them how the keys drive now."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.intents.driving import PAD, DriveKeyDown, Stop
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.keys.keynames import format_key, main_key
from groundstation.ui.look.colours import AMBER, DEEP_RED, DIM, FAINT, GREEN, MUTED, RED, TEXT, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

GRID = (
    ("drive.forward_left", "drive.forward", "drive.forward_right"),
    ("drive.left", "drive.stop", "drive.right"),
    ("drive.backward_left", "drive.backward", "drive.backward_right"),
)
"""Actions by position, as on the keyboard around `k`."""

FLIGHT_GRID = (
    ("drive.side_left", "drive.forward", "drive.side_right", "drive.climb"),
    ("drive.left", "drive.stop", "drive.right", "drive.descend"),
    ("vehicle.take_off", "drive.backward", "vehicle.land", "vehicle.home"),
)
"""The same of what flies: left and right turn the nose, the fourth column climbs, the last row begins and ends it."""

STYLES: dict[str, tuple[str, Callable[[], Style]]] = {
    "hold": ("HOLD to drive", partial(style, GREEN, bold=True)),
    "latch": (" LATCHED: drives on ", partial(badge, RED)),
    "step": (" STEP: keeps driving ", partial(badge, AMBER)),
}
"""Drive style -> its label and look; the styles that keep driving without a key held are in loud colours."""


OBSTACLE = "obstacle"
"""Reason of a limit that has a distance and a direction."""
NEAR = 5.0
"""m within which an obstacle is shown."""
ARROWS = ("↑", "↗", "→", "↘", "↓", "↙", "←", "↖")
SIDES = ("F", "FR", "R", "BR", "B", "BL", "L", "FL")
"""Where an obstacle is, from the front to the right; the second in ASCII, which has no such arrows."""

_SIGNS = {"space": "␣", "pageup": "⇞", "pagedown": "⇟"}
"""Key -> its one character."""


class KeycapsValue(msgspec.Struct, frozen=True):
    """The lit actions, and the operator's settings rounded to what can be seen to change."""

    keymap: Keymap
    lit: frozenset[str] = frozenset()
    style: str = "hold"
    reports_releases: bool = False
    promises_releases: bool = False
    """The terminal says that it reports them; until the first one the timer ends a drive."""
    stop_bound: float = 0.0
    throttle_limit: int = 100
    steering_limit: int = 100
    open: bool = False
    ignored: bool = False
    """The key that is held does not count."""
    gamepad: bool = False
    """The gamepad drives."""
    slowed: tuple[float, str] | None = None
    """m/s that the vehicle allows itself, and why."""
    nearest: str = ""
    """Distance and direction of the nearest obstacle, if it is near."""
    overrides: bool = False
    """The key is held that overrides the limits before obstacles."""
    flies: bool = False
    full: tuple[float | None, float | None, float | None] = (None, None, None)
    """What full deflection asks for, of what flies: m/s, deg/s, m/s up."""
    take_off: float | None = None
    """m to which its key takes off now; None: it is in the air, or not armed."""
    recorded: tuple[str, ...] | None = None
    """In a replay the keys that were held; None: no replay."""

    @classmethod
    def from_state(cls, now: DisplayState) -> KeycapsValue:
        """Return the caps of a display state."""
        operator, vehicle = now.snapshot.operator, now.snapshot.vehicle
        flies = vehicle is not None and vehicle.flies
        return cls(
            flies=flies,
            full=(vehicle.full_speed, vehicle.full_turn, vehicle.full_climb) if vehicle and flies else (None,) * 3,
            take_off=vehicle.take_off if vehicle and vehicle.armed and not vehicle.may_fall else None,
            keymap=now.keymap,
            lit=lit_actions(frozenset(operator.held) | now.pressed, now.keymap),
            style=operator.style,
            reports_releases=operator.reports_releases,
            promises_releases=now.promises_releases,
            stop_bound=round(operator.stop_bound, 2),
            throttle_limit=round(100 * operator.throttle_limit),
            steering_limit=round(100 * operator.steering_limit),
            open=operator.gate_open,
            ignored=bool(operator.ignored),
            gamepad=PAD in operator.held,
            slowed=vehicle.slowed if vehicle is not None and vehicle.armed else None,
            nearest="" if vehicle is None else nearest_text(vehicle.nearest, ascii=now.ascii),
            overrides=operator.overrides,
            recorded=None if now.snapshot.replay is None else operator.held,
        )


def lit_actions(keys: frozenset[str], keymap: Keymap) -> frozenset[str]:
    """Return the actions whose caps to light: an arrow key lights the cap of its direction, too."""
    actions = (keymap.get_action(key) for key in keys)
    return frozenset(action.id for action in actions if action and isinstance(action.intent, (DriveKeyDown, Stop)))


class Keycaps(Instrument[KeycapsValue]):
    """Three rows of caps, with a line of text beside each."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw caps to the left and text to the right; what does not fit is cut, never wrapped."""
        lines = []
        for row, text in zip(FLIGHT_GRID if self.value.flies else GRID, self._texts(), strict=True):
            caps = [part for action in row for part in self._cap(action)]
            gap = max(1, width - length(caps) - length(text))
            lines.append(strip(*caps, (" " * gap, style()), *text).crop(0, width))
        return lines[:height]

    def _cap(self, action: str) -> list[Part]:
        key = main_key(self.value.keymap, action)
        name = "·" if key is None else _SIGNS.get(key) or format_key(key)
        if action in self.value.lit:
            look = badge(DEEP_RED if action == "drive.stop" else AMBER if self.value.ignored else YELLOW)
        elif not self.value.open:
            look = style(MUTED, FAINT)
        else:
            look = style(RED if action == "drive.stop" else TEXT, FAINT, bold=True)
        return [(f" {name[:1]} ", look), (" ", style())]

    def _texts(self) -> tuple[list[Part], list[Part], list[Part]]:
        value = self.value
        if value.recorded is not None:
            keys = " ".join(map(format_key, value.recorded))
            held: Part = (keys, style(YELLOW, bold=True)) if keys else ("none", style(DIM))
            return [("keys of the log", style(DIM))], [("held ", style(DIM)), held], []
        return (
            style_parts(value),
            bound_parts(value),
            flight_limit_parts(value) if value.flies else limit_parts(value),
        )


def limit_parts(value: KeycapsValue) -> list[Part]:
    """Return the limits of the keys; while the vehicle limits itself further, its limit and the reason."""
    if value.slowed is not None:
        speed, reason = value.slowed
        where = f" {value.nearest}" if value.nearest and reason == OBSTACLE and not value.overrides else ""
        first = ("OVERRIDE ", style(RED, bold=True)) if value.overrides else ("≤" if where else "at most ", style(DIM))
        return [first, (f"{speed:.1f} m/s", style(AMBER, bold=True)), (f": {reason}{where}", style(AMBER))]
    if value.nearest:
        return [
            (value.nearest, style(TEXT)),
            (" limits ", style(DIM)), (f"{value.throttle_limit}%", style(TEXT)),
            (" turn ", style(DIM)), (f"{value.steering_limit}%", style(TEXT)),
        ]  # fmt: skip
    return [
        ("limits: speed ", style(DIM)), (f"{value.throttle_limit}%", style(TEXT)),
        (" turn ", style(DIM)), (f"{value.steering_limit}%", style(TEXT)),
    ]  # fmt: skip


def nearest_text(nearest: tuple[float, float] | None, *, ascii: bool = False) -> str:  # noqa: A002
    """Return distance and direction of an obstacle, "0.6 m ↗"; "" if it is far, or there is none."""
    if nearest is None or not all(map(math.isfinite, nearest)) or nearest[1] > NEAR:
        return ""
    bearing, distance = nearest
    return f"{distance:.1f} m {(SIDES if ascii else ARROWS)[round(bearing / (math.tau / 8)) % 8]}"


def flight_limit_parts(value: KeycapsValue) -> list[Part]:
    """Return how high its key takes off, and in the air what the keys ask for at most.

    That is in its units where they are known, else in percent.
    """
    if value.take_off is not None:
        key = main_key(value.keymap, "vehicle.take_off")
        return [(f"{key} takes off to ", style(DIM)), (f"{value.take_off:g} m", style(TEXT))]
    speed, turn, climb = value.full
    share, turning = value.throttle_limit / 100, value.steering_limit / 100
    texts = (
        f"{value.throttle_limit}%" if speed is None else f"{speed * share:.1f} m/s",
        f"{value.steering_limit}%" if turn is None else f"{turn * turning:.0f}°/s",
        "" if climb is None else f" up {climb * share:.1f}",
    )
    return [("≤", style(DIM)), (" ".join(texts[:2]) + texts[2], style(TEXT))]


def style_parts(value: KeycapsValue) -> list[Part]:
    """Return the drive style and the key that changes it, or that the gamepad drives."""
    if value.gamepad:
        return [("GAMEPAD drives", style(GREEN, bold=True))]
    keys = value.keymap.get_keys("drive.style")
    text, look = STYLES.get(value.style, (value.style, style))
    label = (text, look())
    return [(f"{format_key(keys[0])} ", style(DIM)), label] if keys else [label]


def bound_parts(value: KeycapsValue) -> list[Part]:
    """Return what ends a drive, and how soon: without key releases only a timer can."""
    if value.gamepad:
        return [("stops when you let go", style(DIM))]
    if not math.isfinite(value.stop_bound):
        return [("only a key stops it", style(AMBER))]
    if value.reports_releases:
        return [("stops when you let go", style(DIM))]
    bound = (f"{value.stop_bound:.2f} s", style(TEXT))
    if value.promises_releases:
        return [("timer ", style(DIM)), bound, (" till a release", style(DIM))]
    return [("timer: within " if value.flies else "timer: stops within ", style(DIM)), bound]
