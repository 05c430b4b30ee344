"""Questions before an action: answered by `y`, or by typing a word for what cannot be undone. Any other key means no.

The question stands in the hint line, never over the picture. Stop keys do not come here: key_gate.py takes them first.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec

ANSWER_WITHIN = 10.0
"""s within which a question must be answered; for one with a word, between two of its letters."""


class Question(msgspec.Struct):
    """A question of a screen."""

    text: Callable[[], str]
    """Returns what would be done, e.g. "write 3 changes to the vehicle, which is ARMED"."""
    perform: Callable[[], None]
    """Called when the answer is yes."""
    word: str = ""
    """To type in place of `y`, e.g. "erase"."""
    until: float = math.inf
    """Clock after which it is not a question any more."""
    typed: str = ""

    @property
    def hint(self) -> str:
        """The question and how to answer it."""
        if not self.word:
            return f"{self.text()} · y does it, any other key not"
        return f"{self.text()} · type {self.word}: {self.typed}_"

    def answer(self, key: str, now: float) -> bool:
        """Handle a key; return whether the question is still open."""
        if now >= self.until or not (key == "y" if not self.word else self.word.startswith(self.typed + key)):
            return False
        self.typed += key
        if self.typed != (self.word or "y"):
            self.until = now + ANSWER_WITHIN
            return True
        self.perform()
        return False
