"""FieldSearch: the choice of a field by a fuzzy name while it is typed, answered by the station."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.views.charts import FieldRow, FieldsPage

Chosen = Callable[[FieldRow, int | None], None]
"""Called with the field and the number of the chart that was typed behind its name, if any."""

ROWS = 20
"""Fields that the station lists."""


class FieldSearch:
    """What is typed, and what to do with the field that is chosen."""

    def __init__(self) -> None:
        self.text = ""
        """Name as far as it is typed, without the number of a chart."""
        self.open = False
        self.rows: tuple[FieldRow, ...] = ()
        self.matching = 0
        self.refusal: str | None = None
        """Why the last search ended without a field, until it is read."""
        self._chosen: Chosen | None = None
        self._chart: int | None = None
        self._submitted = False

    @property
    def count(self) -> int:
        """Rows wanted of the station."""
        return ROWS if self.open or self._submitted else 0

    def begin(self, chosen: Chosen) -> None:
        """Begin a search."""
        self.open, self._submitted, self._chosen = True, False, chosen
        self.rows, self.matching = (), 0
        self.type("")

    def type(self, text: str) -> None:
        """Handle the text as far as it is typed: a name, and the number of a chart behind it."""
        words = text.split()
        number = int(words[-1]) if len(words) > 1 and words[-1] in "123456" else None
        self._chart = number
        self.text = " ".join(words[:-1] if number else words)

    def submit(self, text: str) -> None:
        """Choose the first field of the list for this text, as soon as it is there."""
        self.type(text)
        self.open, self._submitted = False, True

    def cancel(self) -> None:
        """End the search without a field."""
        self.open = self._submitted = False

    def show_page(self, page: FieldsPage) -> None:
        """Choose the fields that match; choose the first of them if it was submitted."""
        if page.text != self.text or not self.count:
            return
        self.rows, self.matching = page.rows, page.matching
        if not self._submitted:
            return
        self._submitted = False
        if page.rows and self.text and self._chosen is not None:
            self._chosen(page.rows[0], self._chart)
        else:
            self.refusal = f"no field matches “{self.text}”" if self.text else None

    def pop_refusal(self) -> str | None:
        """Return why the last search found nothing, once."""
        refusal, self.refusal = self.refusal, None
        return refusal
