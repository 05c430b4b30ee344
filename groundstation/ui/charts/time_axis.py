"""TimeAxis: which time the charts show, in columns of dots, and the two cursors in it."""

from __future__ import annotations

WINDOWS = (10.0, 30.0, 60.0, 120.0, 300.0, 600.0)
"""s that the charts can show; the last one is all that is kept."""

CELL = 2
"""Columns of dots in a character: one step of the cursor."""


class TimeAxis:
    """Times are s of the station's clock. `now` is that of the newest page."""

    def __init__(self) -> None:
        self.window = 60.0
        self.dots = 100
        """Columns of dots of the charts."""
        self.now = 0.0
        self.oldest = 0.0
        """Time of the oldest point."""
        self.paused_at: float | None = None
        """Time at the right edge; None: it follows `now`."""
        self.cursor: float | None = None
        self.mark: float | None = None
        """The second cursor."""

    @property
    def end(self) -> float:
        """Time at the right edge."""
        return self.now if self.paused_at is None else self.paused_at

    @property
    def step(self) -> float:
        """S of a column of dots."""
        return self.window / self.dots

    @property
    def right(self) -> int:
        """Number of the column at the right edge: time divided by `step`."""
        return int(self.end // self.step)

    @property
    def left(self) -> int:
        """Number of the column at the left edge."""
        return self.right - self.dots + 1

    @property
    def begin(self) -> float:
        """Time at the left edge."""
        return self.left * self.step

    def column(self, at: float | None) -> int | None:
        """Return the column of a time, counted from the left edge; None where it is not in the picture."""
        if at is None:
            return None
        column = int(at // self.step) - self.left
        return column if 0 <= column < self.dots else None

    def column_of(self, at: float) -> int:
        """Return the column of a time, counted from the left edge, also outside the picture."""
        return int(at // self.step) - self.left

    # ---- keys ----

    def zoom(self, step: int) -> bool:
        """Show the next shorter window (-1) or longer one (1); return False at the end of the list."""
        index = WINDOWS.index(self.window) + step
        if not 0 <= index < len(WINDOWS):
            return False
        self.window = WINDOWS[index]
        return True

    def toggle_pause(self) -> None:
        """Stop the picture, or go on live. Data are recorded in both cases."""
        self.paused_at = self.now if self.paused_at is None else None

    def scroll(self, windows: float) -> None:
        """Show an earlier (below 0) or a later time; at the newest time the picture goes on live."""
        end = max(self.end + windows * self.window, min(self.now, self.oldest + self.window))
        self.paused_at = None if end >= self.now else end

    def move_cursor(self, cells: int) -> None:
        """Move the cursor by so many characters; the first time it appears at the right edge."""
        if self.column(self.cursor) is None:
            self.cursor = self.end if cells < 0 else self.begin
        assert self.cursor is not None
        moved = self.cursor + cells * CELL * self.step
        self.cursor = min(max(moved, self.begin + self.step / 2), self.end)

    def set_mark(self) -> bool:
        """Set the second cursor to the first, or remove it where it is there; return False without a cursor."""
        if self.cursor is None:
            return False
        self.mark = (
            None if self.mark is not None and self.column(self.mark) == self.column(self.cursor) else self.cursor
        )
        return True

    def clear_cursors(self) -> None:
        """Remove both cursors."""
        self.cursor = self.mark = None
