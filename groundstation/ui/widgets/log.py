"""Log panel: the newest lines of STATUSTEXT, acknowledgements and the station's own events."""

from __future__ import annotations

import time

from textual.strip import Strip

from groundstation.snapshot import LogLine
from groundstation.ui.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, badge, style
from groundstation.ui.widgets.instrument import Instrument, Part, strip

_SEVERITIES = ("EMERG", "ALERT", "CRIT", "ERROR", "WARN", "NOTE", "INFO", "DEBUG")
_COLOURS = (RED, RED, RED, RED, AMBER, BLUE, BLUE, DIM)
_LABELS = {"ack": ("ACK", GREEN), "station": ("GCS", BLUE)}
"""Label of a line -> its name and colour below severity WARNING; STATUSTEXT lines show their severity."""


class LogPanel(Instrument[tuple[LogLine, ...]]):
    """One line per text, the newest at the bottom."""

    BORDER_TITLE = "log"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw lines cut at the right edge, never wrapped: a long text must not push others out."""
        return [strip(*_line(line)).crop(0, width) for line in self.value[-height:]]


def _line(line: LogLine) -> list[Part]:
    severity = max(0, min(7, line.severity))
    name, colour = _LABELS.get(line.label, (_SEVERITIES[severity], _COLOURS[severity]))
    if severity <= 4:
        name, colour = _SEVERITIES[severity], _COLOURS[severity]
    when = time.strftime("%H:%M:%S", time.localtime(line.time))
    parts = [(f" {when} ", style(DIM)), (f"{name:<5} ", style(colour, bold=severity <= 3))]
    # Printable only: a control character from the link must not reach the terminal.
    text = "".join(character if character.isprintable() else "�" for character in line.text)
    parts.append((text, style(TEXT if severity > 2 else RED, bold=severity <= 2)))
    if line.count > 1:
        parts += [(" ", style()), (f" ×{line.count} ", badge(DIM))]
    return parts
