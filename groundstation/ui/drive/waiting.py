"""Page without a vehicle: what the station waits for, what has arrived, and what to try."""

from __future__ import annotations

import textwrap

import msgspec
from textual.strip import Strip

from groundstation.snapshot import Snapshot
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.waiting_advice import AdviceKind, WaitingAdvice, advise, describe_link
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

_NO_SNAPSHOT = Snapshot()
_SPINNER = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"
TURNS = 4
"""Turns of the spinner per second: in between the page is the same."""
STILL = "·"
"""In place of the spinner."""
_COLOURS = {AdviceKind.TEXT: DIM, AdviceKind.WARNING: AMBER}


class WaitingValue(msgspec.Struct, frozen=True):
    """What the page shows; empty once there is a vehicle, so that the hidden page costs nothing."""

    snapshot: Snapshot = _NO_SNAPSHOT
    simulator_key: str = "?"
    quit_key: str = "?"
    still: bool = False
    """The spinner does not turn."""
    connect_keys: str = "?"
    """Of the Connect screen, in the go-to menu."""

    @classmethod
    def from_state(cls, now: DisplayState) -> WaitingValue:
        """Return the page of a display state."""
        if now.snapshot.vehicle is not None:
            return cls()
        snapshot = msgspec.structs.replace(now.snapshot, number=0, uptime=int(now.snapshot.uptime * TURNS) / TURNS)
        return cls(snapshot, now.key("app.simulator"), now.key("app.quit"), now.still, f"{now.key('app.goto')} c")


class WaitingPage(Instrument[WaitingValue]):
    """A page in the middle of the console."""

    BORDER_TITLE = "mavhelm"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines in the middle, all from one left edge."""
        lines = self._lines(width) if width else []
        left = max(0, (width - max(map(length, lines), default=0)) // 2)
        blank = strip((" " * width, style()))
        drawn = [strip((" " * left, style()), *line).crop(0, width) for line in lines]
        return [blank] * max(0, (height - len(lines)) // 2) + drawn

    def _lines(self, width: int) -> list[list[Part]]:
        snapshot = self.value.snapshot
        turn = STILL if self.value.still else _SPINNER[int(snapshot.uptime * TURNS) % len(_SPINNER)]
        lines: list[list[Part]] = [
            [("  m a v h e l m", style(BLUE, bold=True)), ("   the helm of a MAVLink vehicle", style(DIM))],
            [],
            [
                (f"{turn} ", style(BLUE, bold=True)),
                (snapshot.waiting or "waiting for a vehicle", style(WHITE, bold=True)),
            ],
        ]
        for link in snapshot.links:
            if link.problem:
                lines += _wrapped(f"{link.name}: {link.problem}", RED, width)
            else:
                lines += _advice(describe_link(link), width)
        lines.append([])
        state = snapshot.simulator
        if state:
            lines.append([("  simulator: ", style(DIM)), (state, style(RED if "ended" in state else GREEN))])
        return lines if state and "ended" not in state else lines + self._offer(width)

    def _offer(self, width: int) -> list[list[Part]]:
        advice = advise(self.value.snapshot, self.value.quit_key)
        return [self._simulator(), [], *(line for each in advice for line in _advice(each, width))]

    def _simulator(self) -> list[Part]:
        """Return how to start a simulated rover, and where to connect to another vehicle."""
        key = style(YELLOW, bold=True)
        own = self.value.simulator_key  # "?": no key map file has bound one
        keys: list[Part] = [("  ENTER", key), *([(" or ", style(DIM)), (own, key)] if own != "?" else [])]
        connect: list[Part] = [(self.value.connect_keys, key), (" connects to another vehicle.", style(TEXT))]
        return [*keys, (" starts a simulated rover, ", style(TEXT)), *connect]


def _advice(advice: WaitingAdvice, width: int) -> list[list[Part]]:
    """Return the lines of one advice; a command stays in one."""
    if advice.kind is AdviceKind.COMMAND:
        return [[(f"    {advice.text}", style(TEXT, bold=True))]]
    return _wrapped(advice.text, _COLOURS[advice.kind], width)


def _wrapped(text: str, colour: str, width: int) -> list[list[Part]]:
    parts = textwrap.wrap(text, max(20, width - 2), subsequent_indent="  ", break_on_hyphens=False)
    return [[(f"  {part}", style(colour))] for part in parts]
