"""Files and the vehicle's memory: what the Parameters screen asks before it compares, saves, stores or resets."""

from __future__ import annotations

import time
from pathlib import Path

from groundstation.intents.services import CompareParams, ResetParams, StoreParams
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.params.edit.files import parse_save, read_file
from groundstation.ui.params.edit.saving import ParamSaving
from groundstation.ui.params.model import ParamModel
from groundstation.ui.params.scope import group_of
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.views.params import ParamExport, ParamExportRequest


class ParamTransfers:
    """Asks with the field and the questions of a screen."""

    def __init__(self, screen: ConsoleScreen, model: ParamModel, saving: ParamSaving) -> None:
        self._screen = screen
        self._model = model
        self._saving = saving

    @property
    def requests(self) -> tuple[ParamExportRequest, ...]:
        """What to request: the text of a file that is being saved."""
        return self._saving.requests

    def take(self, view: ParamExport) -> None:
        """Save the text, and say how that ended."""
        self._screen.say(self._saving.take(view))

    # ---- compare ----

    def take_all(self) -> None:
        """Make all values of the file changes."""
        count = self._model.take_from_file()
        left_out = self._model.diff.left_out if self._model.diff else ()
        text = f"{count} values of the file are pending" if count else "no file is compared, or nothing differs"
        self._screen.say(text + (f"; left out: {', '.join(left_out)}" if left_out else ""))

    def open_file(self) -> None:
        """Ask which file to compare with."""
        placeholder = "parameter file to compare with; empty: none"
        self._screen.field.open(FieldUse(self._compare), placeholder=placeholder)

    def _compare(self, text: str) -> None:
        found = read_file(text, self._folder) if text.strip() else ("", "")
        page = self._model.page
        if isinstance(found, str) or page is None:
            self._screen.say(found if isinstance(found, str) else "no vehicle yet")
        else:
            self._screen.context.send(CompareParams(self._model.take_number(), page.system, *found))

    # ---- save ----

    def open_save(self) -> None:
        """Ask what to save where."""
        placeholder = f"FILE [all|changed|group] [mavproxy|qgc|mp]; ENTER alone: {self._free_name}"
        self._screen.field.open(FieldUse(self._save), placeholder=placeholder)

    @property
    def _free_name(self) -> str:
        """A name that no file has, of the vehicle and the day."""
        system = self._model.page.system if self._model.page is not None else 0
        stem = time.strftime(f"rover-{system}-%Y%m%d")
        names = (f"{stem}.param", *(f"{stem}-{number}.param" for number in range(2, 100)))
        return next((name for name in names if not (self._folder / name).exists()), "")

    def _save(self, text: str) -> None:
        choice = parse_save(text.strip() or self._free_name, self._folder)
        row, page = self._model.selected, self._model.page
        if isinstance(choice, str) or page is None or not page.known:
            self._screen.say(choice if isinstance(choice, str) else "there is nothing to save")
            return
        group = self._model.scope.group or (group_of(row.name, page) if row else "")
        if choice.path.exists():
            self._screen.ask(f"overwrite {choice.path}", lambda: self._saving.start(choice, group), word="overwrite")
        else:
            self._saving.start(choice, group)

    @property
    def _folder(self) -> Path:
        return self._screen.context.folder

    # ---- memory ----

    def open_memory(self) -> None:
        """Ask whether to store or to reset."""
        placeholder = "store: the vehicle stores all values; reset: all go back to their defaults"
        self._screen.field.open(FieldUse(self._ask_memory), placeholder=placeholder)

    def _ask_memory(self, text: str) -> None:
        word = text.strip().lower()
        if self._model.page is None or word not in ("store", "reset"):
            self._screen.say("no vehicle yet" if self._model.page is None else "type store or reset")
        elif word == "store":
            self._screen.ask("store all parameters in the vehicle", self._store)
        else:
            text = "reset ALL parameters of the vehicle to their defaults, without undo"
            self._screen.ask(text, self._reset, word="reset")

    def _store(self) -> None:
        if self._model.page is not None:
            self._screen.context.send(StoreParams(self._model.take_number(), self._model.page.system))

    def _reset(self) -> None:
        if self._model.page is not None:
            self._model.fetch_after = number = self._model.take_number()
            self._screen.context.send(ResetParams(number, self._model.page.system))
