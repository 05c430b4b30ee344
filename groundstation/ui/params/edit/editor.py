"""The value of a parameter while it is typed: a number, the name of a value, or bits. Knows no widget."""

from __future__ import annotations

from groundstation.ui.params.edit.checks import matching, parse_number
from groundstation.views.params import ParamInfo, ParamRow
from link.services.param.float32 import value_text


class ValueEditor:
    """Edits one parameter. `text` is what the text field shows; `info` may arrive later."""

    def __init__(self, row: ParamRow, value: float, info: ParamInfo | None) -> None:
        self.row = row
        self.info = info
        self.text = value_text(value)
        self.cursor = 0
        """Row of the list of values, or of the bits."""
        self._place_cursor()

    def set_info(self, info: ParamInfo) -> None:
        """Store the texts of the parameter."""
        if info != self.info:
            self.info = info
            self._place_cursor()

    def type(self, text: str) -> None:
        """Handle the text of the field."""
        self.text = text
        self._place_cursor()

    @property
    def choices(self) -> list[tuple[float, str]]:
        """The values that the list shows: all, or those that match a typed name."""
        values = self.info.values if self.info else ()
        return list(values) if self._number is not None else matching(values, self.text)

    @property
    def bits(self) -> tuple[tuple[int, str], ...]:
        """The bits, where the parameter has some and no list of values."""
        return self.info.bits if self.info and not self.info.values else ()

    @property
    def advice(self) -> str:
        """Which keys do what."""
        if self.bits:
            return "↑ ↓ choose a bit, TAB toggles it, or type a number · ENTER keeps it, ESC leaves it"
        if self.info and self.info.values:
            return "↑ ↓ choose, letters find a name, or type a number · ENTER keeps it, ESC leaves it"
        return "type a number, 0x for a hexadecimal one · ENTER keeps it, ESC leaves it"

    def move(self, rows: int) -> None:
        """Move in the list; a value of the list becomes the text at once, unless a name is being typed."""
        last = len(self.bits or self.choices) - 1
        self.cursor = max(0, min(last, self.cursor + rows))
        if not self.bits and last >= 0 and self._number is not None:
            self.text = value_text(self.choices[self.cursor][0])

    def toggle(self) -> None:
        """Toggle the bit at the cursor."""
        number = self._number
        if self.bits and number is not None and number.is_integer():
            self.text = value_text(float(int(number) ^ 1 << self.bits[self.cursor][0]))

    @property
    def value(self) -> float | None:
        """The value as it would be kept now; None: the text is none."""
        found = self.result()
        return None if isinstance(found, str) else found

    def result(self) -> float | str:
        """Return the value, or what is wrong with the text."""
        text = self.text.strip()
        if self._number is None and text and self.choices:
            return self.choices[self.cursor][0]
        found = parse_number(text, self.row.name, self.row.kind)
        if isinstance(found, str) and self._number is None and self.info and self.info.values:
            return f"{text!r} is neither a number nor a name of its list"
        return found

    @property
    def _number(self) -> float | None:
        try:
            text = self.text.strip()
            return float(int(text, 16)) if text.lower().startswith(("0x", "-0x")) else float(text)
        except (ValueError, OverflowError):
            return None

    def _place_cursor(self) -> None:
        """Put the cursor on the value that is typed, and keep it inside the list."""
        if self.bits:
            self.cursor = min(self.cursor, len(self.bits) - 1)
            return
        number, choices = self._number, self.choices
        at = next((row for row, (value, _) in enumerate(choices) if value == number), None)
        self.cursor = at if at is not None else max(0, min(self.cursor, len(choices) - 1))
