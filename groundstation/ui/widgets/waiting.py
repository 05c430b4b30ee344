"""What is shown while there is no vehicle: what is waited for, where, and what may help."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot import Snapshot
from groundstation.ui.colours import BLUE, DIM, GREEN, RED, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

_SPINNER = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"


class WaitingPage(Instrument[Snapshot]):
    """A page in the middle of the console."""

    BORDER_TITLE = "mavhelm"

    def __init__(self, simulator_key: str, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(Snapshot(), id=id)
        self._simulator_key = simulator_key

    def draw(self, width: int, height: int) -> list[Strip]:
        """Lines in the middle, all from one left edge."""
        lines = [line for line in self._lines() if length(line) <= width] if width else []
        left = max(0, (width - max(map(length, lines), default=0)) // 2)
        blank = strip((" " * width, style()))
        return [blank] * max(0, (height - len(lines)) // 2) + [strip((" " * left, style()), *line) for line in lines]

    def _lines(self) -> list[list[Part]]:
        snapshot = self.value
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
                (self._simulator_key, key),
                (" starts a simulated rover.", style(TEXT)),
            ],
            [],
            [("  A real vehicle is told to send here, for ours with", style(DIM))],
            [("    vehicle udpout:<address of this computer>:14550", style(TEXT))],
        ]
