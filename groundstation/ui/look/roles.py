"""Role: what a colour means. Widgets name roles; themes.py has the colour of each role in each theme."""

from __future__ import annotations

from enum import StrEnum


class Role(StrEnum):
    """A role. Its text is a variable of Textual: `$line` in .tcss files, "bold $key" in the style of a text."""

    BACKGROUND = "$background"
    PANEL = "$panel"
    """Background of the footer, of bars and of fields."""
    SELECTED = "$selected"
    """Background of the selected row, of key caps and of quiet badges; also what is empty in a bar."""
    NOTE = "$note"
    """Background of a warning."""
    DANGER = "$danger"
    """Background of what must not be overlooked: armed, an alert, a stop key that is held."""
    LINE = "$line"
    """Borders and rings: no text."""
    TEXT = "$ink"
    STRONG = "$strong"
    """Text that stands out."""
    DIM = "$dim"
    """Names, units, notes, and values that are old."""
    MUTED = "$muted"
    """DIM on SELECTED."""
    INFO = "$info"
    """Titles, sources, and what is neither good nor bad."""
    KEY = "$key"
    """Keys, and what asks for an answer."""
    GOOD = "$good"
    CAUTION = "$caution"
    BAD = "$bad"
    REPLAY = "$replay"
    """What is shown is a log."""
    ON_BADGE = "$on-badge"
    """Text on INFO, KEY, GOOD, CAUTION, BAD or REPLAY as a background."""
    ON_DANGER = "$on-danger"
    ON_SELECTED = "$on-selected"
    """Text on SELECTED where there are 16 colours."""
    SKY = "$sky"
    EARTH = "$earth"

    @property
    def variable(self) -> str:
        """Name of the variable, without $."""
        return self.value.removeprefix("$")
