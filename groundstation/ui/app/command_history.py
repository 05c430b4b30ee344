"""What the command line of the screens keeps while it is closed: the lines before, and the one that runs. No widget."""

from __future__ import annotations

KEPT = 100


class CommandHistory:
    """The lines that were entered, the newest last."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.number = 0
        """Of the newest line that the station runs; 0: none."""
        self.told = 0
        """Number of the newest line whose end was shown."""
        self._at = 0
        self._typed = ""

    def begin(self) -> None:
        """Begin at a new line, behind the newest."""
        self._at, self._typed = len(self.lines), ""

    def add(self, line: str) -> None:
        """Keep a line; one that repeats the newest is not kept twice."""
        if line and self.lines[-1:] != [line]:
            self.lines = [*self.lines, line][-KEPT:]

    def move(self, step: int, typed: str) -> str:
        """Return the line so many steps away; behind the newest is what was typed."""
        if self._at == len(self.lines):
            self._typed = typed
        self._at = max(0, min(len(self.lines), self._at + step))
        return self.lines[self._at] if self._at < len(self.lines) else self._typed


def complete_text(text: str, words: tuple[str, ...]) -> str:
    """Return the text with its last word completed as far as all `words` agree; with a space behind a single one."""
    if not words:
        return text
    head, _, last = text.rpartition(" ")
    common = 0
    while all(word[: common + 1].lower() == words[0][: common + 1].lower() for word in words) and common < len(
        words[0]
    ):
        common += 1
    whole = words[0][:common]
    if len(whole) < len(last):
        return text
    return f"{head} {whole}".lstrip() + (" " if len(words) == 1 else "")
