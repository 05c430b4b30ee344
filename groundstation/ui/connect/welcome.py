"""Head of the Connect screen: a helm, what the station does now, and how to begin."""

from __future__ import annotations

import math

import msgspec
from textual.strip import Strip

from groundstation.ui.look.colours import BLUE, DIM, GREEN, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, Part, strip

HELM_WIDTH, HELM_HEIGHT = 28, 13
SPOKES = 8
MAX_ADDRESSES = 3
"""Addresses that are shown: of a wired and a wireless network, and one more."""
NO_ADDRESS = "ADDRESS"
"""In commands while this machine has none."""
WSL_STEPS = "UDP: networkingMode=mirrored; USB: usbipd; docs/windows.md"
_SPINNER = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"


class WelcomeValue(msgspec.Struct, frozen=True):
    """What the station does. `turn` counts quarter seconds."""

    state: str = ""
    """In one line, e.g. "listening on 127.0.0.1:14550"."""
    heard: int = 0
    turn: int = 0
    endpoints: tuple[str, ...] = ()
    addresses: tuple[str, ...] = ()
    """Of this machine; a vehicle sends to one of them."""
    wsl: bool = False
    """This machine is in Windows, where UDP and serial ports need a step before."""


class Welcome(Instrument[WelcomeValue]):
    """In one line where there is little room, else beside a helm."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw what fits."""
        spinner: Part = (f" {_SPINNER[self.value.turn % len(_SPINNER)]} ", style(BLUE, bold=True))
        state: Part = (self.value.state, style(WHITE, bold=True))
        if height < HELM_HEIGHT:
            return [strip(spinner, state).crop(0, width)] * min(1, height)
        texts = self._texts([spinner, state])
        top = max(0, (HELM_HEIGHT - len(texts)) // 2)
        lines = [[], *[[] for _ in range(top)], *texts]
        lines += [[] for _ in range(HELM_HEIGHT - len(lines))]
        helm = draw_helm()
        blank = strip((" " * 5, style()))
        return [
            Strip.join([blank, picture, strip(("   ", style()), *line)])
            for picture, line in zip(helm, lines, strict=False)
        ]

    def _texts(self, state: list[Part]) -> list[list[Part]]:
        value = self.value
        count = f"{value.heard} vehicle{'' if value.heard == 1 else 's'}"
        address = value.addresses[0] if value.addresses else NO_ADDRESS
        here = "  ".join(value.addresses[:MAX_ADDRESSES]) or "no address yet: connect it to the network of the vehicle"
        return [
            [("   m a v h e l m", style(BLUE, bold=True)), ("   the helm of a MAVLink vehicle", style(DIM))],
            [],
            state,
            [("   heard now: ", style(DIM)), (count, style(GREEN if value.heard else DIM, bold=True))],
            [],
            _advice("this machine", here),
            _advice("on a rover of ours", f"mavhelm vehicle --config rover.toml udpout:{address}:14550"),
            _advice("on ArduPilot or PX4", f"send to {address}:14550; a radio shows below"),
            _advice("let the network in", "udpin:0.0.0.0:14550"),
            *([_advice("in WSL, before that", WSL_STEPS)] if value.wsl else []),
            _advice("from any shell", "mavhelm --help"),
        ]


def _advice(where: str, what: str) -> list[Part]:
    return [(f"   {where:<21}", style(DIM)), (what, style(TEXT))]


def draw_helm() -> tuple[Strip, ...]:
    """Return the picture of a helm, in braille dots."""
    canvas = Canvas(HELM_WIDTH, HELM_HEIGHT)
    middle = (canvas.across / 2, canvas.down / 2)
    rim, hub = style(BLUE), style(YELLOW)
    for spoke in range(SPOKES):
        angle = spoke * 2 * math.pi / SPOKES
        for shift in (-0.6, 0.6):
            start, end = (_point(middle, angle, radius, shift) for radius in (6.0, 25.0))
            canvas.line(start, end, rim)
    for radius, look in ((15.0, rim), (18.0, rim), (5.0, hub)):
        canvas.path([_point(middle, step * math.pi / 36, radius) for step in range(73)], look)
    return tuple(canvas.strips())


def _point(middle: tuple[float, float], angle: float, radius: float, shift: float = 0.0) -> tuple[float, float]:
    across, down = math.cos(angle), math.sin(angle)
    return middle[0] + radius * across - shift * down, middle[1] + radius * down + shift * across
