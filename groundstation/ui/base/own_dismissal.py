"""A screen that closes itself and nothing else."""

from __future__ import annotations

from textual.await_complete import AwaitComplete
from textual.screen import Screen, ScreenResultType


class OwnDismissal(Screen[ScreenResultType]):
    """Mixed into screens that a key closes: the second key of one read comes to them, too, when they are closed."""

    def dismiss(self, result: ScreenResultType | None = None) -> AwaitComplete:
        """Close this screen if it is on top; Textual would close whichever is, down to the last one."""
        if self.is_active:
            return super().dismiss(result)
        return AwaitComplete.nothing()  # type: ignore[no-untyped-call, no-any-return]
