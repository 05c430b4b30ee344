"""Keys of the Map screen that open and save plan files."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any, Protocol

from groundstation.ui.map.model import MapModel
from groundstation.ui.map.plan.files import MapFileError, open_layer, open_plan, save_plan
from groundstation.ui.widgets.line_field import FieldUse, LineField

LAYER_SUFFIXES = (".geojson", ".json")


class FileScreen(Protocol):
    """What these keys need of a screen."""

    field: LineField

    def say(self, text: str | None) -> None:
        """Show a note."""

    def ask(self, text: str | Callable[[], str], perform: Callable[[], None], *, word: str = "") -> None:
        """Ask before an action."""

    def redraw(self) -> None:
        """Draw at once."""

    def run_worker(self, work: Coroutine[Any, Any, None]) -> Any:
        """Run a coroutine in the event loop."""


class FileKeys:
    """`folder` is where names without a folder are."""

    def __init__(self, screen: FileScreen, model: MapModel, folder: Path) -> None:
        self._screen = screen
        self._model = model
        self._folder = folder

    def perform(self, key: str) -> bool:
        """Handle a key; return False for any other."""
        if key not in ("O", "S"):
            return False
        opens = key == "O"
        use = FieldUse(self._open if opens else self._save)
        hint = "open: .plan, .waypoints, or .geojson as a layer" if opens else "save as: .plan, .waypoints or .geojson"
        self._screen.field.open(use, text=self._model.file, placeholder=hint)
        return True

    def _open(self, name: str) -> None:
        if name.strip():
            self._screen.run_worker(self._read(self._path(name)))

    def _save(self, name: str) -> None:
        if not name.strip():
            return
        path = self._path(name)
        if path.exists() and not path.is_dir():
            text = f"{path.name} exists already: overwrite it"
            self._screen.ask(text, lambda: self._start_saving(path, replace=True), word="overwrite")
        else:
            self._start_saving(path)

    def _start_saving(self, path: Path, *, replace: bool = False) -> None:
        self._screen.run_worker(self._write(path, replace))

    async def _read(self, path: Path) -> None:
        try:
            if path.suffix.lower() in LAYER_SUFFIXES:
                self._screen.say(self._model.take_layer(await open_layer(path), path.name))
            else:
                self._screen.say(self._model.take_file(await open_plan(path), path.name))
            self._screen.redraw()
        except MapFileError as error:
            self._screen.say(str(error))

    async def _write(self, path: Path, replace: bool) -> None:
        try:
            lost = await save_plan(path, self._model.document, replace=replace)
        except MapFileError as error:
            self._screen.say(str(error))
            return
        self._model.file = path.name
        self._screen.say(f"saved {path}" + (f"; {lost}" if lost else ""))

    def _path(self, name: str) -> Path:
        return self._folder / Path(name.strip()).expanduser()
