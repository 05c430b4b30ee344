"""The key of the Files screen that deletes: a file there, a file here, or all logs of the vehicle, after a word."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any, Protocol

from groundstation.intents.union import AnyIntent
from groundstation.ui.display.wrap import clean
from groundstation.ui.files.model import FilesModel, FilesPanel
from groundstation.ui.files.tables import size_text


class RemovalContext(Protocol):
    """What this key needs of the app."""

    @property
    def send(self) -> Callable[[AnyIntent], None]:
        """Sends an intent to the station."""


class RemovalScreen(Protocol):
    """What this key needs of a screen."""

    @property
    def context(self) -> RemovalContext:
        """The app."""

    def say(self, text: str | None) -> None:
        """Show a note."""

    def ask(self, text: str | Callable[[], str], perform: Callable[[], None], *, word: str = "") -> None:
        """Ask before an action."""

    def run_worker(self, work: Coroutine[Any, Any, None]) -> Any:
        """Run a coroutine in the event loop."""


class FileRemoval:
    """Asks, and deletes what the cursor was on when it asked."""

    def __init__(self, screen: RemovalScreen, model: FilesModel) -> None:
        self._screen = screen
        self._model = model

    def ask(self) -> None:
        """Ask whether what is under the cursor shall be deleted."""
        _BY_PANEL.get(self._model.chosen, FileRemoval._ask_there)(self)

    def _ask_logs(self) -> None:
        count = len(self._model.logs)
        if not count:
            self._screen.say("there are no logs to erase")
            return
        text = f"erase {count} log{'' if count == 1 else 's'} on {self._model.vehicle}, which cannot be undone"
        self._screen.ask(text, lambda: self._screen.context.send(self._model.erase()), word="erase")

    def _ask_there(self) -> None:
        node = self._model.node
        if node is None or node.size is None:
            self._screen.say("choose a file first: TAB to the files there, or here")
            return
        text = f"delete {clean(node.path)} on {self._model.vehicle}, which cannot be undone"
        self._screen.ask(text, lambda: self._screen.context.send(self._model.remove(node.path)), word="delete")

    def _ask_here(self) -> None:
        local = self._model.local
        if local is None:
            self._screen.say("there is no file here to delete")
        elif self._model.is_arriving(local.name):
            self._screen.say(f"{clean(local.name)} is being downloaded: x stops that first")
        elif self._model.disk.is_recorded(local):
            self._screen.say(f"{clean(local.name)} is the recording of this session: it cannot be deleted meanwhile")
        else:
            text = f"delete {clean(local.name)} here, {size_text(local.size)}, which cannot be undone"
            self._screen.ask(text, lambda: self._remove(local.name), word="delete")

    def _remove(self, name: str) -> None:
        self._screen.run_worker(self._remove_here(name))

    async def _remove_here(self, name: str) -> None:
        problem = await self._model.disk.remove(name)
        self._screen.say(f"{clean(name)} is deleted" if problem is None else f"{clean(name)}: not deleted: {problem}")


_BY_PANEL: dict[FilesPanel, Callable[[FileRemoval], None]] = {
    FilesPanel.LOGS: FileRemoval._ask_logs,
    FilesPanel.HERE: FileRemoval._ask_here,
}
"""Panel with the cursor -> what is asked there."""
