"""Page without a vehicle: what the station waits for, where, and what to try."""

from __future__ import annotations

from dataclasses import dataclass

from textual.strip import Strip

from groundstation.snapshot import Snapshot
from groundstation.ui.colours import BLUE, DIM, GREEN, RED, TEXT, WHITE, YELLOW, style
from groundstation.ui.display_state import DisplayState
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

_NO_SNAPSHOT = Snapshot()
_SPINNER = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"


@dataclass(frozen=True, slots=True)
class WaitingValue:
    """What the page shows; empty once there is a vehicle, so that the hidden page costs nothing."""

    snapshot: Snapshot = _NO_SNAPSHOT
    simulator_key: str = "?"

    @classmethod
    def from_state(cls, now: DisplayState) -> WaitingValue:
        """Return the page of a display state."""
        return cls() if now.snapshot.vehicle is not None else cls(now.snapshot, now.key("app.simulator"))


class WaitingPage(Instrument[WaitingValue]):
    """A page in the middle of the console."""

    BORDER_TITLE = "mavhelm"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines in the middle, all from one left edge."""
        lines = [line for line in self._lines() if length(line) <= width] if width else []
        left = max(0, (width - max(map(length, lines), default=0)) // 2)
        blank = strip((" " * width, style()))
        return [blank] * max(0, (height - len(lines)) // 2) + [strip((" " * left, style()), *line) for line in lines]

    def _lines(self) -> list[list[Part]]:
        snapshot = self.value.snapshot
        turn = _SPINNER[int(snapshot.uptime * 4) % len(_SPINNER)]
        lines: list[list[Part]] = [
            [("  m a v h e l m", style(BLUE, bold=True)), ("   the helm of a MAVLink vehicle", style(DIM))],
            [],
            [
                (f"{turn} ", style(BLUE, bold=True)),
                (snapshot.waiting or "waiting for a vehicle", style(WHITE, bold=True)),
            ],
        ]
        lines += [
            [("  ", style()), (f"{link.name}: {link.problem}", style(RED))] for link in snapshot.links if link.problem
        ]
        lines.append([])
        state = snapshot.simulator
        if state:
            lines.append([("  simulator: ", style(DIM)), (state, style(RED if "ended" in state else GREEN))])
        return lines if state and "ended" not in state else lines + self._offer()

    def _offer(self) -> list[list[Part]]:
        key = style(YELLOW, bold=True)
        return [
            [
                ("  ENTER", key),
                (" or ", style(DIM)),
                (self.value.simulator_key, key),
                (" starts a simulated rover.", style(TEXT)),
            ],
            [],
            [("  A real vehicle must send to this computer. With the mavhelm daemon:", style(DIM))],
            [("    vehicle udpout:<address of this computer>:14550", style(TEXT))],
        ]
