"""The rows of the Messages screen: a window on the list of the station, a cursor, order and filter. Knows no widget."""

from __future__ import annotations

from groundstation.views.messages import MESSAGE_ORDERS, MessageRequest, MessageRow, MessagesPage, MessagesRequest

RowKey = tuple[int, int, bool, str]
"""System, component, sent, name of the message."""

MARGIN = 50
"""Rows requested above and below the window, so that the cursor moves at once."""


def key_of(row: MessageRow) -> RowKey:
    """Return what names a row while others come and go."""
    return row.system, row.component, row.sent, row.name


class MessagesModel:
    """The newest page, and where the cursor is."""

    def __init__(self) -> None:
        self.order = MESSAGE_ORDERS[0]
        self.text = ""
        self.page = MessagesPage((), 0, 0, 0, 0.0, 0.0)
        self.top = 0
        """Index of the first row in the window."""
        self.cursor = 0
        self.selected: RowKey | None = None
        """The row at the cursor; None until the page that has it is here."""
        self._closed: set[tuple[int, int, bool]] = set()

    # ---- requests and pages ----

    def page_request(self, height: int) -> MessagesRequest:
        """Return the request for the rows around the window."""
        first = max(0, self.top - MARGIN)
        return MessagesRequest(self.order, self.text, first, height + 2 * MARGIN, tuple(sorted(self._closed)))

    @property
    def message_request(self) -> MessageRequest | None:
        """Request for the selected message; None for a source."""
        return MessageRequest(*self.selected) if self.selected is not None and self.selected[3] else None

    def add(self, page: MessagesPage, height: int) -> None:
        """Show a page. The cursor stays on its row, also where that has moved."""
        if (page.order, page.text) != (self.order, self.text):
            return
        self.page = page
        keys = [key_of(row) for row in page.rows]
        if self.selected in keys:
            moved = page.first + keys.index(self.selected) - self.cursor
            self.cursor += moved
            if self.order == MESSAGE_ORDERS[0]:
                self.top += moved
        elif self.selected is None or page.total == len(page.rows):
            self._go(self.cursor, height)
        self._scroll(height)

    # ---- the cursor ----

    def move(self, rows: int, height: int) -> None:
        """Move the cursor down by so many rows, up where negative."""
        self._go(self.cursor + rows, height)

    def window(self, height: int) -> tuple[MessageRow, ...]:
        """Return the rows to show; those that are not here yet are missing."""
        start = max(0, self.top - self.page.first)
        return self.page.rows[start : start + height]

    def set_filter(self, text: str) -> None:
        """Show the messages that a filter matches."""
        if text != self.text:
            self.text = text
            self._restart()

    def next_order(self) -> None:
        """Show the rows in the next order."""
        self.order = MESSAGE_ORDERS[(MESSAGE_ORDERS.index(self.order) + 1) % len(MESSAGE_ORDERS)]
        self._restart()

    def toggle_source(self) -> None:
        """Open or close the source at the cursor, or the one of the message there."""
        if self.selected is None or self.order != MESSAGE_ORDERS[0]:
            return
        system, component, sent, _ = self.selected
        self._closed ^= {(system, component, sent)}
        self.selected = (system, component, sent, "")

    @property
    def closed(self) -> frozenset[tuple[int, int, bool]]:
        """Sources whose messages are not listed."""
        return frozenset(self._closed)

    def _restart(self) -> None:
        self.top, self.cursor, self.selected = 0, 0, None
        self.page = MessagesPage((), 0, 0, 0, 0.0, 0.0)

    def _go(self, index: int, height: int) -> None:
        self.cursor = max(0, min(index, self.page.total - 1))
        at = self.cursor - self.page.first
        self.selected = key_of(self.page.rows[at]) if 0 <= at < len(self.page.rows) else None
        self._scroll(height)

    def _scroll(self, height: int) -> None:
        """Move the window so that the cursor is in it."""
        self.top = max(self.cursor - height + 1, min(self.top, self.cursor, max(0, self.page.total - height)), 0)
